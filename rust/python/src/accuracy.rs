//! The function that starts to measure accuracy.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_tv::method::{self, AccuracyRequest};
use spectral_tv::monitor::Stage;

use crate::arrays;
use crate::error::{Failure, refused};
use crate::job::Job;
use crate::mesh::Mesh;
use crate::parameters;
use crate::results::Fields;
use crate::settings::settings;

#[pyfunction]
pub fn start_accuracy(
    mesh: &Mesh,
    steps: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = parameters::bands)] bands: usize,
    #[pyo3(from_py_with = parameters::scales)] scales: Option<(f64, f64)>,
    #[pyo3(from_py_with = parameters::refinement)] refinement: usize,
    #[pyo3(from_py_with = parameters::keep_limbs)] keep_limbs: f64,
    options: &Bound<'_, PyDict>,
) -> Result<Job, Failure> {
    let request = AccuracyRequest {
        settings: settings(options)?,
        steps: step_counts(steps)?,
        scales,
        bands,
        refinement,
        keep_limbs,
    };
    let mesh = Arc::clone(&mesh.inner);
    let work = move |stage: Stage| method::accuracy_with(&mesh, &request, stage);
    Job::start(work, |py, found| {
        let steps = found.steps.iter().map(|&count| count as i64);
        let mut fields = Fields::new(py)
            .with("steps", arrays::collected(py, steps)?)?
            .with("edges", arrays::array_of(py, &found.edges)?)?;
        for (way, errors) in [("", &found.ours), ("paper_", &found.paper)] {
            let table = |name, values| {
                Ok::<_, Failure>((format!("{way}{name}"), arrays::table_of(py, values)?))
            };
            for (name, values) in [
                table("all_pass", errors.all_pass.view())?,
                table("bands", errors.bands.view())?,
                table("relative", errors.relative.view())?,
            ] {
                fields = fields.with(&name, values)?;
            }
        }
        Ok(fields.made("Accuracy")?)
    })
}

/// Numbers of steps, whatever they are.
fn step_counts(steps: &Bound<'_, PyAny>) -> Result<Vec<usize>, Failure> {
    let counts = arrays::indices("steps", steps)?;
    let count = |&count: &i64| {
        usize::try_from(count)
            .map_err(|_| refused(format!("steps must be at least 2, not {count}")))
    };
    counts.iter().map(count).collect()
}
