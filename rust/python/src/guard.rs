//! The functions that tell what a displacement does to the faces of a mesh.

use std::sync::Arc;

use ndarray::ArrayView2;
use numpy::PyArray1;
use pyo3::prelude::*;
use spectral_tv::guard;
use spectral_tv::monitor::Stage;

use crate::arrays;
use crate::error::Failure;
use crate::job::{Job, guarded};
use crate::mesh::Mesh;
use crate::parameters;
use crate::results::Fields;

#[pyfunction]
pub fn folds<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    displacement: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = parameters::stretch)] stretch: f64,
) -> Result<Bound<'py, PyAny>, Failure> {
    let mesh = &mesh.inner;
    let found = arrays::with_positions("displacement", displacement, |displacement| {
        guarded(py, |stage| {
            guard::folds_with(mesh, by_axis(displacement), stretch, stage)
        })
    })?;
    let fields = Fields::new(py)
        .with("flipped", faces(py, &found.flipped)?)?
        .with("stretched", faces(py, &found.stretched)?)?
        .with("largest_stretch", found.largest_stretch)?
        .with("safe_gain", found.safe_gain)?;
    Ok(fields.made("Folds")?)
}

#[pyfunction]
pub fn start_safe_displacement(
    mesh: &Mesh,
    displacement: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = parameters::stretch)] stretch: f64,
) -> Result<Job, Failure> {
    let displacement = arrays::positions("displacement", displacement)?;
    let mesh = Arc::clone(&mesh.inner);
    let work = move |stage: Stage| {
        guard::safe_displacement_with(&mesh, by_axis(&displacement), stretch, stage)
    };
    Job::start(work, |py, safe| {
        let fields = Fields::new(py)
            .with(
                "displacement",
                arrays::per_vertex(py, safe.displacement.view())?,
            )?
            .with("shares", arrays::array_of(py, &safe.shares)?)?
            .with("kept", safe.kept)?
            .with("rounds", safe.rounds)?;
        Ok(fields.made("SafeDisplacement")?)
    })
}

#[pyfunction]
pub fn start_self_intersections(
    mesh: &Mesh,
    displacement: Option<&Bound<'_, PyAny>>,
) -> Result<Job, Failure> {
    let displacement = displacement
        .map(|displacement| arrays::positions("displacement", displacement))
        .transpose()?;
    let mesh = Arc::clone(&mesh.inner);
    let work = move |stage: Stage| {
        let displacement = displacement.as_deref().map(by_axis);
        guard::self_intersections_with(&mesh, displacement, stage)
    };
    Job::start(work, |py, found| Ok(faces(py, &found)?.into_any()))
}

/// Vectors as the library has them, (3, V).
fn by_axis(vectors: &[[f64; 3]]) -> ArrayView2<'_, f64> {
    ArrayView2::from(vectors).reversed_axes()
}

fn faces<'py>(py: Python<'py>, faces: &[usize]) -> Result<Bound<'py, PyArray1<i64>>, Failure> {
    arrays::collected(py, faces.iter().map(|&face| face as i64))
}
