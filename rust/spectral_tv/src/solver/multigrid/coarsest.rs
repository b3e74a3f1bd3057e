//! The coarsest level, solved directly by a dense Cholesky factorization.

use crate::solver::multigrid::matrix::{Lanes, Matrix};

/// Largest size of a level that is solved directly.
pub(super) const LARGEST: usize = 96;

/// L of K = L Lᵀ, by rows, with the reciprocals of the diagonal in its place.
pub(super) struct Coarsest {
    factor: Vec<Vec<f32>>,
}

impl Coarsest {
    /// Factorizes `matrix`, in double precision; `None` if it is not positive definite.
    pub fn new(matrix: &Matrix) -> Option<Self> {
        let size = matrix.size();
        let mut factor: Vec<Vec<f64>> = (0..size).map(|row| vec![0.0; row + 1]).collect();
        for (row, values) in factor.iter_mut().enumerate() {
            let mut diagonal = f64::from(matrix.masses[row]);
            for octet in matrix.row(row) {
                for (column, coupling) in octet.columns.iter().zip(octet.couplings) {
                    diagonal += f64::from(coupling);
                    if (*column as usize) < row {
                        values[*column as usize] -= f64::from(coupling);
                    }
                }
            }
            values[row] = diagonal;
        }
        for row in 0..size {
            let (above, rest) = factor.split_at_mut(row);
            let values = &mut rest[0];
            for column in 0..row {
                let other = &above[column];
                let known: f64 = (0..column).map(|k| values[k] * other[k]).sum();
                values[column] = (values[column] - known) * other[column];
            }
            let pivot = values[row] - values[..row].iter().map(|v| v * v).sum::<f64>();
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            values[row] = pivot.sqrt().recip();
        }
        let narrow = |row: Vec<f64>| row.into_iter().map(|value| value as f32).collect();
        Some(Self {
            factor: factor.into_iter().map(narrow).collect(),
        })
    }

    /// `x` ← K⁻¹ b.
    pub fn solve<const L: usize>(&self, right_hand_side: &[Lanes<L>], x: &mut [Lanes<L>]) {
        for (row, values) in self.factor.iter().enumerate() {
            let mut sum = right_hand_side[row];
            for (value, known) in values[..row].iter().zip(&x[..row]) {
                for lane in 0..L {
                    sum[lane] -= value * known[lane];
                }
            }
            x[row] = sum.map(|sum| values[row] * sum);
        }
        for (row, values) in self.factor.iter().enumerate().rev() {
            let solved = x[row].map(|value| values[row] * value);
            x[row] = solved;
            for (value, open) in values[..row].iter().zip(&mut x[..row]) {
                for lane in 0..L {
                    open[lane] -= value * solved[lane];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::multigrid::examples::{hierarchy_of, lattice, random};

    #[test]
    fn the_solution_has_the_right_image() {
        let (lower, masses) = lattice(9, 8, 0.05);
        let hierarchy = hierarchy_of(&lower, &masses);
        let matrix = &hierarchy.levels[0].matrix;
        let right = random::<4>(72, 5);
        let mut x = vec![[0.0; 4]; 72];
        Coarsest::new(matrix).unwrap().solve(&right, &mut x);
        let mut residual = vec![[0.0; 4]; 72];
        matrix.residual(&right, &x, &mut residual);
        assert!(residual.as_flattened().iter().all(|r| r.abs() < 1e-4));
    }
}
