//! The function that starts to test a set.

use std::sync::Arc;

use pyo3::prelude::*;
use spectral_tv::discretization::Elements;
use spectral_tv::eigenset;
use spectral_tv::monitor::Stage;

use crate::arrays;
use crate::error::Failure;
use crate::job::Job;
use crate::mesh::Mesh;
use crate::results::Fields;
use crate::settings::named;

#[pyfunction]
pub fn start_eigenset_test(
    mesh: &Mesh,
    members: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = named)] elements: Elements,
) -> Result<Job, Failure> {
    let set = arrays::set("members", members, mesh.inner.vertex_count())?;
    let mesh = Arc::clone(&mesh.inner);
    let work = move |stage: Stage| eigenset::eigenset_test_with(&mesh, &set, elements, stage);
    Job::start(work, |py, test| {
        let fields = Fields::new(py)
            .with("area", test.area)?
            .with("perimeter", test.perimeter)?
            .with("eigenvalue", test.eigenvalue())?
            .with("rate", test.rate)?
            .with("straightness", test.straightness)?
            .with("spread", test.spread)?
            .with("times", arrays::array_of(py, &test.times)?)?
            .with("values", arrays::array_of(py, &test.values)?)?
            .with("perimeter_ratio", test.perimeter_ratio)?
            .with("superset", arrays::array_of(py, &test.superset)?)?
            .with("minimal_perimeter", test.has_minimal_perimeter())?
            .with("is_eigenset", test.is_eigenset())?;
        Ok(fields.made("EigensetTest")?)
    })
}
