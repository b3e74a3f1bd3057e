//! The functions that run one flow, and measure total variation.

use std::sync::Arc;

use numpy::PyArray2;
use pyo3::prelude::*;
use spectral_tv::discretization::Discretization;
use spectral_tv::flow::{Heat, Law, TotalVariation, conformal_mean_curvature_flow};
use spectral_tv::memory::needs;
use spectral_tv::method::{require_flow, run_flow};
use spectral_tv::operators;
use spectral_tv::spectral::SpectralTransform;

use crate::arrays;
use crate::error::{Failure, refused};
use crate::flow::{Flow, Layout};
use crate::job::{Convert, Job, Task, guarded};
use crate::mesh::Mesh;
use crate::parameters;
use crate::settings::{scheme as parse_scheme, solver as parse_solver};

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
/// MemoryError
///     If the work takes more than is available, before it starts.
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
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    solver: &str,
) -> Result<Flow, Failure> {
    let request = FlowRequest {
        values,
        times,
        operator,
        scheme: if exact { "exact" } else { scheme },
        tolerance,
        solver,
    };
    start(mesh, &request, |flow| flow)?.wait(py, progress)
}

/// Start `flow` in a thread of its own and return the `Job` at once.
///
/// Takes the arguments of `flow`, without `progress`; `Job.result` gives the `Flow`.
///
/// Raises
/// ------
/// MeshError
///     If an argument cannot be read; what only the work finds out, `Job.result` raises.
#[pyfunction]
#[pyo3(signature = (mesh, values, times, operator = "tv", exact = false, *,
                    scheme = "extrapolated", tolerance = 1e-3, solver = "auto"))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn start_flow(
    mesh: &Mesh,
    values: &Bound<'_, PyAny>,
    times: &Bound<'_, PyAny>,
    operator: &str,
    exact: bool,
    scheme: &str,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    solver: &str,
) -> Result<Job, Failure> {
    let request = FlowRequest {
        values,
        times,
        operator,
        scheme: if exact { "exact" } else { scheme },
        tolerance,
        solver,
    };
    let task = start(mesh, &request, |flow| -> Convert {
        Box::new(move |py| Ok(Py::new(py, flow)?.into_any()))
    })?;
    Ok(Job::new(task))
}

/// The arguments of `flow` and `start_flow`.
struct FlowRequest<'a, 'py> {
    values: &'a Bound<'py, PyAny>,
    times: &'a Bound<'py, PyAny>,
    operator: &'a str,
    scheme: &'a str,
    tolerance: f64,
    solver: &'a str,
}

/// Starts the work in a thread; `wrap` makes of its result what the thread hands over.
fn start<T: Send + 'static>(
    mesh: &Mesh,
    request: &FlowRequest,
    wrap: impl FnOnce(Flow) -> T + Send + 'static,
) -> Result<Task<T>, Failure> {
    let (values, is_flat) = arrays::channels("values", request.values)?;
    let times = arrays::list("times", request.times)?;
    let scheme = parse_scheme(request.scheme, request.tolerance)?;
    let solver = parse_solver(request.solver)?;
    let is_tv = match request.operator {
        "tv" => true,
        "heat" => false,
        other => {
            let message = format!("operator must be \"tv\" or \"heat\", not {other:?}");
            return Err(refused(message));
        }
    };
    let mesh = Arc::clone(&mesh.inner);
    Task::start(move |monitor| {
        let stage = monitor.whole();
        let size = needs::Size::of(&mesh);
        require_flow(size, scheme, values.dim(), &times, solver, stage)?;
        let operators = Discretization::new(&mesh, stage)?;
        let law: Box<dyn Law> = match is_tv {
            true => Box::new(TotalVariation::starting_at(&operators, values.view())?),
            false => Box::new(Heat),
        };
        let trajectory = run_flow(&operators, &*law, scheme, values, &times, solver, stage)?;
        let layout = Layout {
            places: vec![trajectory.vertex_count()],
            has_channels: !is_flat,
        };
        let transform = SpectralTransform::new(trajectory);
        Ok(wrap(Flow::new(
            transform,
            operators.masses().to_vec(),
            layout,
        )))
    })
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
    #[pyo3(from_py_with = parameters::time)] time: f64,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
    progress: Option<&Bound<'py, PyAny>>,
    solver: &str,
) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
    let solver = parse_solver(solver)?;
    let mesh = Arc::clone(&mesh.inner);
    let task = Task::start(move |monitor| {
        let stage = monitor.whole();
        let operators = Discretization::new(&mesh, stage)?;
        conformal_mean_curvature_flow(&mesh, &operators, time, steps, solver, stage)
    })?;
    arrays::per_vertex(py, task.wait(py, progress)?.view())
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
        let operators = Discretization::new(mesh, stage)?;
        operators.check_values(values.view())?;
        Ok(operators::total_variation(
            operators.gradient(),
            values.view(),
        ))
    })
}
