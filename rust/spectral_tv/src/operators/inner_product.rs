//! Inner products of functions, summed up in parts: the same however many threads share the work.

use ndarray::ArrayView2;

use crate::parallel;

/// Σ a b over all vertices and channels of two functions (C, V).
pub fn inner_product(a: ArrayView2<f64>, b: ArrayView2<f64>) -> f64 {
    parallel::sum(a.ncols(), |vertices| {
        let [a, b] = [a, b].map(|array| parallel::columns(array, vertices.clone()));
        let channels = a.rows().into_iter().zip(b.rows());
        channels.map(|(a, b)| a.dot(&b)).sum()
    })
}

/// Σ m u² over all vertices and channels of a function (C, V).
pub fn squared_norm(values: ArrayView2<f64>, masses: &[f64]) -> f64 {
    parallel::sum(masses.len(), |vertices| {
        let masses = &masses[vertices.clone()];
        let values = parallel::columns(values, vertices);
        let channels = values.rows().into_iter();
        let squares = channels.map(|channel| {
            let terms = channel.into_iter().zip(masses);
            terms.map(|(value, mass)| mass * value * value).sum::<f64>()
        });
        squares.sum()
    })
}
