//! From a mesh and a method to a decomposition.

use ndarray::{Array2, Array3, Axis};

use crate::error::{Error, Result};
use crate::flow::{
    ConformalLaplace, Heat, Law, TotalVariation, Trajectory, Weights, proximal_flow,
    semi_implicit_flow,
};
use crate::mesh::TriangleMesh;
use crate::method::{Decomposition, Displacement, Method, default_times};
use crate::monitor::Stage;
use crate::operators::{Discretization, positions};
use crate::solver::Solver;
use crate::spectral::SpectralTransform;

/// Share of M3's progress that is given to its base.
const BASE_SHARE: f64 = 0.25;

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

/// What to decompose by.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The method.
    pub method: Method,
    /// N + 1 times from 0, length²; `None`: [`default_times`].
    pub times: Option<Vec<f64>>,
    /// Number of steps N, where no times are given.
    pub steps: usize,
    /// How steps are taken.
    pub scheme: Scheme,
    /// How linear systems are solved.
    pub solver: Solver,
}

/// Decomposes the shape of `mesh` into scales.
///
/// # Errors
/// If a setting makes no sense, a system cannot be solved, or the monitor was cancelled.
pub fn decompose(mesh: &TriangleMesh, settings: &Settings, stage: Stage) -> Result<Decomposition> {
    let times = match &settings.times {
        Some(times) => times.clone(),
        None => default_times(&settings.method, mesh.area(), settings.steps)?,
    };
    let operators = Discretization::new(mesh);
    stage.report(0.0)?;
    let run = |law: &dyn Law, values: &Array2<f64>, stage: Stage| {
        let (scheme, solver) = (settings.scheme, settings.solver);
        run_flow(&operators, law, scheme, values, &times, solver, stage)
    };
    let tv = |values: &Array2<f64>, stage: Stage| {
        run(
            &TotalVariation::starting_at(&operators, values.view())?,
            values,
            stage,
        )
    };
    let shape = positions(mesh);
    let mut displacement = None;
    let trajectory = match &settings.method {
        Method::Heat => run(&Heat, &shape, stage)?,
        Method::Naive => {
            let channel = |axis: usize| shape.row(axis).insert_axis(Axis(0)).to_owned();
            let share = |axis: usize| stage.stage(axis as f64 / 3.0, (axis + 1) as f64 / 3.0);
            let flow = |axis| tv(&channel(axis), share(axis));
            side_by_side([flow(0)?, flow(1)?, flow(2)?])
        }
        Method::ShapeTv => tv(&shape, stage)?,
        Method::ConformalLaplace { p } => {
            run(&ConformalLaplace::new(mesh, &operators, *p)?, &shape, stage)?
        }
        Method::DirectionalTv { base } => {
            let (solver, base_stage) = (settings.solver, stage.stage(0.0, BASE_SHARE));
            let base = base.shape(mesh, &operators, solver, base_stage)?;
            let representation = Displacement::between(mesh, &operators, base, solver, stage)?;
            let trajectory = tv(&representation.distance, stage.stage(BASE_SHARE, 1.0))?;
            displacement = Some(representation);
            trajectory
        }
    };
    let transform = SpectralTransform::new(trajectory);
    Ok(Decomposition::new(
        transform,
        displacement,
        mesh.vertex_areas(),
    ))
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
    values: &Array2<f64>,
    times: &[f64],
    solver: Solver,
    stage: Stage,
) -> Result<Trajectory> {
    match scheme {
        Scheme::SemiImplicit(weights) => {
            semi_implicit_flow(operators, law, weights, values, times, solver, stage)
        }
        Scheme::Exact { tolerance } if law.is_total_variation() => {
            proximal_flow(operators, tolerance, values, times, stage)
        }
        Scheme::Exact { .. } => Err(Error::Argument(
            "exact steps exist for total-variation flows only (naive, m1, m3)".into(),
        )),
    }
}

/// Three flows of one channel each as one of three.
fn side_by_side(flows: [Trajectory; 3]) -> Trajectory {
    let (nodes, _, vertices) = flows[0].states.dim();
    let mut states = Array3::zeros((nodes, 3, vertices));
    for (axis, flow) in flows.iter().enumerate() {
        states
            .index_axis_mut(Axis(1), axis)
            .assign(&flow.states.index_axis(Axis(1), 0));
    }
    let over = |values: fn(&Trajectory) -> &Vec<f64>, merge: fn(f64, f64) -> f64| {
        (0..values(&flows[0]).len())
            .map(|k| flows.iter().map(|flow| values(flow)[k]).fold(0.0, merge))
            .collect()
    };
    Trajectory {
        times: flows[0].times.clone(),
        total_variation: over(|flow| &flow.total_variation, |sum, tv| sum + tv),
        gaps: over(|flow| &flow.gaps, f64::max),
        states,
    }
}
