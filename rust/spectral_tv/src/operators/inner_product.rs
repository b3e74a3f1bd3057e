//! Inner products of functions, summed up in parts: the same however many threads share the work.

use ndarray::parallel::prelude::*;
use ndarray::{ArrayView2, Axis};
use rayon::prelude::ParallelSlice;

/// Vertices that one thread works on at a time.
const CHUNK: usize = 1 << 13;

/// Σ a b over all vertices and channels of two functions (C, V).
pub fn inner_product(a: ArrayView2<f64>, b: ArrayView2<f64>) -> f64 {
    let parts = a.axis_chunks_iter(Axis(1), CHUNK).into_par_iter();
    let parts = parts.zip(b.axis_chunks_iter(Axis(1), CHUNK).into_par_iter());
    let parts = parts.map(|(a, b)| {
        let channels = a.rows().into_iter().zip(b.rows());
        channels.map(|(a, b)| a.dot(&b)).sum::<f64>()
    });
    parts.collect::<Vec<_>>().iter().sum()
}

/// Σ m u² over all vertices and channels of a function (C, V).
pub fn squared_norm(values: ArrayView2<f64>, masses: &[f64]) -> f64 {
    let parts = values.axis_chunks_iter(Axis(1), CHUNK).into_par_iter();
    let parts = parts.zip(masses.par_chunks(CHUNK)).map(|(values, masses)| {
        let channels = values.rows().into_iter();
        let squares = channels.map(|channel| {
            let terms = channel.into_iter().zip(masses);
            terms.map(|(value, mass)| mass * value * value).sum::<f64>()
        });
        squares.sum::<f64>()
    });
    parts.collect::<Vec<_>>().iter().sum()
}
