//! P, the prolongation from a level to the next finer one, and its transpose.
//!
//! A step of damped Jacobi on the strong couplings smooths the indicator functions of the
//! aggregates. The four largest weights of each row are kept and made to sum to 1, so that
//! constants stay constants. Which weights are kept is decided once; their values follow the
//! matrix.

use rayon::prelude::*;

use crate::error::Result;
use crate::monitor::Stage;
use crate::solver::multigrid::aggregation::{Aggregates, NONE, Strength};
use crate::solver::multigrid::matrix::{Lanes, Matrix, Octet, chunk_length};

/// Weights in a row.
pub(super) const WIDTH: usize = 4;
/// A neighbour whose aggregate has no weight in the row.
const DROPPED: u8 = WIDTH as u8;
/// Damping of the Jacobi step: 4/3 over the largest eigenvalue of D⁻¹K, which is below 2.
const DAMPING: f32 = 2.0 / 3.0;

/// An interpolation with non-negative weights, at most four in a row.
pub(super) struct Prolongation {
    /// Aggregates of each row's weights, its own first.
    pub columns: Vec<[u32; WIDTH]>,
    /// All 0 in rows of vertices that are in no aggregate, and of sum 1 in others.
    pub weights: Vec<[f32; WIDTH]>,
    /// Which weight each neighbour in an octet adds to.
    slots: Vec<[u8; 8]>,
    /// First of each aggregate's entries in `transposed`, and their number at the end.
    pub starts: Vec<u32>,
    /// Where the weights of an aggregate are: 4 row + slot.
    pub transposed: Vec<u32>,
}

impl Prolongation {
    /// The pattern for these aggregates and the strong couplings of `matrix`; to be refreshed.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(
        matrix: &Matrix,
        strength: &Strength,
        aggregates: &Aggregates,
        stage: Stage,
    ) -> Result<Self> {
        let size = matrix.size();
        let mut columns = vec![[0; WIDTH]; size];
        let mut weights = vec![[0.0; WIDTH]; size];
        let mut slots = vec![[DROPPED; 8]; matrix.octets.len()];
        let mut used = vec![0_u8; size];
        let chunk = matrix.chunk();
        let slot_parts = matrix.parts_of_octets(&mut slots);
        let rows = columns
            .par_chunks_mut(chunk)
            .zip(weights.par_chunks_mut(chunk));
        let rows = rows.zip(used.par_chunks_mut(chunk)).zip(slot_parts);
        rows.enumerate().with_max_len(1).for_each(|(part, rows)| {
            let (((columns, weights), used), mut slots) = rows;
            // Shares of aggregates in one row; it has few neighbours, so that a search is fast.
            let mut shares = Vec::new();
            for (offset, (columns, used)) in columns.iter_mut().zip(used).enumerate() {
                let row = part * chunk + offset;
                let octets = matrix.row(row);
                let (of_row, rest) = slots.split_at_mut(octets.len());
                slots = rest;
                if aggregates.of_vertex[row] != NONE {
                    let row = Row {
                        row,
                        octets,
                        strength,
                        aggregates,
                    };
                    *used = row.choose(&mut shares, columns);
                    row.assign(&columns[..usize::from(*used)], of_row);
                    weights[offset][0] = 1.0;
                }
            }
        });
        let transposed = stage.pass(|| transpose(&columns, &used, aggregates.count))?;
        let (starts, transposed) = transposed;
        Ok(Self {
            columns,
            weights,
            slots,
            starts,
            transposed,
        })
    }

    /// Number of coarse unknowns.
    pub fn coarse_size(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether a row takes part in the coarser level.
    #[inline]
    pub fn reaches(&self, row: usize) -> bool {
        self.weights[row][0] > 0.0
    }

    /// Takes the weights that follow from the values of `matrix`.
    pub fn refresh(&mut self, matrix: &Matrix) {
        let chunk = matrix.chunk();
        let slots = &self.slots;
        let chunks = self
            .weights
            .par_chunks_mut(chunk)
            .enumerate()
            .with_max_len(1);
        chunks.for_each(|(part, weights)| {
            for (offset, weights) in weights.iter_mut().enumerate() {
                if weights[0] == 0.0 {
                    continue;
                }
                let row = part * chunk + offset;
                let octets = matrix.starts[row] as usize..matrix.starts[row + 1] as usize;
                let mut sums = [0.0; WIDTH + 1];
                for (octet, slots) in matrix.octets[octets.clone()].iter().zip(&slots[octets]) {
                    for (coupling, slot) in octet.couplings.iter().zip(slots) {
                        // Signs may have changed since the couplings were found strong.
                        sums[usize::from(*slot).min(WIDTH)] += coupling.max(0.0);
                    }
                }
                let strong: f32 = sums[..WIDTH].iter().sum();
                *weights = [1.0, 0.0, 0.0, 0.0];
                if strong > 0.0 {
                    let damping = DAMPING / (matrix.masses[row] + strong);
                    for slot in 1..WIDTH {
                        weights[slot] = damping * sums[slot];
                        weights[0] -= weights[slot];
                    }
                }
            }
        });
    }

    /// `value` + (P `coarse`) in one row.
    #[inline(always)]
    pub fn corrected<const L: usize>(
        &self,
        mut value: Lanes<L>,
        row: usize,
        coarse: &[Lanes<L>],
    ) -> Lanes<L> {
        for (weight, column) in self.weights[row].iter().zip(self.columns[row]) {
            let correction = &coarse[column as usize];
            for lane in 0..L {
                value[lane] += weight * correction[lane];
            }
        }
        value
    }

    /// `coarse` ← Pᵀ `fine`.
    pub fn restrict<const L: usize>(&self, fine: &[Lanes<L>], coarse: &mut [Lanes<L>]) {
        let weights = self.weights.as_flattened();
        let chunk = chunk_length(coarse.len());
        let chunks = coarse.par_chunks_mut(chunk).enumerate().with_max_len(1);
        chunks.for_each(|(part, coarse)| {
            for (offset, value) in coarse.iter_mut().enumerate() {
                let mut sum = [0.0; L];
                for &entry in self.entries(part * chunk + offset) {
                    let weight = weights[entry as usize];
                    let fine = &fine[entry as usize / WIDTH];
                    for lane in 0..L {
                        sum[lane] += weight * fine[lane];
                    }
                }
                *value = sum;
            }
        });
    }

    /// Where the weights of an aggregate are: 4 row + slot.
    #[inline]
    pub fn entries(&self, aggregate: usize) -> &[u32] {
        &self.transposed[self.starts[aggregate] as usize..self.starts[aggregate + 1] as usize]
    }
}

