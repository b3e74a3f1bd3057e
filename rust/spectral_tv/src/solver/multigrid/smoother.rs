//! Gauss–Seidel sweeps, in parts that threads work on side by side.
//!
//! Within a part a sweep uses new values as soon as they are known. From other parts it uses the
//! values before the sweep. The diagonals of rows with couplings to other parts are enlarged by
//! half the sum of these couplings (Baker, Falgout, Kolev and Yang 2011, "Multigrid smoothers for
//! ultraparallel computing"). So a sweep never raises the energy, whatever the signs of the
//! couplings.

use rayon::prelude::*;

use crate::solver::multigrid::matrix::{Dot, Lanes, Matrix, accumulate, sum};
use crate::solver::multigrid::prolongation::Prolongation;

/// The reciprocals of the diagonals that sweeps divide by.
pub(super) struct Smoother {
    inverse: Vec<f32>,
}

impl Smoother {
    /// A smoother for matrices of `size` rows; to be refreshed.
    pub fn new(size: usize) -> Self {
        Self {
            inverse: vec![0.0; size],
        }
    }

    /// Takes the values of `matrix`; returns whether all its diagonals are positive.
    pub fn refresh(&mut self, matrix: &Matrix) -> bool {
        let chunk = matrix.chunk();
        let chunks = self.inverse.par_chunks_mut(chunk).enumerate();
        let are_positive = chunks.with_max_len(1).map(|(part, inverse)| {
            let first = part * chunk;
            let own = first as u32..(first + inverse.len()) as u32;
            let mut is_positive = true;
            for (offset, value) in inverse.iter_mut().enumerate() {
                let row = first + offset;
                let mut diagonal = matrix.masses[row];
                for octet in matrix.row(row) {
                    for (column, coupling) in octet.columns.iter().zip(octet.couplings) {
                        let across = if own.contains(column) { 0.0 } else { 0.5 };
                        diagonal += coupling + across * coupling.abs();
                    }
                }
                *value = diagonal.recip();
                is_positive &= diagonal > 0.0 && value.is_finite();
            }
            is_positive
        });
        are_positive.reduce(|| true, |a, b| a && b)
    }

    /// Pre-smooths: `x` ← one sweep upwards from 0 on K x = b.
    pub fn pre_smooth<const L: usize>(
        &self,
        matrix: &Matrix,
        right_hand_side: &[Lanes<L>],
        x: &mut [Lanes<L>],
    ) {
        let chunk = matrix.chunk();
        let chunks = x
            .par_chunks_mut(chunk)
            .zip(right_hand_side.par_chunks(chunk));
        chunks
            .enumerate()
            .with_max_len(1)
            .for_each(|(part, (x, right_hand_side))| {
                self.pre_smooth_rows(matrix, part * chunk, right_hand_side, x);
            });
    }

    /// [`Self::pre_smooth`] in the part of the rows that begins with `first`; the vectors are of
    /// that part alone.
    #[inline(never)]
    pub fn pre_smooth_rows<const L: usize>(
        &self,
        matrix: &Matrix,
        first: usize,
        right_hand_side: &[Lanes<L>],
        x: &mut [Lanes<L>],
    ) {
        x.fill([0.0; L]);
        for offset in 0..x.len() {
            let row = first + offset;
            // Two sums, as one waits for its last addition.
            let mut sums = [right_hand_side[offset], [0.0; L]];
            for octet in matrix.row(row) {
                for (entry, column) in octet.columns.iter().enumerate() {
                    // Values not yet known and those of other parts are 0.
                    if let Some(other) = x.get((*column as usize).wrapping_sub(first)) {
                        let sum = &mut sums[entry % 2];
                        for lane in 0..L {
                            sum[lane] += octet.couplings[entry] * other[lane];
                        }
                    }
                }
            }
            for lane in 0..L {
                x[offset][lane] = self.inverse[row] * (sums[0][lane] + sums[1][lane]);
            }
        }
    }

