//! The class `Flow` and the functions that run one flow.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use spectral_tv::Error;
use spectral_tv::flow::{Heat, Law, TotalVariation, Trajectory, conformal_mean_curvature_flow};
use spectral_tv::method::run_flow;
use spectral_tv::operators::{self, Discretization};

use crate::arrays;
use crate::error::Failure;
use crate::job::Task;
use crate::mesh::Mesh;
use crate::settings::{scheme as parse_scheme, solver as parse_solver};

/// A flow sampled at N + 1 times, made by `flow` or found in `Decomposition.flow`.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Flow {
    trajectory: Trajectory,
    /// Whether the values came as (V,) and go back as such.
    is_flat: bool,
}

impl Flow {
    pub fn new(trajectory: Trajectory, is_flat: bool) -> Self {
        Self {
            trajectory,
            is_flat,
        }
    }
}

#[pymethods]
impl Flow {
    /// t₀ = 0 < t₁ < … < t_N, (N+1,), length² for shapes.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.trajectory.times.clone().into_pyarray(py)
    }

    /// u(t_k), (N+1, V, C); (N+1, V) if the values were given as (V,).
    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let states = &self.trajectory.states;
        let (nodes, channels, vertices) = states.dim();
        let array = arrays::stacked(py, nodes, vertices, channels, |k, v, c| states[[k, c, v]]);
        Ok(match self.is_flat {
            true => array.reshape([nodes, vertices])?.into_any(),
            false => array.into_any(),
        })
    }

    /// TV(u(t_k)), (N+1,), unit of the values × length.
    #[getter]
    fn total_variation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.trajectory.total_variation.clone().into_pyarray(py)
    }

    /// Duality gap of each step as a proximal step of TV, relative to Δt TV at its start, (N,);
    /// 0 for linear flows, and once nothing is left to decay.
    #[getter]
    fn gap<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.trajectory.gaps.clone().into_pyarray(py)
    }

    fn __repr__(&self) -> String {
        let (nodes, channels, vertices) = self.trajectory.states.dim();
        format!(
            "Flow({} steps, {vertices} vertices, {channels} channels)",
            nodes - 1
        )
    }
}

/// Flow a function on the mesh, in the metric of the mesh.
///
/// Parameters
/// ----------
/// mesh : Mesh
/// values : (V,) or (V, C) array
///     The function f; the C channels of a TV flow are coupled.
/// times : (N+1,) array
///     Increasing, from 0. In the unit (of the values) × length for "tv", length² for "heat";
///     both are length² where the values are lengths.
/// operator : {"tv", "heat"}
///     "tv" is u_t ∈ −∂NETV(u) (Brokman et al. 2024, Eq. 20), "heat" u_t = Δu (Eq. 12).
/// exact : bool
///     Every step a proximal step to the gap `tolerance`: eigenfunctions then decay in a
///     straight line down to extinction.
/// progress : callable, optional
///     Called with the fraction done; an exception it raises ends the work.
/// scheme : {"extrapolated", "lagged"}
///     How steps that are not exact take their weights: at the extrapolated state with BDF2,
///     or at the last one with backward Euler (the paper's step).
/// tolerance : float
///     Relative duality gap of exact steps, in (0, 1).
/// solver : {"auto", "cholesky", "multigrid"}
///     How the linear systems of steps are solved; see `decompose`.
///
/// Returns
/// -------
/// Flow
///
/// Raises
/// ------
/// MeshError
///     If an argument is of the wrong shape, not finite, or out of range; says where.
#[pyfunction]
#[pyo3(signature = (mesh, values, times, operator = "tv", exact = false, progress = None, *,
                    scheme = "extrapolated", tolerance = 1e-3, solver = "auto"))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn flow(
    py: Python<'_>,
    mesh: &Mesh,
    values: &Bound<'_, PyAny>,
    times: &Bound<'_, PyAny>,
    operator: &str,
    exact: bool,
    progress: Option<&Bound<'_, PyAny>>,
    scheme: &str,
    tolerance: f64,
    solver: &str,
) -> Result<Flow, Failure> {
    let (values, is_flat) = arrays::channels("values", values)?;
    let times = arrays::list("times", times)?;
    let scheme = parse_scheme(if exact { "exact" } else { scheme }, tolerance)?;
    let solver = parse_solver(solver)?;
    let is_tv = match operator {
        "tv" => true,
        "heat" => false,
        other => {
            let message = format!("operator must be \"tv\" or \"heat\", not {other:?}");
            return Err(Error::Argument(message).into());
        }
    };
    let mesh = Arc::clone(&mesh.inner);
    let task = Task::start(move |monitor| {
        let operators = Discretization::new(&mesh);
        let law: Box<dyn Law> = match is_tv {
            true => Box::new(TotalVariation::starting_at(&operators, values.view())?),
            false => Box::new(Heat),
        };
        let stage = monitor.whole();
        run_flow(&operators, &*law, scheme, &values, &times, solver, stage)
    })?;
    Ok(Flow::new(task.wait(py, progress)?, is_flat))
}

/// Conformalized mean curvature flow (Kazhdan, Solomon and Ben-Chen 2012), neither rescaled nor
/// recentred: the smooth base that M3 uses.
///
/// Parameters
/// ----------
/// mesh : Mesh
/// time : float
///     How far to flow, length²; 5e-3 of the area swallows limbs.
/// steps : int
///     Number of equal steps.
/// progress : callable, optional
///     Called with the fraction done.
/// solver : {"auto", "cholesky", "multigrid"}
///     How the linear systems are solved; see `decompose`.
///
/// Returns
/// -------
/// (V, 3) array
///     The smoothed positions.
///
/// Raises
/// ------
/// MeshError
///     If time or steps are not positive.
#[pyfunction]
#[pyo3(signature = (mesh, time, steps = 10, progress = None, *, solver = "auto"))]
pub fn conformal_flow<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    time: f64,
    steps: usize,
    progress: Option<&Bound<'py, PyAny>>,
    solver: &str,
) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
    let solver = parse_solver(solver)?;
    let mesh = Arc::clone(&mesh.inner);
    let task = Task::start(move |monitor| {
        let operators = Discretization::new(&mesh);
        let stage = monitor.whole();
        conformal_mean_curvature_flow(&mesh, &operators, time, steps, solver, stage)
    })?;
    Ok(arrays::per_vertex(py, &task.wait(py, progress)?))
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
pub fn total_variation(mesh: &Mesh, values: &Bound<'_, PyAny>) -> Result<f64, Failure> {
    let (values, _) = arrays::channels("values", values)?;
    let operators = Discretization::new(&mesh.inner);
    operators.check_values(values.view())?;
    Ok(operators::total_variation(
        operators.gradient(),
        values.view(),
    ))
}
