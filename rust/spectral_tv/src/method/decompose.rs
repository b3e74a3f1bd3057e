//! From a mesh and a method to a decomposition.

use ndarray::Array2;

use crate::discretization::Discretization;
use crate::error::{ArgumentError, Error, Result};
use crate::flow::{
    Eigenpairs, Law, Trajectory, Weights, check_times, proximal_flow, semi_implicit_flow, without,
};
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::method::adaptive_steps::{FEWEST_STEPS, adapted, subdivided};
use crate::method::representation::{Flowed, Representation};
use crate::method::requirements::check_memory;
use crate::method::{Base, Decomposition, Displacement, Method, default_times, relative_scales};
use crate::monitor::Stage;
use crate::operators::positions;
use crate::solver::{Demand, Solver};
use crate::spectral::SpectralTransform;

/// Share of M3's progress that is given to its base.
const BASE_SHARE: f64 = 0.25;
/// Share of the progress of filtering by eigenpairs that is given to finding them.
const EIGENPAIRS_SHARE: f64 = 0.95;
/// Share of all methods' progress that is given to the flow; the rest is the spectrum's.
const FLOW_SHARE: f64 = 0.99;

/// How the weights of a step are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scheme {
    /// One solve a step, the weights at a known state.
    SemiImplicit(Weights),
    /// Every step a proximal step, to this duality gap relative to Δt TV. For TV flows only.
    Exact {
        /// The relative gap, in (0, 1).
        tolerance: f64,
    },
}

impl Scheme {
    /// What a flow of so many channels takes each matrix for; `None` where it makes its own.
    pub(super) fn demand(self, channels: usize) -> Option<Demand> {
        match self {
            Self::SemiImplicit(weights) => Some(weights.demand(channels)),
            Self::Exact { .. } => None,
        }
    }

    /// Whether systems of a flow of so many channels are surely solved by iteration.
    pub(crate) fn is_iterated(self, solver: Solver, vertices: usize, channels: usize) -> bool {
        let demand = self.demand(channels);
        demand.is_some_and(|demand| solver.is_iterative(vertices, demand))
    }
}

/// How many steps are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Steps {
    /// N, where no times are given.
    Count(usize),
    /// As many as the mean error of five even bands, relative to the bands, takes; given times
    /// are cut into more.
    Accuracy(f64),
}

impl Steps {
    /// Their number, or the fewest.
    fn fewest(self) -> usize {
        match self {
            Self::Count(count) => count,
            Self::Accuracy(_) => FEWEST_STEPS,
        }
    }
}

/// What to decompose by.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The method.
    pub method: Method,
    /// N + 1 times from 0, length²; `None`: [`default_times`], or [`Eigenpairs::times`].
    pub times: Option<Vec<f64>>,
    /// How many steps there are.
    pub steps: Steps,
    /// How steps are taken.
    pub scheme: Scheme,
    /// How linear systems are solved.
    pub solver: Solver,
}

/// Decomposes the shape of `mesh` into scales.
///
/// # Errors
/// If a setting makes no sense, a system cannot be solved, or the monitor was cancelled;
/// [`Error::Memory`] at once if the work does not fit into what is available.
pub fn decompose(mesh: &TriangleMesh, settings: &Settings, stage: Stage) -> Result<Decomposition> {
    let has_steps = !matches!(
        settings.method,
        Method::LaplaceBeltrami { .. } | Method::Displacement { .. }
    );
    if matches!(settings.scheme, Scheme::Exact { .. }) && !has_steps {
        return Err(no_exact_steps());
    }
    if matches!(settings.steps, Steps::Accuracy(_)) && !has_steps {
        let message =
            "accuracy is for methods that take time steps, not \"lb\" or \"displacement\"";
        return Err(ArgumentError::inapplicable("accuracy", message).into());
    }
    let (stage, rest) = (stage.stage(0.0, FLOW_SHARE), stage.stage(FLOW_SHARE, 1.0));
    stage.report(0.0)?;
    check_memory(mesh, settings, stage)?;
    let operators = Discretization::new(mesh, stage)?;
    let mut base = None;
    let (trajectory, displacement) = match &settings.method {
        Method::LaplaceBeltrami { eigenpairs } => (
            by_eigenpairs(mesh, &operators, *eigenpairs, settings, stage)?,
            None,
        ),
        Method::Displacement { base } => (by_base(mesh, &operators, base, settings, stage)?, None),
        _ => by_steps(mesh, &operators, settings, stage, &mut base)?,
    };
    let transform = SpectralTransform::new(trajectory);
    let areas = base.as_ref().unwrap_or(mesh).vertex_areas();
    Decomposition::new(transform, displacement, areas, rest)
}

