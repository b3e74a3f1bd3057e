//! H: the mass of the unknowns, lumped, or with couplings within triangles.

use std::borrow::Cow;

use ndarray::{ArrayView1, ArrayView2, ArrayViewMut1};

use crate::operators::squared_norm;

/// Iterations of conjugate gradients for a norm in H⁻¹. The condition of H against its diagonal part
/// is 5 at most, so what they leave is about 1e-3 of it.
const INVERSE_ITERATIONS: usize = 4;

/// wᵀ H w = Σ m w² + Σ_T c_T Σ_{pairs a, b in T} (w_a − w_b)², of N unknowns. The
/// rows of H sum to m, so couplings change no mean.
#[derive(Debug, Clone, Copy)]
pub struct Mass<'a> {
    diagonal: &'a [f64],
    /// c_T ≥ 0, F; none where the mass is lumped.
    couplings: &'a [f64],
    /// The unknowns of each triangle, F.
    triangles: &'a [[u32; 3]],
}

impl<'a> Mass<'a> {
    /// diag(m) of N masses.
    pub fn lumped(diagonal: &'a [f64]) -> Self {
        Self::coupled(diagonal, &[], &[])
    }

    /// H of m (N) and c (F, or none), of unknowns that triangles (F) share.
    pub fn coupled(diagonal: &'a [f64], couplings: &'a [f64], triangles: &'a [[u32; 3]]) -> Self {
        Self {
            diagonal,
            couplings,
            triangles,
        }
    }

