//! Symmetric matrices in rows of whole octets, and their product with vectors.
//!
//! K x = m x − Σ_j c_ij (x_j − x_i). By differences constants cost no digits, and the row sums m
//! stay exact beside couplings c a million times larger.

use rayon::prelude::*;

use crate::error::Result;
use crate::monitor::Stage;

/// The values of up to four functions at one vertex, side by side.
pub(super) type Lanes<const L: usize> = [f32; L];

/// Eight couplings of one row: a cache line, and a loop of fixed length.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Octet {
    /// Columns; the row's own where there is nothing.
    pub columns: [u32; 8],
    /// Couplings c = −K_ij; 0 where there is nothing.
    pub couplings: [f32; 8],
}

impl Octet {
    /// Of a row, with nothing in it.
    fn of_row(row: usize) -> Self {
        Self {
            columns: [row as u32; 8],
            couplings: [0.0; 8],
        }
    }
}

/// A symmetric matrix with couplings c_ij and row sums m_i.
pub(super) struct Matrix {
    /// First octet of each row, and their number at the end.
    pub starts: Vec<u32>,
    pub octets: Vec<Octet>,
    /// Sums of rows: the masses, where all couplings are with rows of the matrix.
    pub masses: Vec<f32>,
}

/// Least number of rows that are worth handing to another thread, and how many of them so small
/// there may be: sweeps converge the better the fewer they are.
const LEAST_ROWS: usize = 1 << 10;
const FEW_CHUNKS: usize = 8;
/// Rows of each where there are more, and the most there are.
const MANY_ROWS: usize = 1 << 14;
const MOST_CHUNKS: usize = 64;

/// Rows of one part of the work on `size` rows. The parts depend on the size alone, so results
/// are the same however many threads share them.
pub(super) fn chunk_length(size: usize) -> usize {
    let few = (size / LEAST_ROWS).clamp(1, FEW_CHUNKS);
    let wanted = few.max((size / MANY_ROWS).min(MOST_CHUNKS));
    // A power of two is shared evenly by two or four threads.
    let count = 1 << wanted.ilog2();
    size.div_ceil(count).max(1)
}

impl Matrix {
    /// A matrix of couplings 0 in the places that `neighbours` lists row by row.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn with_pattern<R: ExactSizeIterator<Item = u32>>(
        neighbours: impl Iterator<Item = R> + Clone,
        stage: Stage,
    ) -> Result<Self> {
        let mut starts = vec![0];
        let count = neighbours.clone().map(|columns| columns.len().div_ceil(8));
        let mut octets = Vec::with_capacity(count.sum());
        stage.for_each(neighbours.enumerate(), |(row, columns)| {
            let mut octet = Octet::of_row(row);
            let mut count = 0;
            for column in columns {
                octet.columns[count] = column;
                count += 1;
                if count == 8 {
                    octets.push(std::mem::replace(&mut octet, Octet::of_row(row)));
                    count = 0;
                }
            }
            if count > 0 {
                octets.push(octet);
            }
            starts.push(octets.len() as u32);
        })?;
        Ok(Self {
            masses: vec![0.0; starts.len() - 1],
            starts,
            octets,
        })
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.masses.len()
    }

    /// Rows that one thread works on at a time.
    pub fn chunk(&self) -> usize {
        chunk_length(self.size())
    }

    /// The parts of `items`, one for each octet, that belong to the rows of one chunk each.
    pub fn parts_of_octets<'a, T>(&self, items: &'a mut [T]) -> Vec<&'a mut [T]> {
        split_at_rows(items, &self.starts, self.chunk())
    }

    /// The octets of a row.
    #[inline]
    pub fn row(&self, row: usize) -> &[Octet] {
        &self.octets[self.starts[row] as usize..self.starts[row + 1] as usize]
    }

    /// −(K x) of one row.
    #[inline(always)]
    fn descent<const L: usize>(&self, row: usize, x: &[Lanes<L>]) -> Lanes<L> {
        let own = x[row];
        let mass = self.masses[row];
        let mut even = own.map(|value| -mass * value);
        let mut odd = [0.0; L];
        for octet in self.row(row) {
            for pair in 0..4 {
                accumulate(
                    &mut even,
                    octet,
                    2 * pair,
                    &x[octet.columns[2 * pair] as usize],
                    &own,
                );
                let next = 2 * pair + 1;
                accumulate(
                    &mut odd,
                    octet,
                    next,
                    &x[octet.columns[next] as usize],
                    &own,
                );
            }
        }
        std::array::from_fn(|lane| even[lane] + odd[lane])
    }

    /// `product` ← K x; returns x·K x of every lane.
    pub fn apply<const L: usize>(&self, x: &[Lanes<L>], product: &mut [Lanes<L>]) -> [f64; L] {
        let chunk = self.chunk();
        let chunks = product.par_chunks_mut(chunk).enumerate().with_max_len(1);
        let dots = chunks.map(|(part, product)| self.apply_rows(part * chunk, x, product));
        sum(&dots.collect::<Vec<_>>())
    }

    /// [`Self::apply`] to the rows from `first` on.
    #[inline(never)]
    fn apply_rows<const L: usize>(
        &self,
        first: usize,
        x: &[Lanes<L>],
        product: &mut [Lanes<L>],
    ) -> [f64; L] {
        let mut dot = Dot::default();
        for (offset, value) in product.iter_mut().enumerate() {
            let row = first + offset;
            *value = self.descent(row, x).map(|value| -value);
            dot.add(&x[row], value);
        }
        dot.finish()
    }

    /// `residual` ← b − K x.
    pub fn residual<const L: usize>(
        &self,
        right_hand_side: &[Lanes<L>],
        x: &[Lanes<L>],
        residual: &mut [Lanes<L>],
    ) {
        let chunk = self.chunk();
        let chunks = residual.par_chunks_mut(chunk).enumerate().with_max_len(1);
        chunks.for_each(|(part, residual)| {
            self.residual_rows(part * chunk, right_hand_side, x, residual);
        });
    }

    /// [`Self::residual`] in the rows from `first` on.
    #[inline(never)]
    fn residual_rows<const L: usize>(
        &self,
        first: usize,
        right_hand_side: &[Lanes<L>],
        x: &[Lanes<L>],
        residual: &mut [Lanes<L>],
    ) {
        for (offset, value) in residual.iter_mut().enumerate() {
            let row = first + offset;
            let (descent, right) = (self.descent(row, x), &right_hand_side[row]);
            *value = std::array::from_fn(|lane| right[lane] + descent[lane]);
        }
    }
}

