//! The function that starts to exaggerate several poses alike.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use spectral_tv::method::{self, Exaggeration};
use spectral_tv::monitor::Stage;

use crate::arrays;
use crate::error::Failure;
use crate::job::Job;
use crate::mesh::Mesh;
use crate::parameters;
use crate::settings::settings;

#[pyfunction]
pub fn start_caricature(
    meshes: Vec<Bound<'_, Mesh>>,
    #[pyo3(from_py_with = parameters::band)] band: (f64, f64),
    #[pyo3(from_py_with = parameters::gain)] gain: f64,
    #[pyo3(from_py_with = parameters::smooth)] smooth: f64,
    #[pyo3(from_py_with = parameters::keep_limbs)] keep_limbs: f64,
    options: &Bound<'_, PyDict>,
) -> Result<Job, Failure> {
    let settings = settings(options)?;
    let (from, to) = band;
    let filter = Exaggeration {
        smooth,
        from,
        to,
        gain,
        keep_limbs,
    };
    let meshes: Vec<_> = meshes
        .iter()
        .map(|mesh| Arc::clone(&mesh.get().inner))
        .collect();
    let work = move |stage: Stage| method::caricature_with(&meshes, &settings, &filter, stage);
    Job::start(work, |py, shapes| {
        let arrays = shapes
            .iter()
            .map(|shape| arrays::per_vertex(py, shape.view()));
        let arrays = arrays.collect::<Result<Vec<_>, _>>()?;
        Ok(PyList::new(py, arrays)?.into_any())
    })
}