/// The flow of a method that takes time steps, and M3's representation; `base` becomes that along
/// which M3 flows, if it does.
fn by_steps(
    mesh: &TriangleMesh,
    operators: &Discretization,
    settings: &Settings,
    stage: Stage,
    base: &mut Option<TriangleMesh>,
) -> Result<(Trajectory, Option<Displacement>)> {
    let share = match settings.method {
        Method::DirectionalTv { .. } => BASE_SHARE,
        _ => 0.0,
    };
    let Representation {
        flows,
        displacement,
        along,
    } = Representation::new(mesh, operators, settings, stage.stage(0.0, share))?;
    let used = along.as_ref().map_or(operators, |(_, operators)| operators);
    let flow = |times: &[f64], stage: Stage| run_flows(used, &flows, settings, times, stage);
    let times = |steps: usize| default_times(&settings.method, mesh.area(), steps);
    let rest = stage.stage(share, 1.0);
    let trajectory = match (settings.steps, &settings.times) {
        (Steps::Count(_), Some(times)) => flow(times, rest)?,
        (Steps::Count(count), None) => flow(&times(count)?, rest)?,
        (Steps::Accuracy(accuracy), Some(given)) => {
            check_times(given)?;
            let fewest = given.len() - 1;
            let times = |steps: usize| Ok(subdivided(given, steps));
            adapted(used, accuracy, fewest, times, flow, rest)?
        }
        (Steps::Accuracy(accuracy), None) => {
            adapted(used, accuracy, FEWEST_STEPS, times, flow, rest)?
        }
    };
    *base = along.map(|(mesh, _)| mesh);
    Ok((trajectory, displacement))
}

/// Runs functions one after the other, the result as the flow of one function with all channels.
pub(super) fn run_flows(
    operators: &Discretization,
    flows: &[Flowed],
    settings: &Settings,
    times: &[f64],
    stage: Stage,
) -> Result<Trajectory> {
    let count = flows.len() as f64;
    let run = |(index, Flowed { law, values }): (usize, &Flowed)| {
        let stage = stage.stage(index as f64 / count, (index + 1) as f64 / count);
        let (scheme, solver) = (settings.scheme, settings.solver);
        let values = values.clone();
        run_flow(operators, &**law, scheme, values, times, solver, stage)
    };
    let trajectories: Vec<_> = flows.iter().enumerate().map(run).collect::<Result<_>>()?;
    Ok(Trajectory::side_by_side(trajectories))
}

/// The flow of the positions by eigenpairs.
fn by_eigenpairs(
    mesh: &TriangleMesh,
    operators: &Discretization,
    count: usize,
    settings: &Settings,
    stage: Stage,
) -> Result<Trajectory> {
    let count = count.min(mesh.vertex_count());
    let pairs = Eigenpairs::lowest(mesh, operators, count, stage.stage(0.0, EIGENPAIRS_SHARE))?;
    let times = match &settings.times {
        Some(times) => times.clone(),
        None => {
            let (_, largest) = relative_scales(&settings.method);
            pairs.times(largest * mesh.area(), settings.steps.fewest())?
        }
    };
    let stage = stage.stage(EIGENPAIRS_SHARE, 1.0);
    pairs.flow(operators, positions(mesh), &times, stage)
}

/// The displacement from a base as the only component, at the time that the base was smoothed
/// for: the shape in one step, and then at rest.
fn by_base(
    mesh: &TriangleMesh,
    operators: &Discretization,
    base: &Base,
    settings: &Settings,
    stage: Stage,
) -> Result<Trajectory> {
    if settings.times.is_some() {
        let message = "times are not for the method \"displacement\", which has one band";
        return Err(ArgumentError::inapplicable("times", message).into());
    }
    let shape = base.shape(mesh, operators, settings.solver, stage)?;
    let time = base.duration(mesh.area());
    let times = [0.0, time, 2.0 * time];
    let initial = positions(mesh);
    Trajectory::sampled(operators, &times, initial, stage, |_, origin| {
        without(shape.clone(), origin)
    })
}

/// Runs `law` from `values` (C, V) through `times` by `scheme`, the systems of semi-implicit
/// steps solved by `solver`.
///
/// # Errors
/// As the flows themselves, or if the exact scheme is asked for where no step minimises TV.
pub fn run_flow(
    operators: &Discretization,
    law: &dyn Law,
    scheme: Scheme,
    values: Array2<f64>,
    times: &[f64],
    solver: Solver,
    stage: Stage,
) -> Result<Trajectory> {
    let size = needs::Size::new(
        operators.masses().len(),
        operators.gradient().triangles().len(),
    );
    require_flow(size, scheme, values.dim(), times, solver, stage)?;
    match scheme {
        Scheme::SemiImplicit(weights) => {
            semi_implicit_flow(operators, law, weights, values, times, solver, stage)
        }
        Scheme::Exact { tolerance } if law.is_total_variation() => {
            proximal_flow(operators, tolerance, values, times, stage)
        }
        Scheme::Exact { .. } => Err(no_exact_steps()),
    }
}

/// Has a flow of values (C, V) by [`run_flow`] granted its memory.
///
/// # Errors
/// [`Error::Memory`].
pub fn require_flow(
    size: needs::Size,
    scheme: Scheme,
    (channels, vertices): (usize, usize),
    times: &[f64],
    solver: Solver,
    stage: Stage,
) -> Result<()> {
    let steps = times.len().saturating_sub(1);
    let is_iterated = scheme.is_iterated(solver, vertices, channels);
    stage.require(
        needs::flow(size, channels, steps, is_iterated),
        &format!("a flow of {steps} steps on {vertices} vertices"),
        "take fewer steps or vertices",
    )
}

fn no_exact_steps() -> Error {
    let reason = "exact steps exist for total-variation flows only (naive, m1, m3)";
    ArgumentError::inapplicable("scheme", reason).into()
}
