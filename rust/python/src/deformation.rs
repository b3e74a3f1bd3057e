//! The function that starts a deformation, and its result.

use std::sync::Arc;

use pyo3::prelude::*;
use spectral_tv::deformation::{self, Algorithm, Settings, deform_with};
use spectral_tv::monitor::Stage;

use crate::arrays;
use crate::error::Failure;
use crate::handles::Handles;
use crate::job::Job;
use crate::mesh::Mesh;
use crate::parameters;
use crate::settings::named;
use crate::shape::Shape;

/// The result of the package.
pub fn deformed<'py>(
    py: Python<'py>,
    shape: &Shape,
    solution: deformation::Deformation,
) -> Result<Bound<'py, PyAny>, Failure> {
    let fields = shape
        .displaced(py, solution.displacement)?
        .with("total_variation", solution.total_variation)?
        .with("gap", solution.gap)?
        .with("iterations", solution.iterations)?;
    Ok(fields.made("Deformation")?)
}

#[pyfunction]
pub fn start_deform(
    mesh: &Mesh,
    indices: &Bound<'_, PyAny>,
    targets: &Bound<'_, PyAny>,
    weights: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::softness)] softness: f64,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    #[pyo3(from_py_with = named)] algorithm: Algorithm,
) -> Result<Job, Failure> {
    let settings = Settings {
        algorithm,
        softness,
        tolerance,
    };
    let constraints = Handles::new(mesh, indices, weights)?.constraints(indices.py(), mesh)?;
    let targets = arrays::positions("targets", targets)?;
    let shape = Arc::new(Shape::new(mesh, constraints.floating()));
    let surface = Arc::clone(&shape.mesh);
    let work = move |stage: Stage| deform_with(&surface, constraints, &targets, settings, stage);
    Job::start(work, move |py, solution| deformed(py, &shape, solution))
}
