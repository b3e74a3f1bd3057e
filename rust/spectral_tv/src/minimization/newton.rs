//! The primal–dual Newton iteration for energies of TV type.
//!
//! Chan, Golub and Mulet 1999, "A Nonlinear Primal-Dual Method for Total Variation-Based Image
//! Restoration": keep the dual field z beside u, linearise |∇u|_ε z = ∇u instead of
//! z = ∇u/|∇u|_ε, and Newton converges in a few iterations from almost anywhere.

use ndarray::Array2;
use sprs::CsMatI;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::minimization::energy::{Energy, Slope};
use crate::minimization::fields::{TangentField, clipping_factors, inner_products, scaled};
use crate::monitor::Stage;
use crate::operators::{FaceVector, element_stiffness, pin};
use crate::solver::{Cholesky, conjugate_gradients};

/// Relative accuracy of the inner conjugate gradients, where channels are coupled.
const INNER_TOLERANCE: f64 = 0.1;
const MOST_INNER_ITERATIONS: usize = 100;

/// Newton directions for a sequence of energies on one mesh, and the dual field that is carried
/// from each to the next.
pub struct PrimalDualNewton {
    system: CsMatI<f64, u32>,
    cholesky: Cholesky,
    /// z, |z| ≤ 1 on every face that is not steep.
    dual: TangentField,
}

impl PrimalDualNewton {
    /// Starts with the dual field 0, for functions with `channels` channels.
    ///
    /// # Errors
    /// [`crate::Error::Memory`], [`crate::Error::Solver`] if the index range does not suffice, or
    /// [`crate::Error::Cancelled`].
    pub fn new(operators: &Discretization, channels: usize, stage: Stage) -> Result<Self> {
        let system = operators.pattern().zeros();
        let cholesky = operators.cholesky(stage)?;
        let faces = operators.gradient().face_areas().len();
        Ok(Self {
            system,
            cholesky,
            dual: vec![vec![[0.0; 2]; faces]; channels],
        })
    }

    /// The reweighted direction: (M + τ L(w)) δ = `descent`.
    ///
    /// # Errors
    /// [`crate::Error::Solver`] if the system is far from positive definite, or
    /// [`crate::Error::Cancelled`].
    pub fn reweighted(
        &mut self,
        energy: &Energy,
        slope: &Slope,
        descent: &Array2<f64>,
        stage: Stage,
    ) -> Result<Array2<f64>> {
        self.factorize(energy, reweighted_stiffness(energy, slope), stage)?;
        Ok(self.cholesky.solve(descent.view()))
    }

    /// The Newton direction: (M + τ Gᵀ A H G) δ = `descent`, H the symmetrised derivative.
    ///
    /// # Errors
    /// As [`Self::reweighted`].
    pub fn direction(
        &mut self,
        energy: &Energy,
        slope: &Slope,
        descent: &Array2<f64>,
        stage: Stage,
    ) -> Result<Array2<f64>> {
        if self.dual.len() == 1 {
            let stiffness = newton_stiffness(energy, slope, self.dual[0].clone());
            if self.factorize(energy, stiffness, stage).is_err() {
                // H may be singular but for rounding, on needles. Reweighting always descends.
                return self.reweighted(energy, slope, descent, stage);
            }
            return Ok(self.cholesky.solve(descent.view()));
        }
        self.factorize(energy, reweighted_stiffness(energy, slope), stage)?;
        let (cholesky, dual) = (&mut self.cholesky, &self.dual);
        Ok(conjugate_gradients(
            |values| apply_hessian(energy, slope, dual, values),
            |residual| cholesky.solve_in_place(residual),
            descent,
            INNER_TOLERANCE,
            MOST_INNER_ITERATIONS,
        ))
    }

    fn factorize(
        &mut self,
        energy: &Energy,
        stiffness: impl Fn(usize) -> [f64; 3],
        stage: Stage,
    ) -> Result<()> {
        let pattern = energy.operators.pattern();
        let gradient = energy.operators.gradient();
        let system = &mut self.system;
        let (mass, masses) = (energy.mass, energy.mass.diagonal());
        match mass.is_lumped() {
            true => stage.pass(|| pattern.assemble(gradient, masses, stiffness, system))?,
            false => {
                let both = |face| {
                    let ([a, b, c], [x, y, z]) = (stiffness(face), mass.off_diagonal(face));
                    [a + x, b + y, c + z]
                };
                stage.pass(|| pattern.assemble(gradient, masses, both, system))?;
            }
        }
        pin(energy.fixed, &mut self.system);
        self.cholesky.factorize(&self.system, stage)
    }

    /// The dual field brought into balance with `state` (C, V): z + w ∇q, the least change, for
    /// the metric of the weights, that makes M(u − û) + τ Gᵀ A z vanish at free vertices. It may
    /// leave the unit ball. The weights are those of the last direction.
    ///
    /// # Errors
    /// As [`Self::reweighted`].
    pub fn balanced_dual(
        &mut self,
        energy: &Energy,
        slope: &Slope,
        state: &Array2<f64>,
        stage: Stage,
    ) -> Result<TangentField> {
        if self.dual.len() == 1 {
            // The factor at hand may be that of H.
            self.factorize(energy, reweighted_stiffness(energy, slope), stage)?;
        }
        let gradient = energy.operators.gradient();
        let mut potential = energy.descent_of(state.view(), &self.dual);
        self.cholesky.solve_in_place(&mut potential);
        let channels = self.dual.iter().zip(potential.rows());
        let balanced = channels.map(|(z, potential)| {
            let change = |face| gradient.on_face(face, &potential);
            let balanced = |face: usize| {
                let ([x, y], [p, q]) = (z[face], change(face));
                [x + slope.weights[face] * p, y + slope.weights[face] * q]
            };
            (0..z.len()).map(balanced).collect()
        });
        Ok(balanced.collect())
    }