#[inline(always)]
pub(super) fn accumulate<const L: usize>(
    sum: &mut Lanes<L>,
    octet: &Octet,
    entry: usize,
    other: &Lanes<L>,
    own: &Lanes<L>,
) {
    for lane in 0..L {
        sum[lane] += octet.couplings[entry] * (other[lane] - own[lane]);
    }
}

/// A sum of products, lane by lane: of a few rows in single precision, of all in double.
pub(super) struct Dot<const L: usize> {
    few: Lanes<L>,
    all: [f64; L],
    count: u32,
}

impl<const L: usize> Default for Dot<L> {
    fn default() -> Self {
        Self {
            few: [0.0; L],
            all: [0.0; L],
            count: 0,
        }
    }
}

impl<const L: usize> Dot<L> {
    /// Adds a b.
    #[inline(always)]
    pub fn add(&mut self, a: &Lanes<L>, b: &Lanes<L>) {
        for lane in 0..L {
            self.few[lane] += a[lane] * b[lane];
        }
        self.count += 1;
        if self.count == 16 {
            self.flush();
        }
    }

    /// The sum.
    pub fn finish(mut self) -> [f64; L] {
        self.flush();
        self.all
    }

    #[inline(never)]
    fn flush(&mut self) {
        for lane in 0..L {
            self.all[lane] += f64::from(self.few[lane]);
        }
        self.few = [0.0; L];
        self.count = 0;
    }
}

/// The sum of parts, in their order.
pub(super) fn sum<const L: usize>(parts: &[[f64; L]]) -> [f64; L] {
    let mut total = [0.0; L];
    for part in parts {
        for lane in 0..L {
            total[lane] += part[lane];
        }
    }
    total
}

/// The parts of `items` that belong to `chunk` rows each, of which the first items are `starts`.
pub(super) fn split_at_rows<'a, T>(
    mut items: &'a mut [T],
    starts: &[u32],
    chunk: usize,
) -> Vec<&'a mut [T]> {
    let size = starts.len() - 1;
    let ends = (1..=size.div_ceil(chunk)).map(|part| starts[(part * chunk).min(size)]);
    let mut parts = Vec::new();
    let mut start = 0;
    for end in ends {
        let (part, rest) = items.split_at_mut((end - start) as usize);
        parts.push(part);
        items = rest;
        start = end;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::multigrid::examples::{dense, hierarchy_of, lattice, random};

    #[test]
    fn products_are_those_of_the_dense_matrix() {
        let (lower, masses) = lattice(9, 7, 1.0);
        let hierarchy = hierarchy_of(&lower, &masses);
        let matrix = &hierarchy.levels[0].matrix;
        let full = dense(matrix);
        let x = random::<4>(63, 1);
        let mut product = vec![[0.0; 4]; 63];
        let dot = matrix.apply(&x, &mut product);
        let right = random::<4>(63, 2);
        let mut residual = vec![[0.0; 4]; 63];
        matrix.residual(&right, &x, &mut residual);
        for lane in 0..4 {
            let column = ndarray::Array1::from_iter(x.iter().map(|v| f64::from(v[lane])));
            let expected = full.dot(&column);
            for row in 0..63 {
                assert!((f64::from(product[row][lane]) - expected[row]).abs() < 1e-5);
                let difference = right[row][lane] - product[row][lane] - residual[row][lane];
                assert!(difference.abs() < 1e-5);
            }
            assert!((dot[lane] - column.dot(&expected)).abs() < 1e-4);
        }
    }

    #[test]
    fn parts_do_not_depend_on_threads_and_cover_everything() {
        assert_eq!(chunk_length(0), 1);
        assert_eq!(chunk_length(2000), 2000);
        for size in [5000_usize, 43_243, 163_842, 1_000_000, 5_000_000] {
            let count = size.div_ceil(chunk_length(size));
            assert!(count.is_power_of_two() && count <= MOST_CHUNKS);
        }
        let mut items = [1, 2, 3, 4, 5];
        let parts = split_at_rows(&mut items, &[0, 1, 2, 2, 2, 5], 2);
        assert_eq!(parts, [&mut [1, 2][..], &mut [], &mut [3, 4, 5]]);
    }
}
