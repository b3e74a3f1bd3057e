//! The primal–dual Newton iteration for a proximal step of TV.
//!
//! Chan, Golub and Mulet 1999, "A Nonlinear Primal-Dual Method for Total Variation-Based Image
//! Restoration": keep the dual field z beside u, linearise |∇u|_ε z = ∇u instead of
//! z = ∇u/|∇u|_ε, and Newton converges in a few iterations from almost anywhere.

use ndarray::{Array2, ArrayView2};
use sprs::CsMatI;

use crate::error::Result;
use crate::flow::proximal::{clipping_factors, duality_gap};
use crate::flow::time_step::TimeStep;
use crate::flow::trajectory::Solution;
use crate::monitor::Stage;
use crate::operators::{Discretization, FaceVector, element_stiffness};
use crate::solver::{Cholesky, conjugate_gradients};

/// Factorizations after which a step ends with the gap it has, which is reported.
const MOST_ITERATIONS: usize = 200;
/// Shrinkage of ε from one iteration to the next, while it is above its goal.
const CONTINUATION: f64 = 0.2;
/// Relative accuracy of the inner conjugate gradients, where channels are coupled.
const INNER_TOLERANCE: f64 = 0.1;
const MOST_INNER_ITERATIONS: usize = 100;
/// Sufficient decrease asked of the line search (Armijo), and its smallest step.
const SUFFICIENT_DECREASE: f64 = 1e-4;
const SMALLEST_STEP: f64 = 1e-3;

/// Solves a sequence of proximal steps, each warm-started by the dual of the one before.
pub(super) struct ProximalNewton<'a> {
    operators: &'a Discretization,
    system: CsMatI<f64, u32>,
    cholesky: Cholesky,
    dual: Vec<Vec<FaceVector>>,
    epsilon: f64,
}

/// ∇u on every face, channel by channel, and its smoothed norm over all channels.
struct Slope {
    gradients: Vec<Vec<FaceVector>>,
    norms: Vec<f64>,
}

impl<'a> ProximalNewton<'a> {
    /// A solver for functions with `channels` channels.
    pub fn new(operators: &'a Discretization, channels: usize) -> Result<Self> {
        let system = operators.pattern().zeros();
        let cholesky = Cholesky::analyse(&system)?;
        let faces = operators.gradient().face_areas().len();
        Ok(Self {
            operators,
            system,
            cholesky,
            dual: vec![vec![[0.0; 2]; faces]; channels],
            epsilon: f64::INFINITY,
        })
    }

    /// argmin ½‖u − û‖²_M + τ TV(u), to a gap of `tolerance` relative to τ `start`, the TV at
    /// the start of the step.
    pub fn solve(
        &mut self,
        step: &TimeStep,
        start: f64,
        tolerance: f64,
        stage: Stage,
    ) -> Result<Solution> {
        let mean_gradient = start / self.operators.area();
        // Smoothing costs at most about 0.3 ε a unit of area, so this much is affordable.
        let goal = tolerance * mean_gradient;
        self.epsilon = self.epsilon.min(mean_gradient).max(goal);
        let target = tolerance * step.tau * start;
        let mut best = Solution {
            state: step.data.clone(),
            gap: f64::INFINITY,
            tau: step.tau,
        };
        let mut state = step.data.clone();
        for _ in 0..MOST_ITERATIONS {
            stage.check()?;
            let slope = self.slope(state.view());
            let descent = self.descent(step, &state, &slope);
            let direction = self.direction(step, &slope, &descent)?;
            let length = self.line_search(step, &state, &direction, &descent);
            self.update_dual(&slope, &direction);
            state.scaled_add(length, &direction);
            let gap = duality_gap(self.operators, step, state.view(), &self.dual);
            if gap < best.gap {
                best.gap = gap;
                best.state.assign(&state);
            }
            if best.gap <= target {
                break;
            }
            self.epsilon = (CONTINUATION * self.epsilon).max(goal);
        }
        Ok(best)
    }

    fn slope(&self, state: ArrayView2<f64>) -> Slope {
        let gradient = self.operators.gradient();
        let gradients: Vec<_> = state
            .rows()
            .into_iter()
            .map(|u| gradient.apply(u))
            .collect();
        let mut norms = vec![self.epsilon * self.epsilon; gradient.face_areas().len()];
        for field in &gradients {
            for (square, [x, y]) in norms.iter_mut().zip(field) {
                *square += x * x + y * y;
            }
        }
        norms.iter_mut().for_each(|square| *square = square.sqrt());
        Slope { gradients, norms }
    }

    /// The negative gradient of the smoothed energy: −(M(u − û) + τ Gᵀ A ∇u/|∇u|_ε).
    fn descent(&self, step: &TimeStep, state: &Array2<f64>, slope: &Slope) -> Array2<f64> {
        let mut descent = &step.data - state;
        for (mut row, field) in descent.rows_mut().into_iter().zip(&slope.gradients) {
            let divergence = self
                .operators
                .gradient()
                .adjoint(|face| field[face].map(|component| component / slope.norms[face]));
            for ((value, mass), flux) in row.iter_mut().zip(self.operators.masses()).zip(divergence)
            {
                *value = mass * *value - step.tau * flux;
            }
        }
        descent
    }