    /// z ← w (∇u + ∇δ − w ⟨∇u, ∇δ⟩ z), w = 1/|∇u|_ε; on steep faces w (∇u + ∇δ).
    pub fn update_dual(&mut self, energy: &Energy, slope: &Slope, direction: &Array2<f64>) {
        let changes = energy.gradients(direction.view());
        let along = inner_products(&slope.gradients, &changes);
        let mut field = std::mem::take(&mut self.dual);
        for ((dual, gradients), change) in field.iter_mut().zip(&slope.gradients).zip(&changes) {
            for (face, z) in dual.iter_mut().enumerate() {
                let weight = slope.weights[face];
                let bend = energy.bend(weight);
                for axis in 0..2 {
                    let linearised = gradients[face][axis] + change[face][axis];
                    z[axis] = weight * (linearised - bend * along[face] * z[axis]);
                }
            }
        }
        self.set_dual(energy, slope, field);
    }

    /// Goes on from `dual`, which is within the unit ball.
    pub fn go_on_from(&mut self, dual: TangentField) {
        self.dual = dual;
    }

    /// Starts anew with the dual field 0, for functions with `channels` channels.
    pub fn forget(&mut self, channels: usize) {
        let faces = self.dual.first().map_or(0, Vec::len);
        self.dual = vec![vec![[0.0; 2]; faces]; channels];
    }

    /// The dual field z.
    pub fn dual(&self) -> &TangentField {
        &self.dual
    }

    /// Goes on from `field`, clipped to the unit ball where faces are not steep.
    pub fn set_dual(&mut self, energy: &Energy, slope: &Slope, mut field: TangentField) {
        let clip = clipping_factors(&field);
        for channel in &mut field {
            for (face, z) in channel.iter_mut().enumerate() {
                if !energy.is_steep(slope.weights[face]) {
                    *z = scaled(clip[face], *z);
                }
            }
        }
        self.dual = field;
    }
}

/// Every face's share of τ L(w).
fn reweighted_stiffness(energy: &Energy, slope: &Slope) -> impl Fn(usize) -> [f64; 3] {
    let gradient = energy.operators.gradient();
    move |face| {
        // The area first: its product with ∇λ ∇λ′ has no unit.
        let edges = element_stiffness(&gradient.hats(face), gradient.face_areas()[face]);
        let scale = energy.tau * slope.weights[face];
        edges.map(|edge| scale * edge)
    }
}

/// Every face's share of τ Gᵀ A H G for a scalar, where H acts within the one channel, so that
/// its matrix can be factorized itself.
fn newton_stiffness(
    energy: &Energy,
    slope: &Slope,
    dual: Vec<FaceVector>,
) -> impl Fn(usize) -> [f64; 3] {
    let gradient = energy.operators.gradient();
    move |face| {
        let hats = &gradient.hats(face);
        let along = |v: FaceVector| hats.map(|hat| hat[0] * v[0] + hat[1] * v[1]);
        let (z, g) = (along(dual[face]), along(slope.gradients[0][face]));
        let (area, weight) = (gradient.face_areas()[face], slope.weights[face]);
        let half = 0.5 * area * energy.bend(weight);
        let mut edges = element_stiffness(hats, area);
        for (edge, (p, q)) in edges.iter_mut().zip([(1, 2), (2, 0), (0, 1)]) {
            *edge -= half * (z[p] * g[q] + g[p] * z[q]);
        }
        let scale = energy.tau * weight;
        edges.map(|edge| scale * edge)
    }
}

/// (M + τ Gᵀ A H G) applied to `values` (C, V), H = w (I − ½ w (z gᵀ + g zᵀ)) over all channels;
/// w I on steep faces.
fn apply_hessian(
    energy: &Energy,
    slope: &Slope,
    dual: &TangentField,
    values: &Array2<f64>,
) -> Array2<f64> {
    let gradient = energy.operators.gradient();
    let changes = energy.gradients(values.view());
    let along_gradient = inner_products(&slope.gradients, &changes);
    let along_dual = inner_products(dual, &changes);
    let mut product = values.clone();
    for (channel, mut row) in product.rows_mut().into_iter().enumerate() {
        let flux = gradient.adjoint(|face| {
            let weight = slope.weights[face];
            let (z, g) = (dual[channel][face], slope.gradients[channel][face]);
            let (change, bend) = (changes[channel][face], energy.bend(weight));
            let component = |axis: usize| {
                let coupling = z[axis] * along_gradient[face] + g[axis] * along_dual[face];
                weight * (change[axis] - 0.5 * bend * coupling)
            };
            [component(0), component(1)]
        });
        energy.mass.apply(row.view_mut());
        for (value, flux) in row.iter_mut().zip(flux) {
            *value += energy.tau * flux;
        }
    }
    energy.clear_fixed(&mut product);
    product
}
