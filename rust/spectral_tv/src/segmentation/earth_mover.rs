//! Spectra of vertices as points whose Euclidean distance is the earth mover's.

use ndarray::Array2;

use crate::method::Decomposition;

/// Quantiles that represent a distribution.
pub(super) const QUANTILES: usize = 24;
/// Least part of a vertex's spectrum in a component: where nothing ever moves, the distribution
/// is even.
const LEAST: f64 = 1e-9;

/// The quantile functions, (V, Q), of |φ(t)| at every vertex as a distribution over (t/area)^¼: in
/// between the size of features, which fine detail is too small for, and its logarithm, in which
/// it is all that counts.
///
/// In one dimension the L² distance of quantile functions is the earth mover's distance W₂ of the
/// distributions (Peyré and Cuturi 2019, "Computational Optimal Transport", Remark 2.30).
/// Relative times make it the same for shapes of any size.
pub(super) fn quantile_functions(decomposition: &Decomposition) -> Array2<f64> {
    let area: f64 = decomposition.vertex_areas().iter().sum();
    let edges = quartic_edges(decomposition.times(), area);
    let magnitudes = magnitudes(decomposition);
    let mut quantiles = Array2::zeros((magnitudes.ncols(), QUANTILES));
    for (spectrum, mut row) in magnitudes.columns().into_iter().zip(quantiles.rows_mut()) {
        let least = LEAST * spectrum.sum() + f64::MIN_POSITIVE;
        let total: f64 = spectrum.iter().map(|value| value + least).sum();
        let (mut component, mut below) = (0, 0.0);
        for (index, quantile) in row.iter_mut().enumerate() {
            let wanted = total * (index as f64 + 0.5) / QUANTILES as f64;
            while below + spectrum[component] + least < wanted && component + 1 < spectrum.len() {
                below += spectrum[component] + least;
                component += 1;
            }
            let within = ((wanted - below) / (spectrum[component] + least)).clamp(0.0, 1.0);
            *quantile = edges[component] + within * (edges[component + 1] - edges[component]);
        }
    }
    quantiles
}

/// (t/area)^¼ between which each component gathers what happens.
fn quartic_edges(times: &[f64], area: f64) -> Vec<f64> {
    let middle = |pair: &[f64]| (0.5 * (pair[0] + pair[1]) / area).powf(0.25);
    times.windows(2).map(middle).collect()
}

/// |φ_k| at every vertex, (N − 1, V).
fn magnitudes(decomposition: &Decomposition) -> Array2<f64> {
    let transform = decomposition.transform();
    let count = decomposition.component_times().len();
    let vertices = decomposition.vertex_areas().len();
    let mut magnitudes = Array2::zeros((count, vertices));
    for (index, mut row) in magnitudes.rows_mut().into_iter().enumerate() {
        let component = transform.component(index);
        for (magnitude, value) in row.iter_mut().zip(component.columns()) {
            *magnitude = value.dot(&value).sqrt();
        }
    }
    magnitudes
}