    /// m, N.
    pub fn diagonal(&self) -> &'a [f64] {
        self.diagonal
    }

    /// Whether no unknowns are coupled.
    pub fn is_lumped(&self) -> bool {
        self.couplings.is_empty()
    }

    /// The off-diagonal entries of H that are a triangle's share, opposite to its unknowns; 0 for two
    /// places that have the same unknown.
    #[inline]
    pub fn off_diagonal(&self, triangle: usize) -> [f64; 3] {
        if self.is_lumped() {
            return [0.0; 3];
        }
        let [a, b, c] = self.triangles[triangle];
        let entry = -self.couplings[triangle];
        [(b, c), (c, a), (a, b)].map(|(p, q)| if p == q { 0.0 } else { entry })
    }

    /// w ← H w.
    pub fn apply(&self, mut values: ArrayViewMut1<f64>) {
        let product = self.couple(values.view());
        for (value, mass) in values.iter_mut().zip(self.diagonal) {
            *value *= mass;
        }
        for (value, coupled) in values.iter_mut().zip(product) {
            *value += coupled;
        }
    }

    /// wᵀ H w over all channels of `values` (C, N).
    pub fn squared_norm(&self, values: ArrayView2<f64>) -> f64 {
        let lumped = squared_norm(values, self.diagonal);
        match self.is_lumped() {
            true => lumped,
            false => {
                lumped
                    + values
                        .rows()
                        .into_iter()
                        .map(|w| self.coupling(w))
                        .sum::<f64>()
            }
        }
    }

    /// An upper bound of rᵀ H⁻¹ r, exact for a lumped mass. With y near H⁻¹ r and e = r − H y it is
    /// rᵀ y + eᵀ y + eᵀ diag(m)⁻¹ e, as H is not below diag(m).
    pub fn inverse_squared_norm(&self, residual: &[f64]) -> f64 {
        let mut solution = vec![0.0; residual.len()];
        let mut left = Cow::Borrowed(residual);
        if !self.is_lumped() {
            self.solve_roughly(&mut solution, left.to_mut());
        }
        let terms = residual
            .iter()
            .zip(left.iter())
            .zip(&solution)
            .zip(self.diagonal);
        terms
            .map(|(((r, e), y), mass)| (r + e) * y + e * e / mass)
            .sum()
    }

    /// Some steps of conjugate gradients from `solution` 0 towards H⁻¹ `left`, which becomes what is
    /// left.
    fn solve_roughly(&self, solution: &mut [f64], left: &mut [f64]) {
        let over = |left: &[f64]| -> Vec<f64> {
            let terms = left.iter().zip(self.diagonal);
            terms.map(|(r, mass)| r / mass).collect()
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(p, q)| p * q).sum::<f64>();
        let mut direction = over(left);
        let mut square = dot(left, &direction);
        for _ in 0..INVERSE_ITERATIONS {
            let mut product = direction.clone();
            self.apply(ArrayViewMut1::from(&mut product[..]));
            let curvature = dot(&direction, &product);
            if curvature.is_nan() || curvature <= 0.0 {
                return;
            }
            let length = square / curvature;
            for (y, d) in solution.iter_mut().zip(&direction) {
                *y += length * d;
            }
            for (r, p) in left.iter_mut().zip(&product) {
                *r -= length * p;
            }
            let preconditioned = over(left);
            let next = dot(left, &preconditioned);
            let growth = next / square;
            for (d, p) in direction.iter_mut().zip(&preconditioned) {
                *d = p + growth * *d;
            }
            square = next;
        }
    }

    /// Σ_T c_T Σ (w_a − w_b)², half its derivative; nothing for a lumped mass.
    fn couple(&self, values: ArrayView1<f64>) -> Vec<f64> {
        if self.is_lumped() {
            return Vec::new();
        }
        let mut product = vec![0.0; values.len()];
        for (triangle, coupling) in self.triangles.iter().zip(self.couplings) {
            let [a, b, c] = triangle.map(|unknown| values[unknown as usize]);
            let [ab, bc, ca] = [a - b, b - c, c - a];
            for (&unknown, change) in triangle.iter().zip([ab - ca, bc - ab, ca - bc]) {
                product[unknown as usize] += coupling * change;
            }
        }
        product
    }

    fn coupling(&self, values: ArrayView1<f64>) -> f64 {
        let triangles = self.triangles.iter().zip(self.couplings);
        let squares = triangles.map(|(triangle, coupling)| {
            let [a, b, c] = triangle.map(|unknown| values[unknown as usize]);
            coupling * ((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2))
        });
        squares.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array1, aview1};

    const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [2, 1, 3]];
    const MASSES: [f64; 4] = [0.1, 0.3, 0.3, 0.2];
    const COUPLINGS: [f64; 2] = [0.12, 0.23];

    #[test]
    fn couplings_keep_constants_and_are_symmetric() {
        let mass = Mass::coupled(&MASSES, &COUPLINGS, &TRIANGLES);
        let mut constant = Array1::from_elem(4, 2.0);
        mass.apply(constant.view_mut());
        for (value, own) in constant.iter().zip(MASSES) {
            assert!((value - 2.0 * own).abs() < 1e-15);
        }
        let values = [0.3, -1.0, 2.0, 0.7];
        let mut product = Array1::from(values.to_vec());
        mass.apply(product.view_mut());
        let square = mass.squared_norm(aview1(&values).insert_axis(ndarray::Axis(0)));
        assert!((product.dot(&aview1(&values)) - square).abs() < 1e-14);
    }

    #[test]
    fn the_norm_in_the_inverse_is_bounded_closely() {
        let mass = Mass::coupled(&MASSES, &COUPLINGS, &TRIANGLES);
        let values = aview1(&[0.3, -1.0, 2.0, 0.7]);
        let mut residual = values.to_owned();
        mass.apply(residual.view_mut());
        let exact = residual.dot(&values);
        let bound = mass.inverse_squared_norm(residual.as_slice().unwrap());
        assert!(bound >= exact * (1.0 - 1e-14) && bound <= 1.001 * exact);
        let lumped = Mass::lumped(&MASSES).inverse_squared_norm(&[0.1, 0.0, 0.6, 0.0]);
        assert!((lumped - (0.1 + 1.2)).abs() < 1e-14);
    }
}
