//! Algorithm 1 of Brokman et al. 2024, after Bronstein et al. 2016, "Consistent Discretization and
//! Minimization of the L1 Norm on Manifolds".

use ndarray::Array2;

use crate::deformation::problem::Task;
use crate::deformation::quadratic::{Quadratic, Stiffness, harmonic};
use crate::error::Result;
use crate::minimization::Variation;
use crate::operators::total_variation;

/// ε relative to the mean |∇d|, as for the flow M1.
const SMOOTHING: f64 = 1e-3;
const MOST_ITERATIONS: usize = 60;
/// A mean |∇d| that is rounding, times √area and relative to the spread: weights would be infinite.
const LEAST_STRETCH: f64 = 1e-14;

/// Repeats d ← argmin ‖M^(−1/2) L(w) d‖², w = 1/√(|∇d|² + ε²) of the last d, until no vertex moves
/// by more than the tolerance of the spread of the displacements. Starts from the gradient-based
/// linear deformation (Botsch and Sorkine 2008), which for handles that are not turned is the
/// harmonic one. Returns d (3, V) and the number of iterations.
pub(super) fn reweighted(task: Task) -> Result<(Array2<f64>, usize)> {
    let (problem, stage) = (task.problem, task.stage);
    let gradient = problem.operators.gradient();
    let area = problem.operators.area();
    let spread = problem.targets.spread();
    let springs = 1.0 / (spread * area.sqrt());
    let (mut state, _) = harmonic(task)?;
    let forces = Array2::zeros(state.dim());
    for iteration in 0..MOST_ITERATIONS {
        stage.report(iteration as f64 / MOST_ITERATIONS as f64)?;
        let mean = total_variation(gradient, state.view()) / area;
        if mean * area.sqrt() <= LEAST_STRETCH * spread {
            return Ok((state, iteration + 1));
        }
        let norms = gradient.norms(&state.view().into());
        let weights = Variation::smoothed(SMOOTHING * mean).weights(&norms);
        let last = state.clone();
        let stiffness = Stiffness::bending(&problem, &weights);
        Quadratic::new(problem, stiffness, springs, stage)?.minimise(&mut state, &forces);
        let moved = (&state - &last)
            .iter()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        if moved <= task.tolerance * spread {
            return Ok((state, iteration + 1));
        }
    }
    Ok((state, MOST_ITERATIONS))
}
