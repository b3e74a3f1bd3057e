//! The functions that start one flow, and that measure total variation.

use std::sync::Arc;

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_tv::Named;
use spectral_tv::discretization::{Discretization, Elements};
use spectral_tv::flow::{Operator, Scheme, conformal_mean_curvature_flow_with, flow_with};
use spectral_tv::monitor::Stage;
use spectral_tv::operators;
use spectral_tv::solver::Solver;
use spectral_tv::spectral::SpectralTransform;

use crate::arrays;
use crate::error::Failure;
use crate::flow::{Flow, Layout};
use crate::job::{Job, guarded};
use crate::mesh::Mesh;
use crate::parameters;
use crate::settings::{named, named_or_none, stepping};

#[pyfunction]
pub fn start_flow(
    mesh: &Mesh,
    values: &Bound<'_, PyAny>,
    times: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = named)] operator: Operator,
    #[pyo3(from_py_with = named_or_none)] elements: Option<Elements>,
    options: &Bound<'_, PyDict>,
) -> Result<Job, Failure> {
    let (values, is_flat) = arrays::channels("values", values)?;
    let times = arrays::list("times", times)?;
    let mut stepping = stepping(options)?;
    let takes_exact = match options.contains("scheme")? {
        true => stepping.scheme == Scheme::Exact,
        false => operator == Operator::TotalVariation,
    };
    let elements = elements.unwrap_or_else(|| match takes_exact {
        true => Elements::suiting(values.view()),
        false => Elements::Vertices,
    });
    if elements == Elements::Edges && takes_exact {
        stepping.scheme = Scheme::Exact;
    }
    let mesh = Arc::clone(&mesh.inner);
    let work = move |stage: Stage| {
        let flow = flow_with(&mesh, values, &times, operator, elements, stepping, stage)?;
        Ok((flow, operators::invertible_masses(mesh.vertex_areas())))
    };
    Job::start(work, move |py, (trajectory, masses)| {
        let layout = Layout {
            places: vec![trajectory.vertex_count()],
            has_channels: !is_flat,
        };
        let flow = Flow::new(SpectralTransform::new(trajectory), masses, layout);
        Ok(flow.into_bound_py_any(py)?)
    })
}

/// The elements that `flow` takes for a function by default, if its steps are exact: "edges" if every
/// channel has one or two values, and not all of them one, on up to 250 000 vertices; else "vertices".
///
/// Parameters
/// ----------
/// values : (V,) or (V, C) array
///
/// Returns
/// -------
/// str
///
/// Raises
/// ------
/// MeshError
///     If the values are of another shape.
#[pyfunction]
pub fn suiting_elements(values: &Bound<'_, PyAny>) -> Result<&'static str, Failure> {
    let (values, _) = arrays::channels("values", values)?;
    Ok(Elements::suiting(values.view()).name())
}

#[pyfunction]
pub fn start_conformal_flow(
    mesh: &Mesh,
    #[pyo3(from_py_with = parameters::time)] time: f64,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
    #[pyo3(from_py_with = named)] solver: Solver,
) -> Result<Job, Failure> {
    let mesh = Arc::clone(&mesh.inner);
    let work = move |stage: Stage| {
        let operators = Discretization::new_with(&mesh, stage)?;
        conformal_mean_curvature_flow_with(&mesh, &operators, time, steps, solver, stage)
    };
    Job::start(work, |py, shape| {
        Ok(arrays::per_vertex(py, shape.view())?.into_any())
    })
}

/// Total variation of a function on the mesh: Σ_f A_f |∇u|_f, over all channels together
/// (NETV, Brokman et al. 2024, Eq. 13).
///
/// Parameters
/// ----------
/// mesh : Mesh
/// values : (V,) or (V, C) array
///
/// Returns
/// -------
/// float
///     In the unit of the values × length.
///
/// Raises
/// ------
/// MeshError
///     If the values do not have a row per vertex or are not finite.
#[pyfunction]
pub fn total_variation(
    py: Python<'_>,
    mesh: &Mesh,
    values: &Bound<'_, PyAny>,
) -> Result<f64, Failure> {
    let (values, _) = arrays::channels("values", values)?;
    let mesh = &mesh.inner;
    guarded(py, |stage| {
        let operators = Discretization::new_with(mesh, stage)?;
        operators.check_values(values.view())?;
        Ok(operators::total_variation(
            operators.gradient(),
            values.view(),
        ))
    })
}
