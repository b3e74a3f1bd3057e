//! What a decomposition takes, before it starts.

use crate::error::Result;
use crate::flow::check_steps;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::method::adaptive_steps::FEWEST_STEPS;
use crate::method::{Method, Settings, Steps};
use crate::monitor::Stage;

/// For refusals.
const ADVICE: &str = "take fewer steps, or a mesh of fewer vertices";
const FEWER: &str = "take fewer eigenpairs, or a mesh of fewer vertices";

/// Bytes at the peak of decomposing a mesh of so many vertices and triangles, beside the mesh:
/// about, within a half. Where an accuracy decides on the steps, those of the first two flows,
/// which are the least it takes.
pub fn decomposition_memory(vertices: usize, triangles: usize, settings: &Settings) -> u64 {
    let size = needs::Size::new(vertices, triangles);
    let steps = step_count(settings);
    let is_iterated = is_iterated(settings, vertices);
    let flow = |channels: usize, steps: usize| needs::flow(size, channels, steps, is_iterated);
    match &settings.method {
        Method::Heat | Method::ShapeTv | Method::ConformalLaplace { .. } => flow(3, steps),
        // One by one, and then together.
        Method::Naive => flow(6, steps),
        Method::DirectionalTv { .. } => flow(1, steps).saturating_add(needs::base(size)),
        Method::LaplaceBeltrami { eigenpairs } => {
            let pairs = needs::eigenpairs(size, (*eigenpairs).min(vertices));
            // The states come when the basis has gone, but not the eigenfunctions.
            pairs.max(needs::flow(
                size,
                (*eigenpairs)
                    .min(vertices)
                    .saturating_add(steps.saturating_mul(3)),
                1,
                false,
            ))
        }
        Method::Displacement { .. } => flow(3, 10),
    }
}

/// The same for `mesh`.
pub(super) fn decomposition_memory_of(mesh: &TriangleMesh, settings: &Settings) -> u64 {
    decomposition_memory(mesh.vertex_count(), mesh.triangles().len(), settings)
}

/// Whether the systems of a method's flow on so many vertices are surely solved by iteration.
pub(super) fn is_iterated(settings: &Settings, vertices: usize) -> bool {
    let channels = match settings.method {
        Method::Naive | Method::DirectionalTv { .. } => 1,
        _ => 3,
    };
    settings
        .scheme
        .is_iterated(settings.solver, vertices, channels)
}

/// Refuses a number of steps that no flow takes.
///
/// # Errors
/// As [`check_steps`], where it is the number that counts.
pub(super) fn check_step_count(settings: &Settings) -> Result<()> {
    let has_steps = !matches!(settings.method, Method::Displacement { .. });
    match (settings.steps, &settings.times) {
        (Steps::Count(count), None) if has_steps => check_steps(count),
        _ => Ok(()),
    }
}

/// Steps that are taken and kept; of an accuracy those of the first two flows.
pub(super) fn step_count(settings: &Settings) -> usize {
    let given = settings
        .times
        .as_ref()
        .map(|times| times.len().saturating_sub(1));
    match settings.steps {
        Steps::Count(count) => given.unwrap_or(count),
        // The flow with so many steps, and twice as many.
        Steps::Accuracy(_) => given.unwrap_or(0).max(FEWEST_STEPS).saturating_mul(3),
    }
}

/// Refuses to decompose what does not fit into the memory that is available.
///
/// # Errors
/// [`crate::Error::Memory`], or as [`check_step_count`].
pub(super) fn check_memory(mesh: &TriangleMesh, settings: &Settings, stage: Stage) -> Result<()> {
    check_step_count(settings)?;
    let vertices = mesh.vertex_count();
    let needed = decomposition_memory_of(mesh, settings);
    let advice = match settings.method {
        Method::LaplaceBeltrami { .. } => FEWER,
        _ => ADVICE,
    };
    stage.require(needed, &format!("decomposing {vertices} vertices"), advice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::Weights;
    use crate::method::Scheme;
    use crate::solver::Solver;

    #[test]
    fn more_steps_vertices_and_eigenpairs_take_more() {
        let settings = |method: Method, steps: usize| Settings {
            method,
            times: None,
            steps: Steps::Count(steps),
            scheme: Scheme::SemiImplicit(Weights::Lagged),
            solver: Solver::Auto,
        };
        let bytes = |vertices: usize, method: Method, steps: usize| {
            decomposition_memory(
                vertices,
                vertices.saturating_mul(2),
                &settings(method, steps),
            )
        };
        // A million vertices: single precision, 12 bytes for each step and vertex.
        let growth = bytes(1_000_000, Method::ShapeTv, 40) - bytes(1_000_000, Method::ShapeTv, 30);
        assert_eq!(growth, 120_000_000);
        assert!(bytes(2_000, Method::Heat, 8) < bytes(3_000, Method::Heat, 8));
        let pairs = |eigenpairs| Method::LaplaceBeltrami { eigenpairs };
        assert!(bytes(9_000, pairs(100), 8) < bytes(9_000, pairs(200), 8));
        assert_eq!(
            bytes(9_000, pairs(9_000), 8),
            bytes(9_000, pairs(usize::MAX), 8)
        );
        assert!(bytes(usize::MAX, Method::ShapeTv, usize::MAX) == u64::MAX);
    }
}