/// A row whose pattern is worked out, of a vertex in an aggregate.
struct Row<'a> {
    row: usize,
    octets: &'a [Octet],
    strength: &'a Strength,
    aggregates: &'a Aggregates,
}

impl Row<'_> {
    /// The aggregate of a strong neighbour, if it is in one.
    fn strong(&self, column: u32, coupling: f32) -> Option<u32> {
        let aggregate = self.aggregates.of_vertex[column as usize];
        let is_strong = self.strength.is_strong(self.row, column as usize, coupling);
        (is_strong && aggregate != NONE).then_some(aggregate)
    }

    /// Fills `columns` with the vertex's own aggregate and those next to it that it is coupled
    /// best to; returns their number. `shares` is scratch.
    fn choose(&self, shares: &mut Vec<(u32, f32)>, columns: &mut [u32; WIDTH]) -> u8 {
        let own = self.aggregates.of_vertex[self.row];
        shares.clear();
        for octet in self.octets {
            for (&column, coupling) in octet.columns.iter().zip(octet.couplings) {
                let strong = self.strong(column, coupling);
                let Some(aggregate) = strong.filter(|&other| other != own) else {
                    continue;
                };
                match shares.iter_mut().find(|share| share.0 == aggregate) {
                    Some(share) => share.1 += coupling,
                    None => shares.push((aggregate, coupling)),
                }
            }
        }
        shares.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        shares.truncate(WIDTH - 1);
        *columns = [own; WIDTH];
        for (column, share) in columns[1..].iter_mut().zip(shares.iter()) {
            *column = share.0;
        }
        1 + shares.len() as u8
    }

    /// Writes which of the aggregates `kept` each neighbour adds to.
    fn assign(&self, kept: &[u32], slots: &mut [[u8; 8]]) {
        for (octet, slots) in self.octets.iter().zip(slots) {
            let entries = octet.columns.iter().zip(octet.couplings).zip(slots);
            for ((&column, coupling), slot) in entries {
                if let Some(aggregate) = self.strong(column, coupling) {
                    let place = kept.iter().position(|&kept| kept == aggregate);
                    *slot = place.map_or(DROPPED, |place| place as u8);
                }
            }
        }
    }
}

fn transpose(columns: &[[u32; WIDTH]], used: &[u8], count: usize) -> (Vec<u32>, Vec<u32>) {
    let entries = || {
        columns
            .iter()
            .zip(used)
            .enumerate()
            .flat_map(|(row, (columns, &used))| {
                (0..usize::from(used)).map(move |slot| (columns[slot], (WIDTH * row + slot) as u32))
            })
    };
    let mut starts = vec![0_u32; count + 1];
    for (column, _) in entries() {
        starts[column as usize + 1] += 1;
    }
    for column in 0..count {
        starts[column + 1] += starts[column];
    }
    let mut next = starts.clone();
    let mut transposed = vec![0; starts[count] as usize];
    for (column, entry) in entries() {
        transposed[next[column as usize] as usize] = entry;
        next[column as usize] += 1;
    }
    (starts, transposed)
}
