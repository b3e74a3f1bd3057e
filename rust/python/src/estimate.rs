//! The function that estimates what a decomposition takes.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_tv::memory;
use spectral_tv::method::{decomposition_duration, decomposition_memory};

use crate::error::Failure;
use crate::job::guarded;
use crate::mesh::Mesh;
use crate::results::Fields;
use crate::settings::settings;

#[pyfunction]
pub fn estimate<'py>(
    py: Python<'py>,
    mesh: &Bound<'py, PyAny>,
    options: &Bound<'py, PyDict>,
) -> Result<Bound<'py, PyAny>, Failure> {
    let settings = settings(options)?;
    let (vertices, triangles) = size(mesh)?;
    let seconds = guarded(py, |_| {
        decomposition_duration(vertices, triangles, &settings)
    })?;
    let fields = Fields::new(py)
        .with(
            "bytes",
            decomposition_memory(vertices, triangles, &settings),
        )?
        .with("available", memory::available())?
        .with("seconds", seconds)?;
    Ok(fields.made("Estimate")?)
}

/// Numbers of vertices and triangles.
fn size(mesh: &Bound<'_, PyAny>) -> PyResult<(usize, usize)> {
    if let Ok(mesh) = mesh.cast::<Mesh>() {
        let inner = &mesh.get().inner;
        return Ok((inner.vertex_count(), inner.triangles().len()));
    }
    let vertices: usize = mesh.extract().map_err(|_| {
        PyTypeError::new_err("mesh must be a Mesh or a number of vertices, 0 or more")
    })?;
    Ok((vertices, vertices.saturating_mul(2)))
}
