//! The primal–dual Newton iteration for energies of TV type.
//!
//! Chan, Golub and Mulet 1999, "A Nonlinear Primal-Dual Method for Total Variation-Based Image
//! Restoration": keep the dual field z beside u, linearise |∇u|_ε z = ∇u instead of
//! z = ∇u/|∇u|_ε, and Newton converges in a few iterations from almost anywhere.

use ndarray::Array2;
use sprs::CsMatI;

use crate::error::Result;
use crate::minimization::energy::{Energy, Slope};
use crate::minimization::fields::{TangentField, clipping_factors, inner_products};
use crate::operators::{Discretization, FaceVector, element_stiffness};
use crate::solver::{Cholesky, conjugate_gradients};

/// Relative accuracy of the inner conjugate gradients, where channels are coupled.
const INNER_TOLERANCE: f64 = 0.1;
const MOST_INNER_ITERATIONS: usize = 100;

/// Newton directions for a sequence of energies on one mesh, and the dual field that is carried
/// from each to the next.
pub struct PrimalDualNewton {
    system: CsMatI<f64, u32>,
    cholesky: Cholesky,
    /// z, |z| ≤ 1 on every face.
    pub dual: TangentField,
}

impl PrimalDualNewton {
    /// Starts with the dual field 0, for functions with `channels` channels.
    ///
    /// # Errors
    /// [`crate::Error::Solver`] if memory does not suffice.
    pub fn new(operators: &Discretization, channels: usize) -> Result<Self> {
        let system = operators.pattern().zeros();
        let cholesky = Cholesky::analyse(&system)?;
        let faces = operators.gradient().face_areas().len();
        Ok(Self {
            system,
            cholesky,
            dual: vec![vec![[0.0; 2]; faces]; channels],
        })
    }

    /// The Newton direction: (M + τ Gᵀ A H G) δ = `descent`, H the symmetrised derivative.
    ///
    /// # Errors
    /// [`crate::Error::Solver`] if a system is far from positive definite.
    pub fn direction(
        &mut self,
        energy: &Energy,
        slope: &Slope,
        descent: &Array2<f64>,
    ) -> Result<Array2<f64>> {
        let operators = energy.operators;
        let gradient = operators.gradient();
        let dual = &self.dual;
        let scale = |face: usize| energy.tau * gradient.face_areas()[face] * slope.weights[face];
        let reweighted = |face: usize| element_stiffness(&gradient.hats()[face], scale(face));
        // H acts within the one channel of a scalar, so its matrix can be factorized itself.
        let newton = |face: usize| {
            let hats = &gradient.hats()[face];
            let along = |v: FaceVector| hats.map(|hat| hat[0] * v[0] + hat[1] * v[1]);
            let (z, g) = (along(dual[0][face]), along(slope.gradients[0][face]));
            let half = 0.5 * scale(face) * slope.weights[face];
            let mut edges = reweighted(face);
            for (edge, (p, q)) in edges.iter_mut().zip([(1, 2), (2, 0), (0, 1)]) {
                *edge -= half * (z[p] * g[q] + g[p] * z[q]);
            }
            edges
        };
        let (pattern, masses) = (operators.pattern(), energy.masses);
        let mut direction = descent.clone();
        let is_scalar = dual.len() == 1;
        if is_scalar {
            pattern.assemble(gradient, masses, newton, &mut self.system);
            pattern.pin(energy.fixed, &mut self.system);
            if self.cholesky.factorize(&self.system).is_ok() {
                self.cholesky.solve_in_place(&mut direction);
                return Ok(direction);
            }
            // H may be singular but for rounding, on needles. Reweighting always descends.
        }
        pattern.assemble(gradient, masses, reweighted, &mut self.system);
        pattern.pin(energy.fixed, &mut self.system);
        self.cholesky.factorize(&self.system)?;
        if is_scalar {
            self.cholesky.solve_in_place(&mut direction);
            return Ok(direction);
        }
        let hessian = |values: &Array2<f64>| apply_hessian(energy, slope, dual, values);
        let cholesky = &mut self.cholesky;
        Ok(conjugate_gradients(
            hessian,
            |residual| cholesky.solve_in_place(residual),
            descent,
            INNER_TOLERANCE,
            MOST_INNER_ITERATIONS,
        ))
    }

    /// z ← w (∇u + ∇δ − w ⟨∇u, ∇δ⟩ z), w = 1/|∇u|_ε, clipped to the unit ball.
    pub fn update_dual(&mut self, energy: &Energy, slope: &Slope, direction: &Array2<f64>) {
        let gradient = energy.operators.gradient();
        let changes: Vec<_> = direction
            .rows()
            .into_iter()
            .map(|d| gradient.apply(d))
            .collect();
        let along = inner_products(&slope.gradients, &changes);
        for ((dual, field), change) in self.dual.iter_mut().zip(&slope.gradients).zip(&changes) {
            for (face, z) in dual.iter_mut().enumerate() {
                let weight = slope.weights[face];
                for axis in 0..2 {
                    let linearised = field[face][axis] + change[face][axis];
                    z[axis] = weight * (linearised - weight * along[face] * z[axis]);
                }
            }
        }
        let clip = clipping_factors(&self.dual);
        for dual in &mut self.dual {
            for (z, factor) in dual.iter_mut().zip(&clip) {
                *z = z.map(|component| factor * component);
            }
        }
    }
}

/// (M + τ Gᵀ A H G) applied to `values` (C, V), H = w (I − ½ w (z gᵀ + g zᵀ)) over all channels.
fn apply_hessian(
    energy: &Energy,
    slope: &Slope,
    dual: &TangentField,
    values: &Array2<f64>,
) -> Array2<f64> {
    let gradient = energy.operators.gradient();
    let changes: Vec<_> = values
        .rows()
        .into_iter()
        .map(|v| gradient.apply(v))
        .collect();
    let along_gradient = inner_products(&slope.gradients, &changes);
    let along_dual = inner_products(dual, &changes);
    let mut product = values.clone();
    for (channel, mut row) in product.rows_mut().into_iter().enumerate() {
        let flux = gradient.adjoint(|face| {
            let weight = slope.weights[face];
            let (z, g) = (dual[channel][face], slope.gradients[channel][face]);
            std::array::from_fn(|axis| {
                let coupling = z[axis] * along_gradient[face] + g[axis] * along_dual[face];
                weight * (changes[channel][face][axis] - 0.5 * weight * coupling)
            })
        });
        for ((value, mass), flux) in row.iter_mut().zip(energy.masses).zip(flux) {
            *value = mass * *value + energy.tau * flux;
        }
    }
    energy.clear_fixed(&mut product);
    product
}
