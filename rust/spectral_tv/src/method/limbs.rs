//! A smooth base that keeps limbs.

use ndarray::Array2;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::{Stepping, TotalVariation};
use crate::mesh::TriangleMesh;
use crate::method::{Method, graded_times};
use crate::monitor::Stage;
use crate::operators::positions;
use crate::solver::Solver;
use crate::spectral::ThicknessCut;

/// Steps of the flow.
pub(super) const STEPS: usize = 16;
/// How soft its edges are.
const SOFT_EDGES: f64 = 0.3;
/// How much of limbs stays.
const KEEP_LIMBS: f64 = 1.0;
/// Share of the progress that is given to the flow.
const FLOW_SHARE: f64 = 0.8;

/// What M1 with soft edges leaves of the shape of `mesh` after a time, length², but for limbs, which stay
/// as thick as they are, (3, V).
///
/// # Errors
/// As a flow, and as [`thickness_with`].
pub(super) fn keeping_limbs(
    mesh: &TriangleMesh,
    operators: &Discretization,
    duration: f64,
    solver: Solver,
    stage: Stage,
) -> Result<Array2<f64>> {
    let shape = positions(mesh);
    let law = TotalVariation::with_soft_edges(SOFT_EDGES);
    let law = law.starting_at(operators, shape.view())?;
    let (finest, largest) = Method::ShapeTv.facts().scales;
    let times = graded_times(duration * (finest / largest), duration, STEPS)?;
    let stepping = Stepping {
        solver,
        ..Stepping::default()
    };
    let share = stage.stage(0.0, FLOW_SHARE);
    let trajectory = stepping.run_with(operators, &law, shape.clone(), &times, share)?;
    let cut = ThicknessCut::new(mesh, KEEP_LIMBS, stage.stage(FLOW_SHARE, 1.0))?;
    Ok(match cut {
        None => shape,
        Some(cut) => shape - cut.before(&trajectory, duration),
    })
}