    /// The Newton direction: (M + τ Gᵀ A H G) δ = `descent`, H the symmetrised derivative.
    fn direction(
        &mut self,
        step: &TimeStep,
        slope: &Slope,
        descent: &Array2<f64>,
    ) -> Result<Array2<f64>> {
        let operators = self.operators;
        let gradient = operators.gradient();
        let dual = &self.dual;
        let is_scalar = dual.len() == 1;
        let stiffness = |face: usize| {
            let scale = step.tau * gradient.face_areas()[face] / slope.norms[face];
            let hats = &gradient.hats()[face];
            let mut edges = element_stiffness(hats, scale);
            if is_scalar {
                // H acts within the one channel, so the matrix holds it exactly.
                let (z, g) = (dual[0][face], slope.gradients[0][face]);
                let along = |v: FaceVector| hats.map(|hat| hat[0] * v[0] + hat[1] * v[1]);
                let (z, g) = (along(z), along(g));
                let half = 0.5 * scale / slope.norms[face];
                for (edge, (p, q)) in edges.iter_mut().zip([(1, 2), (2, 0), (0, 1)]) {
                    *edge -= half * (z[p] * g[q] + g[p] * z[q]);
                }
            }
            edges
        };
        operators
            .pattern()
            .assemble(gradient, operators.masses(), stiffness, &mut self.system);
        self.cholesky.factorize(&self.system)?;
        let mut direction = descent.clone();
        if is_scalar {
            self.cholesky.solve_in_place(&mut direction);
            return Ok(direction);
        }
        let hessian = |values: &Array2<f64>| apply_hessian(operators, step, slope, dual, values);
        let cholesky = &mut self.cholesky;
        Ok(conjugate_gradients(
            hessian,
            |residual| cholesky.solve_in_place(residual),
            descent,
            INNER_TOLERANCE,
            MOST_INNER_ITERATIONS,
        ))
    }

    /// Halves the step until the smoothed energy falls enough.
    fn line_search(
        &self,
        step: &TimeStep,
        state: &Array2<f64>,
        direction: &Array2<f64>,
        descent: &Array2<f64>,
    ) -> f64 {
        let slope: f64 = (descent * direction).sum();
        let start = self.smoothed_energy(step, state);
        let mut length = 1.0;
        while length > SMALLEST_STEP {
            let trial = state + &(direction * length);
            let bound = start - SUFFICIENT_DECREASE * length * slope;
            if self.smoothed_energy(step, &trial) <= bound {
                break;
            }
            length *= 0.5;
        }
        length
    }

    /// ½‖u − û‖²_M + τ Σ_f A_f √(|∇u|² + ε²).
    fn smoothed_energy(&self, step: &TimeStep, state: &Array2<f64>) -> f64 {
        let gradient = self.operators.gradient();
        let square = self.epsilon * self.epsilon;
        let variation: f64 = gradient
            .squared_norms(state.view())
            .iter()
            .zip(gradient.face_areas())
            .map(|(norm, area)| area * (norm + square).sqrt())
            .sum();
        let mut distance = 0.0;
        for (row, data) in state.rows().into_iter().zip(step.data.rows()) {
            for ((u, f), mass) in row.iter().zip(data).zip(self.operators.masses()) {
                distance += 0.5 * mass * (u - f) * (u - f);
            }
        }
        distance + step.tau * variation
    }

    /// z ← (∇u + ∇δ − z ⟨∇u, ∇δ⟩/|∇u|_ε)/|∇u|_ε, clipped to the unit ball.
    fn update_dual(&mut self, slope: &Slope, direction: &Array2<f64>) {
        let gradient = self.operators.gradient();
        let changes: Vec<_> = direction
            .rows()
            .into_iter()
            .map(|d| gradient.apply(d))
            .collect();
        let along = inner_products(&slope.gradients, &changes);
        for ((dual, field), change) in self.dual.iter_mut().zip(&slope.gradients).zip(&changes) {
            for (face, z) in dual.iter_mut().enumerate() {
                let norm = slope.norms[face];
                for axis in 0..2 {
                    let linearised = field[face][axis] + change[face][axis];
                    z[axis] = (linearised - z[axis] * along[face] / norm) / norm;
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

/// (M + τ Gᵀ A H G) applied to `values` (C, V), H = (I − ½(z gᵀ + g zᵀ)/n)/n over all channels.
fn apply_hessian(
    operators: &Discretization,
    step: &TimeStep,
    slope: &Slope,
    dual: &[Vec<FaceVector>],
    values: &Array2<f64>,
) -> Array2<f64> {
    let gradient = operators.gradient();
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
            let norm = slope.norms[face];
            let (z, g) = (dual[channel][face], slope.gradients[channel][face]);
            std::array::from_fn(|axis| {
                let coupling = z[axis] * along_gradient[face] + g[axis] * along_dual[face];
                (changes[channel][face][axis] - 0.5 * coupling / norm) / norm
            })
        });
        for ((value, mass), flux) in row.iter_mut().zip(operators.masses()).zip(flux) {
            *value = mass * *value + step.tau * flux;
        }
    }
    product
}

/// ⟨a, b⟩ on every face, over all channels.
fn inner_products(a: &[Vec<FaceVector>], b: &[Vec<FaceVector>]) -> Vec<f64> {
    let mut products = vec![0.0; a[0].len()];
    for (a, b) in a.iter().zip(b) {
        for ((product, p), q) in products.iter_mut().zip(a).zip(b) {
            *product += p[0] * q[0] + p[1] * q[1];
        }
    }
    products
}
