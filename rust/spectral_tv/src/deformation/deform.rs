//! One deformation, by the chosen algorithm.

use ndarray::Array2;

use crate::deformation::algorithm::Algorithm;
use crate::deformation::constraints::Constraints;
use crate::deformation::deformer::{Deformer, require};
use crate::deformation::outcome::{Deformation, carried};
use crate::deformation::problem::{Problem, Task};
use crate::discretization::Discretization;
use crate::error::{ArgumentError, Result};
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::minimization::{PrimalDualNewton, Variation, check_tolerance};
use crate::monitor::{Monitor, Stage};
use crate::operators::total_variation;

/// ε of the dual field that certifies a displacement, relative to its mean gradient.
const CERTIFICATE_SMOOTHING: f64 = 1e-3;

/// How to deform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The algorithm.
    pub algorithm: Algorithm,
    /// Width of the stretched zone, a length; for the convex algorithm only.
    pub softness: f64,
    /// Relative duality gap of the convex algorithm; for the iterative others, the movement of a
    /// vertex at which they end, relative to the spread of the displacements asked for.
    pub tolerance: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            algorithm: Algorithm::default(),
            softness: 0.0,
            tolerance: 1e-3,
        }
    }
}

/// Takes the constrained vertices of `mesh` to `targets` (K positions).
///
/// ```
/// use spectral_tv::deformation::{Constraints, Settings, deform};
///
/// # use spectral_tv::mesh::TriangleMesh;
/// # let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
/// # let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// # let mesh = TriangleMesh::new(vertices, &triangles)?;
/// // Vertices 0 and 1 stay, vertex 3 moves up; vertex 2 follows.
/// let targets = [[0., 0., 0.], [1., 0., 0.], [0.3, 0.3, 2.]];
/// let constraints = Constraints::new(&mesh, &[0, 1, 3], None)?;
/// let found = deform(&mesh, constraints, &targets, Settings::default())?;
/// assert!((found.displacement[[2, 3]] - 1.0).abs() < 1e-9);
/// assert!(found.gap < 1e-3);
/// # Ok::<(), spectral_tv::Error>(())
/// ```
///
/// # Errors
/// If the targets do not fit the constraints (their number; finite; no two for one vertex), the
/// tolerance is not in (0, 1), softness is negative or goes with another algorithm than the
/// convex one, or a system cannot be solved.
pub fn deform(
    mesh: &TriangleMesh,
    constraints: Constraints,
    targets: &[[f64; 3]],
    settings: Settings,
) -> Result<Deformation> {
    deform_with(mesh, constraints, targets, settings, Monitor::new().whole())
}

/// [`deform`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`deform`], or [`crate::Error::Cancelled`].
pub fn deform_with(
    mesh: &TriangleMesh,
    constraints: Constraints,
    targets: &[[f64; 3]],
    settings: Settings,
    stage: Stage,
) -> Result<Deformation> {
    let Settings {
        algorithm,
        softness,
        tolerance,
    } = settings;
    check_tolerance(tolerance)?;
    let Some(comparison) = algorithm.comparison() else {
        let mut deformer = Deformer::new_with(mesh, constraints, softness, stage)?;
        return deformer.solve_with(targets, tolerance, stage);
    };
    if softness != 0.0 {
        return Err(ArgumentError::inapplicable(
            "softness",
            "softness is for the convex algorithm only",
        )
        .into());
    }
    let needed = needs::deformation_for_comparison(needs::Size::of(mesh));
    require(needed, mesh, stage)?;
    let targets = constraints.targets(targets)?;
    let operators = Discretization::new_with(mesh, stage)?;
    operators.check_gradients(targets.spread())?;
    let problem = Problem {
        operators: &operators,
        targets: &targets,
        fixed: &constraints.fixed,
        variation: Variation::smoothed(0.0),
    };
    stage.report(0.0)?;
    if targets.radius == 0.0 {
        return Ok(carried(&targets));
    }
    let (mut displacement, iterations) = comparison(Task {
        mesh,
        problem,
        tolerance,
        stage,
    })?;
    stage.report(1.0)?;
    let total_variation = total_variation(operators.gradient(), displacement.view());
    let gap = certified_gap(problem, &displacement, stage)?;
    constraints.floating.carry(&mut displacement);
    Ok(Deformation {
        displacement,
        total_variation,
        gap,
        iterations,
    })
}

/// The gap that the dual field nearest to ∇d/|∇d| proves.
fn certified_gap(problem: Problem, displacement: &Array2<f64>, stage: Stage) -> Result<f64> {
    let gradient = problem.operators.gradient();
    let variation = total_variation(gradient, displacement.view());
    let mean = variation / problem.operators.area();
    if mean == 0.0 {
        return Ok(0.0);
    }
    let smoothed = Variation::smoothed(CERTIFICATE_SMOOTHING * mean);
    let weights = |norms: &[f64]| smoothed.weights(norms);
    let energy = problem.energy(&weights);
    let slope = energy.slope(displacement.view());
    let mut newton = PrimalDualNewton::new(problem.operators, 3, stage)?;
    newton.set_dual(&energy, &slope, energy.slope(displacement.view()).fluxes());
    newton.reweighted(&energy, &slope, &Array2::zeros(displacement.dim()), stage)?;
    Ok(problem.gap(
        displacement,
        &newton.balanced_dual(&energy, &slope, displacement, stage)?,
    ))
}
