//! The function that starts to find eigenpairs.

use std::sync::Arc;

use numpy::IntoPyArray;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use spectral_tv::discretization::Discretization;
use spectral_tv::flow::Eigenpairs;
use spectral_tv::monitor::Stage;

use crate::arrays;
use crate::error::Failure;
use crate::job::Job;
use crate::mesh::Mesh;
use crate::parameters;

#[pyfunction]
pub fn start_eigenpairs(
    mesh: &Mesh,
    #[pyo3(from_py_with = parameters::count)] count: usize,
) -> Result<Job, Failure> {
    let mesh = Arc::clone(&mesh.inner);
    let work = move |stage: Stage| {
        let operators = Discretization::new_with(&mesh, stage)?;
        Eigenpairs::lowest_with(&mesh, &operators, count, stage)
    };
    Job::start(work, |py, pairs| {
        let functions = arrays::per_vertex(py, pairs.eigenfunctions.view())?;
        Ok((pairs.eigenvalues.into_pyarray(py), functions).into_bound_py_any(py)?)
    })
}
