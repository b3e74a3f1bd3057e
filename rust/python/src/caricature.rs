//! The functions that exaggerate several poses alike.

use std::sync::Arc;

use ndarray::Array2;
use numpy::PyArray2;
use pyo3::prelude::*;
use spectral_tv::method::{self, Exaggeration};

use crate::arrays;
use crate::error::Failure;
use crate::job::{Convert, Job, Task};
use crate::mesh::Mesh;
use crate::parameters;
use crate::settings::Request;

type Shapes = Vec<Array2<f64>>;

/// Exaggerate one band of several shapes alike, and smooth away what is finest (Brokman et al.
/// 2024, the figures of the armadillo).
///
/// Each shape is decomposed by itself, over the method's default times. These and the filter are
/// relative to its area, so that poses and sizes of one shape get the same.
///
/// Parameters
/// ----------
/// meshes : sequence of Mesh
///     They need not have vertices or triangles in common.
/// band : (float, float)
///     Where the band begins and ends, t/area; see `default_scales`.
/// gain : float
///     What the band is multiplied by.
/// smooth : float
///     What vanishes before this t/area, and is not in the band, is removed.
/// method : {"m3", "m1", "m2", "naive", "heat"}
///     As in `decompose`.
/// steps : int
///     Number of steps of each flow.
/// progress : callable, optional
///     Called with the fraction done; an exception it raises ends the work.
///
/// Returns
/// -------
/// list of (V, 3) arrays
///     The positions of each mesh.
///
/// Raises
/// ------
/// MeshError
///     If an argument is out of range.
#[pyfunction]
#[pyo3(signature = (meshes, band, gain = 2.0, smooth = 0.0, method = "m3", steps = 32,
                    progress = None))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn caricature<'py>(
    py: Python<'py>,
    meshes: Vec<Bound<'py, Mesh>>,
    #[pyo3(from_py_with = parameters::band)] band: (f64, f64),
    #[pyo3(from_py_with = parameters::gain)] gain: f64,
    #[pyo3(from_py_with = parameters::smooth)] smooth: f64,
    method: &str,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> Result<Vec<Bound<'py, PyArray2<f64>>>, Failure> {
    let filter = exaggeration(band, gain, smooth);
    let shapes = start(&meshes, filter, method, steps, |shapes| shapes)?.wait(py, progress)?;
    convert(py, &shapes)
}

/// Start `caricature` in a thread of its own and return the `Job` at once.
#[pyfunction]
#[pyo3(signature = (meshes, band, gain = 2.0, smooth = 0.0, method = "m3", steps = 32))]
pub fn start_caricature(
    meshes: Vec<Bound<'_, Mesh>>,
    #[pyo3(from_py_with = parameters::band)] band: (f64, f64),
    #[pyo3(from_py_with = parameters::gain)] gain: f64,
    #[pyo3(from_py_with = parameters::smooth)] smooth: f64,
    method: &str,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
) -> Result<Job, Failure> {
    let filter = exaggeration(band, gain, smooth);
    let task = start(&meshes, filter, method, steps, |shapes| -> Convert {
        Box::new(move |py| Ok(convert(py, &shapes)?.into_pyobject(py)?.into_any().unbind()))
    })?;
    Ok(Job::new(task))
}

fn exaggeration((from, to): (f64, f64), gain: f64, smooth: f64) -> Exaggeration {
    Exaggeration {
        smooth,
        from,
        to,
        gain,
    }
}

/// Starts the work in a thread; `wrap` makes of its result what the thread hands over.
fn start<T: Send + 'static>(
    meshes: &[Bound<'_, Mesh>],
    filter: Exaggeration,
    method: &str,
    steps: usize,
    wrap: impl FnOnce(Shapes) -> T + Send + 'static,
) -> Result<Task<T>, Failure> {
    let settings = Request::plain(method, steps).settings()?;
    let meshes: Vec<_> = meshes
        .iter()
        .map(|mesh| Arc::clone(&mesh.get().inner))
        .collect();
    Task::start(move |monitor| {
        let meshes: Vec<_> = meshes.iter().map(AsRef::as_ref).collect();
        method::caricature(&meshes, &settings, &filter, monitor.whole()).map(wrap)
    })
}

fn convert<'py>(
    py: Python<'py>,
    shapes: &Shapes,
) -> Result<Vec<Bound<'py, PyArray2<f64>>>, Failure> {
    shapes
        .iter()
        .map(|shape| arrays::per_vertex(py, shape.view()))
        .collect()
}
