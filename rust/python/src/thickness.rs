//! The function that starts to measure how thick a shape is.

use std::sync::Arc;

use pyo3::prelude::*;
use spectral_tv::monitor::Stage;
use spectral_tv::thickness::{thickness_after_with, thickness_with};

use crate::arrays;
use crate::error::Failure;
use crate::job::Job;
use crate::mesh::Mesh;

#[pyfunction]
#[pyo3(signature = (mesh, before = None))]
pub fn start_thickness(mesh: &Mesh, before: Option<&Mesh>) -> Result<Job, Failure> {
    let mesh = Arc::clone(&mesh.inner);
    let before = before.map(|mesh| Arc::clone(&mesh.inner));
    let work = move |stage: Stage| match &before {
        Some(before) => thickness_after_with(&mesh, before, stage),
        None => thickness_with(&mesh, stage).map(<[f64]>::to_vec),
    };
    Job::start(work, |py, radii| {
        Ok(arrays::array_of(py, &radii)?.into_any())
    })
}
