//! How far the bands of one flow are from those of another.

use ndarray::{Array1, Array2, Axis};

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
