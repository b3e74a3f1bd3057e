//! The functions that label the parts of shapes.

use std::sync::Arc;

use numpy::PyArray1;
use pyo3::prelude::*;
use spectral_tv::segmentation;

use crate::arrays;
use crate::decomposition::Decomposition;
use crate::error::Failure;
use crate::job::{Convert, Job, Task};
use crate::parameters;

type Labels = Vec<Vec<usize>>;

/// Label the parts of one shape in several poses, or of several shapes: the same label on the same
/// part. K-means of the vertices' spectra under the earth mover's distance, over all shapes
/// together (Brokman et al. 2024, figure "co-segmentation").
///
/// Parameters
/// ----------
/// decompositions : sequence of Decomposition
///     Best of method "m2". The shapes need not have vertices or triangles in common.
/// segments : int
///     Number of labels.
/// seed : int
///     Of the random starts.
/// progress : callable, optional
///     Called with the fraction done; an exception it raises ends the work.
///
/// Returns
/// -------
/// list of (V,) int64 arrays
///     Labels from 0, the largest segment, one array per decomposition.
///
/// Raises
/// ------
/// MeshError
///     If there are no decompositions, or segments is 0 or larger than the number of vertices.
#[pyfunction]
#[pyo3(signature = (decompositions, segments = 6, seed = 0, progress = None))]
pub fn cosegment<'py>(
    py: Python<'py>,
    decompositions: Vec<Bound<'py, Decomposition>>,
    #[pyo3(from_py_with = parameters::segments)] segments: usize,
    #[pyo3(from_py_with = parameters::seed)] seed: u64,
    progress: Option<&Bound<'py, PyAny>>,
) -> Result<Vec<Bound<'py, PyArray1<i64>>>, Failure> {
    let labels = start(&decompositions, segments, seed, |labels| labels)?.wait(py, progress)?;
    labels_of(py, labels)
}

/// Start `cosegment` in a thread of its own and return the `Job` at once.
#[pyfunction]
#[pyo3(signature = (decompositions, segments = 6, seed = 0))]
pub fn start_cosegment(
    decompositions: Vec<Bound<'_, Decomposition>>,
    #[pyo3(from_py_with = parameters::segments)] segments: usize,
    #[pyo3(from_py_with = parameters::seed)] seed: u64,
) -> Result<Job, Failure> {
    let task = start(&decompositions, segments, seed, |labels| -> Convert {
        Box::new(move |py| {
            Ok(labels_of(py, labels)?
                .into_pyobject(py)?
                .into_any()
                .unbind())
        })
    })?;
    Ok(Job::new(task))
}

fn start<T: Send + 'static>(
    decompositions: &[Bound<'_, Decomposition>],
    segments: usize,
    seed: u64,
    wrap: impl FnOnce(Labels) -> T + Send + 'static,
) -> Result<Task<T>, Failure> {
    let inner: Vec<_> = decompositions
        .iter()
        .map(|decomposition| Arc::clone(&decomposition.get().inner))
        .collect();
    Task::start(move |monitor| {
        let inner: Vec<_> = inner.iter().map(AsRef::as_ref).collect();
        segmentation::cosegment(&inner, segments, seed, monitor.whole()).map(wrap)
    })
}

fn labels_of(py: Python<'_>, labels: Labels) -> Result<Vec<Bound<'_, PyArray1<i64>>>, Failure> {
    let convert =
        |labels: Vec<usize>| arrays::collected(py, labels.into_iter().map(|label| label as i64));
    labels.into_iter().map(convert).collect()
}
