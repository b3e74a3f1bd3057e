//! Predicts the next step from the last states: its increments, weights and masses.
//!
//! Measurements of the error of bands on real meshes decided which variables are taken as linear in
//! time, and what the limits are.

use ndarray::Array2;
use rayon::prelude::*;

use crate::flow::increment::{Increment, weighted_sum};
use crate::parallel;

/// Least fraction of a gradient that a prediction leaves.
const LEAST_GRADIENT: f64 = 1e-3;
/// Change of ln m beyond which a mass is not predicted: a limb that collapses within a step
/// would be torn apart, its vertices losing their weight one here, one there.
const LARGEST_MASS_CHANGE: f64 = 2.0;

/// A step may look ahead as far as the last one reaches back, in log t, and half as much again.
const FARTHEST: f64 = 1.5;
/// How much of the velocity's curvature is believed: more of it overshoots, less lags behind.
const CURVATURE: f64 = 0.6;

/// u_{k+1} − u_k, of the given `shape` (C, V), from the k `increments` before: the velocity is
/// continued along a parabola in the logarithm of time, somewhat straightened; `None` for the
/// first step.
pub(super) fn predicted_increment(
    increments: &[Increment],
    times: &[f64],
    shape: (usize, usize),
) -> Option<Array2<f64>> {
    let k = increments.len();
    let length = |k: usize| times[k + 1] - times[k];
    let logarithm = |k: usize| (times[k + 1] + times[k]).ln();
    let last = k.checked_sub(1)?;
    let known: Vec<f64> = (0..k.min(3)).map(|back| logarithm(last - back)).collect();
    let weights = extrapolation(&known, logarithm(k)).into_iter().enumerate();
    let terms = weights.map(|(back, weight)| {
        let step = last - back;
        (weight * length(k) / length(step), &increments[step])
    });
    Some(weighted_sum(shape, terms.collect::<Vec<_>>()))
}

/// Weights of the values at up to three places, latest first, in the value expected at `next`.
fn extrapolation(places: &[f64], next: f64) -> Vec<f64> {
    let &[a, b, ref earlier @ ..] = places else {
        return vec![1.0; places.len()];
    };
    let ahead = ((next - a) / (a - b)).min(FARTHEST);
    let mut weights = vec![1.0 + ahead, -ahead];
    if let Some(c) = earlier.first() {
        // Newton's term of second order, at most as far ahead.
        let next = a + ahead * (a - b);
        let curvature = CURVATURE * (next - a) * (next - b) / (a - c);
        weights[0] += curvature / (a - b);
        weights[1] -= curvature / (a - b) + curvature / (b - c);
        weights.push(curvature / (b - c));
    }
    weights
}

/// |∇u| on every face a step of `growth` times the last one's length ahead, √|∇u| taken as
/// linear in time: unlike the gradient itself, that neither changes sign nor bounces back where
/// a face goes flat.
pub(super) fn predicted_gradients(norms: &[f64], previous: &[f64], growth: f64) -> Vec<f64> {
    let least = LEAST_GRADIENT.sqrt();
    let predict = |(now, before): (&f64, &f64)| {
        let (now, before) = (now.sqrt(), before.sqrt());
        (now + growth * (now - before)).max(least * now).powi(2)
    };
    parallel::map(norms.par_iter().zip(previous), predict)
}

/// Vertex masses a step ahead, ⁴√m taken as linear in time, as a mass goes like the square of
/// a gradient; the more it would change, the less of the change is believed.
pub(super) fn predicted_masses(masses: &[f64], previous: &[f64], growth: f64) -> Vec<f64> {
    let predict = |(&mass, before): (&f64, &f64)| {
        let ratio = (before / mass).sqrt().sqrt();
        let ahead = (1.0 + growth * (1.0 - ratio)).max(LEAST_GRADIENT);
        let change = 4.0 * ahead.ln();
        mass * (change * (-(change / LARGEST_MASS_CHANGE).powi(2)).exp()).exp()
    };
    parallel::map(masses.par_iter().zip(previous), predict)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::increment::Precision;

    #[test]
    fn velocities_linear_in_log_t_are_continued_exactly() {
        let times = [0.0_f64, 1e-3, 3e-3, 1e-2, 2e-2];
        let velocity = |k: usize| 2.0 - 0.3 * (times[k] + times[k + 1]).ln();
        let step = |k: usize| velocity(k) * (times[k + 1] - times[k]);
        let increment =
            |k: usize| Increment::new(&Array2::from_elem((1, 1), step(k)), Precision::Double);
        let increments: Vec<_> = (0..4).map(increment).collect();
        assert!(predicted_increment(&[], &times, (1, 1)).is_none());
        for k in 2..4 {
            let expected = predicted_increment(&increments[..k], &times, (1, 1)).unwrap();
            assert!((expected[[0, 0]] - step(k)).abs() < 1e-14);
        }
    }

    #[test]
    fn slow_change_is_continued() {
        let ahead = predicted_gradients(&[0.99], &[1.0], 1.0)[0];
        assert!((ahead - 0.98).abs() < 1e-4);
        let ahead = predicted_masses(&[0.99], &[1.0], 1.0)[0];
        assert!((ahead - 0.98).abs() < 1e-4);
    }

    #[test]
    fn collapse_is_not_overshot() {
        let gradients = predicted_gradients(&[0.01, 0.0, 1.0], &[1.0, 0.5, 0.0], 2.0);
        assert!(gradients[0] > 0.0 && gradients[0] < 1e-4);
        assert_eq!(gradients[1], 0.0);
        assert!(gradients[2].is_finite());
        let masses = predicted_masses(&[1e-6, 1.0], &[1.0, 1e-6], 2.0);
        assert!((masses[0] / 1e-6 - 1.0).abs() < 1e-3);
        assert!(masses[1] > 1.0 && masses[1] < 3.0);
    }
}
