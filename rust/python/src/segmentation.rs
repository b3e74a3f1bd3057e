//! The function that starts to label the parts of shapes.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyList;
use spectral_tv::monitor::Stage;
use spectral_tv::segmentation;

use crate::arrays;
use crate::decomposition::Decomposition;
use crate::error::Failure;
use crate::job::Job;
use crate::parameters;

#[pyfunction]
pub fn start_cosegment(
    decompositions: Vec<Bound<'_, Decomposition>>,
    #[pyo3(from_py_with = parameters::segments)] segments: usize,
    #[pyo3(from_py_with = parameters::seed)] seed: u64,
) -> Result<Job, Failure> {
    let splits: Vec<_> = decompositions
        .iter()
        .map(|decomposition| Arc::clone(&decomposition.get().inner))
        .collect();
    let work = move |stage: Stage| segmentation::cosegment_with(&splits, segments, seed, stage);
    Job::start(work, |py, labels: Vec<Vec<usize>>| {
        let signed = |labels: Vec<usize>| {
            arrays::collected(py, labels.into_iter().map(|label| label as i64))
        };
        let arrays = labels
            .into_iter()
            .map(signed)
            .collect::<Result<Vec<_>, _>>()?;
        Ok(PyList::new(py, arrays)?.into_any())
    })
}
