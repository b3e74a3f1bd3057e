//! From a mesh and a method to a decomposition.

use ndarray::{Array1, Array2};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::{Eigenpairs, Law, Trajectory, check_times, without};
use crate::mesh::TriangleMesh;
use crate::method::adaptive_steps::{FEWEST_STEPS, adapted, subdivided};
use crate::method::facts::Work;
use crate::method::representation::{Flowed, Representation};
use crate::method::requirements::check_memory;
use crate::method::{Decomposition, Displacement, Settings};
use crate::monitor::{Monitor, Stage};
use crate::operators::positions;
use crate::spectral::SpectralTransform;

/// Share of M3's progress that is given to its base.
const BASE_SHARE: f64 = 0.25;
/// Share of the progress of filtering by eigenpairs that is given to finding them.
const EIGENPAIRS_SHARE: f64 = 0.95;
/// Share of all methods' progress that is given to the flow; the rest is the spectrum's.
const FLOW_SHARE: f64 = 0.99;

/// Decomposes the shape of `mesh` into scales.
///
/// # Errors
/// If a setting makes no sense, or a system cannot be solved; [`crate::Error::Memory`] at once if the
/// work does not fit into what is available.
pub fn decompose(mesh: &TriangleMesh, settings: &Settings) -> Result<Decomposition> {
    decompose_with(mesh, settings, Monitor::new().whole())
}

/// [`decompose`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`decompose`], or [`crate::Error::Cancelled`].
pub fn decompose_with(
    mesh: &TriangleMesh,
    settings: &Settings,
    stage: Stage,
) -> Result<Decomposition> {
    settings.check()?;
    let (stage, rest) = (stage.stage(0.0, FLOW_SHARE), stage.stage(FLOW_SHARE, 1.0));
    stage.report(0.0)?;
    check_memory(mesh, settings, stage)?;
    let work = settings.method.facts().work;
    let operators = match work {
        Work::Flow { .. } | Work::Base => Discretization::for_flows(mesh, stage)?,
        Work::Eigenpairs => Discretization::new_with(mesh, stage)?,
    };
    let mut base = None;
    let (trajectory, displacement) = match work {
        Work::Flow { .. } => by_steps(mesh, &operators, settings, stage, &mut base)?,
        Work::Eigenpairs => (by_eigenpairs(mesh, &operators, settings, stage)?, None),
        Work::Base => (by_base(mesh, &operators, settings, stage)?, None),
    };
    let transform = SpectralTransform::new(trajectory);
    let areas = base.as_ref().unwrap_or(mesh).vertex_areas();
    Decomposition::new(transform, displacement, areas, mesh, rest)
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
    let takes_base = settings.method.facts().takes_base;
    let share = if takes_base { BASE_SHARE } else { 0.0 };
    let Representation {
        mut flows,
        displacement,
        along,
    } = Representation::new(mesh, operators, settings, stage.stage(0.0, share))?;
    let used = along.as_ref().map_or(operators, |(_, operators)| operators);
    let times = |steps: usize| settings.default_times(mesh.area(), steps);
    let rest = stage.stage(share, 1.0);
    let trajectory = if let Some(accuracy) = settings.accuracy {
        let masses = used.vertex_masses();
        let masses = &*masses;
        let flow = |times: &[f64], stage: Stage| {
            let again = flows
                .iter()
                .map(|Flowed { law, values }| (&**law, values.clone()));
            run_flows(used, again, settings, times, stage)
        };
        match &settings.times {
            Some(given) => {
                check_times(given)?;
                let fewest = given.len() - 1;
                let times = |steps: usize| Ok(subdivided(given, steps));
                adapted(masses, accuracy, fewest, times, flow, rest)?
            }
            None => adapted(masses, accuracy, FEWEST_STEPS, times, flow, rest)?,
        }
    } else {
        let times = match &settings.times {
            Some(times) => times.clone(),
            None => times(settings.steps)?,
        };
        // Flowed once, so nobody keeps their values.
        let once = flows
            .iter_mut()
            .map(|Flowed { law, values }| (&**law, std::mem::take(values)));
        run_flows(used, once, settings, &times, rest)?
    };
    *base = along.map(|(mesh, _)| mesh);
    Ok((trajectory, displacement))
}

/// Runs functions one after the other, the result as the flow of one function with all channels.
pub(super) fn run_flows<'a>(
    operators: &Discretization,
    flows: impl ExactSizeIterator<Item = (&'a dyn Law, Array2<f64>)>,
    settings: &Settings,
    times: &[f64],
    stage: Stage,
) -> Result<Trajectory> {
    let count = flows.len();
    let run = |(index, (law, values))| {
        let stage = stage.part(index, count);
        settings
            .stepping
            .run_with(operators, law, values, times, stage)
    };
    let trajectories: Vec<_> = flows.enumerate().map(run).collect::<Result<_>>()?;
    Ok(Trajectory::side_by_side(trajectories))
}

/// The flow of the positions by eigenpairs.
fn by_eigenpairs(
    mesh: &TriangleMesh,
    operators: &Discretization,
    settings: &Settings,
    stage: Stage,
) -> Result<Trajectory> {
    let count = settings.eigenpairs.min(mesh.vertex_count());
    let pairs =
        Eigenpairs::lowest_with(mesh, operators, count, stage.stage(0.0, EIGENPAIRS_SHARE))?;
    let times = match &settings.times {
        Some(times) => times.clone(),
        None => {
            let (_, largest) = settings.relative_scales();
            pairs.times(largest * mesh.area(), settings.fewest_steps())?
        }
    };
    let stage = stage.stage(EIGENPAIRS_SHARE, 1.0);
    pairs.flow_with(operators, positions(mesh), &times, stage)
}

/// The displacement from a base as the only component, at the time that the base was smoothed
/// for: the shape in one step, and then at rest.
fn by_base(
    mesh: &TriangleMesh,
    operators: &Discretization,
    settings: &Settings,
    stage: Stage,
) -> Result<Trajectory> {
    let time = settings.base_duration(mesh.area());
    let solver = settings.stepping.solver;
    let shape = settings.base.shape(mesh, operators, time, solver, stage)?;
    let times = [0.0, time, 2.0 * time];
    let initial = positions(mesh);
    let state = |_, origin: &Array1<f64>| without(shape.clone(), origin);
    let flow = Trajectory::sampled_with(operators, &times, initial, state, stage)?;
    Ok(flow.piecewise_linear())
}
