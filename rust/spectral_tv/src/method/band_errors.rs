//! How far the bands of one flow are from those of another.

use ndarray::{Array1, Array2, Axis};

use crate::flow::Trajectory;

/// The bands between `edges`, (C, V) each, with components spread evenly around their times.
///
/// Sums of components of the same flow at other times differ by what falls to the wrong side of
/// an edge; u − t u_t, interpolated linearly between the midpoints of the steps, does not.
pub(super) fn bands(trajectory: &Trajectory, edges: &[f64]) -> Vec<Array2<f64>> {
    let times = &trajectory.times;
    let steps = times.len() - 1;
    // u at t = 0, and from then on at the middle of step k − 1.
    let node = |k: usize| match k {
        0 => 0.0,
        k => 0.5 * (times[k - 1] + times[k]),
    };
    // Of every step's increment, how much of it is in u − t u_t at a node, u(0) apart.
    let share_of = |step: usize, k: usize| match step + 1 {
        later if later > k => 0.0,
        last if last == k => -times[step] / (times[k] - times[step]),
        _ => 1.0,
    };
    let intercept = |edge: f64| {
        let k = (1..steps).find(|&k| edge < node(k)).unwrap_or(steps);
        let share = (edge - node(k - 1)) / (node(k) - node(k - 1));
        let factor =
            |step: usize| (1.0 - share) * share_of(step, k - 1) + share * share_of(step, k);
        // u(0) apart, which is the same at every edge.
        let mut value = Array2::zeros(trajectory.initial().dim());
        trajectory.add_increments(&(0..steps).map(factor).collect::<Vec<_>>(), &mut value);
        value
    };
    let mut before = intercept(edges[0]);
    let mut bands = Vec::with_capacity(edges.len() - 1);
    for &edge in &edges[1..] {
        let after = intercept(edge);
        bands.push(&before - &after);
        before = after;
    }
    bands
}

/// The least norm of a band that errors are relative to, in that of the largest: what is less is
/// rounding.
const LEAST_BAND: f64 = 1e-12;

/// The distance of `bands` from `refined` at every vertex, over all bands together, and of each
/// band relative to its norm.
pub(super) fn band_errors(
    bands: &[Array2<f64>],
    refined: &[Array2<f64>],
    masses: &[f64],
) -> (Array1<f64>, Array1<f64>) {
    let mut squares = Array1::zeros(masses.len());
    let (mut errors, mut sizes) = (Vec::new(), Vec::new());
    for (band, refined) in bands.iter().zip(refined) {
        let distance = lengths(&(band - refined));
        errors.push(norm(&distance, masses));
        sizes.push(norm(&lengths(refined), masses));
        squares += &distance.mapv(|d| d * d);
    }
    let largest = errors.iter().chain(&sizes).copied().fold(0.0, f64::max);
    let least = (LEAST_BAND * largest).max(f64::MIN_POSITIVE);
    let relative = errors
        .iter()
        .zip(&sizes)
        .map(|(error, size)| error / size.max(least));
    (squares.mapv(f64::sqrt), relative.collect())
}

/// The norm over the surface of a function with these `lengths` at the vertices.
pub(super) fn norm(lengths: &Array1<f64>, masses: &[f64]) -> f64 {
    let terms = lengths.iter().zip(masses);
    terms.map(|(d, mass)| mass * d * d).sum::<f64>().sqrt()
}

/// |·| at every vertex, over all channels of `values` (C, V).
pub(super) fn lengths(values: &Array2<f64>) -> Array1<f64> {
    values.map_axis(Axis(0), |value| value.dot(&value).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn errors_are_relative_to_bands_and_finite_where_there_is_none() {
        let found = [array![[1.0, 2.0]], array![[0.0, 1e-3]]];
        let refined = [array![[1.0, 1.0]], array![[0.0, 0.0]]];
        let (distances, relative) = band_errors(&found, &refined, &[1.0, 3.0]);
        assert_eq!(distances[0], 0.0);
        assert!((relative[0] - 3.0_f64.sqrt() / 2.0).abs() < 1e-15);
        assert!(relative[1].is_finite() && relative[1] > 1e6);
        let (_, same) = band_errors(&refined, &refined, &[1.0, 3.0]);
        assert_eq!(same, array![0.0, 0.0]);
    }
}