    /// Corrects and post-smooths: `x` ← `start` + P e, e given by `coarse` if at all, and from there
    /// one sweep downwards on K x = b; returns b·x of every lane.
    pub fn post_smooth<const L: usize>(
        &self,
        matrix: &Matrix,
        right_hand_side: &[Lanes<L>],
        start: &[Lanes<L>],
        coarse: Option<(&Prolongation, &[Lanes<L>])>,
        x: &mut [Lanes<L>],
    ) -> [f64; L] {
        let corrected = |row: usize| match coarse {
            Some((prolongation, coarse)) => prolongation.corrected(start[row], row, coarse),
            None => start[row],
        };
        let chunk = matrix.chunk();
        let chunks = x.par_chunks_mut(chunk).enumerate().with_max_len(1);
        let dots = chunks.map(|(part, x)| {
            let first = part * chunk;
            for (offset, value) in x.iter_mut().enumerate() {
                *value = corrected(first + offset);
            }
            self.post_smooth_rows(matrix, first, right_hand_side, &corrected, x)
        });
        sum(&dots.collect::<Vec<_>>())
    }

    /// [`Self::post_smooth`] in the part of the rows that begins with `first`, from `x` there and
    /// from `old` elsewhere.
    #[inline(never)]
    fn post_smooth_rows<const L: usize>(
        &self,
        matrix: &Matrix,
        first: usize,
        right_hand_side: &[Lanes<L>],
        old: &impl Fn(usize) -> Lanes<L>,
        x: &mut [Lanes<L>],
    ) -> [f64; L] {
        let mut dot = Dot::default();
        for offset in (0..x.len()).rev() {
            let row = first + offset;
            let (own, mass) = (x[offset], matrix.masses[row]);
            let mut sums = [[0.0; L]; 2];
            for lane in 0..L {
                sums[0][lane] = right_hand_side[row][lane] - mass * own[lane];
            }
            for octet in matrix.row(row) {
                for (entry, column) in octet.columns.iter().enumerate() {
                    let sum = &mut sums[entry % 2];
                    match x.get((*column as usize).wrapping_sub(first)) {
                        Some(other) => accumulate(sum, octet, entry, other, &own),
                        None => {
                            let other = elsewhere(old, *column);
                            accumulate(sum, octet, entry, &other, &own);
                        }
                    }
                }
            }
            let inverse = self.inverse[row];
            for lane in 0..L {
                x[offset][lane] = own[lane] + inverse * (sums[0][lane] + sums[1][lane]);
            }
            dot.add(&right_hand_side[row], &x[offset]);
        }
        dot.finish()
    }
}

/// Out of the way of the loop, whose neighbours are nearly all in the part at hand.
#[cold]
#[inline(never)]
fn elsewhere<const L: usize>(old: &impl Fn(usize) -> Lanes<L>, column: u32) -> Lanes<L> {
    old(column as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::multigrid::examples::{dot, hierarchy_of, lattice, random};

    /// x ↦ one sweep up and one down from 0, the symmetric smoother.
    fn symmetric(smoother: &Smoother, matrix: &Matrix, b: &[Lanes<1>]) -> Vec<Lanes<1>> {
        let (mut up, mut down) = (vec![[0.0]; b.len()], vec![[0.0]; b.len()]);
        smoother.pre_smooth(matrix, b, &mut up);
        smoother.post_smooth(matrix, b, &up, None, &mut down);
        down
    }

    #[test]
    fn sweeps_up_and_down_are_symmetric_and_lower_the_energy() {
        // Large enough for several parts.
        let (lower, masses) = lattice(130, 140, 1e-3);
        let hierarchy = hierarchy_of(&lower, &masses);
        let matrix = &hierarchy.levels[0].matrix;
        assert!(matrix.size() > matrix.chunk());
        let smoother = &hierarchy.levels[0].smoother;
        let (a, b) = (random::<1>(matrix.size(), 3), random::<1>(matrix.size(), 4));
        let (sa, sb) = (
            symmetric(smoother, matrix, &a),
            symmetric(smoother, matrix, &b),
        );
        let (first, second) = (dot(&sa, &b), dot(&a, &sb));
        assert!((first - second).abs() < 1e-4 * dot(&sa, &a));
        // ½xKx − bx at x = S b is below its value at 0, 0.
        let mut image = vec![[0.0]; matrix.size()];
        let quadratic = matrix.apply(&sb, &mut image)[0];
        assert!(0.5 * quadratic < dot(&b, &sb));
    }
}
