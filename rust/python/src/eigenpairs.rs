//! The function `eigenpairs`.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use spectral_tv::discretization::Discretization;
use spectral_tv::flow::Eigenpairs;

use crate::arrays;
use crate::error::Failure;
use crate::job::Task;
use crate::mesh::Mesh;
use crate::parameters;

/// λ (K,) and u (V, K).
type Arrays<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);

/// The lowest eigenpairs of the Laplace–Beltrami operator, L u = λ M u with linear elements and
/// lumped masses, by block Lanczos iteration on the inverse.
///
/// Parameters
/// ----------
/// mesh : Mesh
/// count : int
///     Number of eigenpairs K; V if the mesh has no more. The time grows with the square of it,
///     and about twice as many functions are held in memory.
/// progress : callable, optional
///     Called with the fraction done; an exception it raises ends the work.
///
/// Returns
/// -------
/// (K,) array
///     The eigenvalues λ, rising from 0, 1/length². 0 as often as the mesh has components.
/// (V, K) array
///     The eigenfunctions, 1/length; Uᵀ diag(mesh.vertex_areas) U = 1 (a vertex in no triangle
///     counts with the mean area).
///
/// Raises
/// ------
/// MeshError
///     If count is 0.
/// MemoryError
///     If the work takes more than is available, before it starts.
#[pyfunction]
#[pyo3(signature = (mesh, count, progress = None))]
pub fn eigenpairs<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    #[pyo3(from_py_with = parameters::count)] count: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> Result<Arrays<'py>, Failure> {
    let mesh = Arc::clone(&mesh.inner);
    let task = Task::start(move |monitor| {
        let operators = Discretization::new(&mesh, monitor.whole())?;
        Eigenpairs::lowest(&mesh, &operators, count, monitor.whole())
    })?;
    let pairs = task.wait(py, progress)?;
    let functions = arrays::per_vertex(py, pairs.eigenfunctions.view())?;
    Ok((pairs.eigenvalues.into_pyarray(py), functions))
}
