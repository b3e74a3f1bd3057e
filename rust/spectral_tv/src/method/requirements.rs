//! What a decomposition takes, estimated before it starts.

use crate::error::Result;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::method::directional::BASE_STEPS;
use crate::method::facts::Work;
use crate::method::{Base, Settings, limbs};
use crate::monitor::Stage;

/// For refusals.
const ADVICE: &str = "take fewer steps, or a mesh of fewer vertices";
const FEWER: &str = "take fewer eigenpairs, or a mesh of fewer vertices";

/// Bytes at the peak of decomposing a mesh of so many vertices and triangles, beside the mesh:
/// about, within a half. Where an accuracy decides on the steps, those of the first two flows,
/// which are the least it takes.
pub fn decomposition_memory(vertices: usize, triangles: usize, settings: &Settings) -> u64 {
    let size = needs::Size::new(vertices, triangles);
    let steps = settings.step_count();
    let solved = settings.solved(vertices);
    let facts = settings.method.facts();
    // The flow to a base that keeps limbs has ended when the other begins.
    let of_limbs = match settings.base {
        Base::Limbs => needs::flow(size, 3, limbs::STEPS, solved),
        _ => 0,
    };
    match settings.work() {
        Work::Flow { held, .. } => {
            let base = if facts.takes_base {
                needs::base(size)
            } else {
                0
            };
            let flow = needs::flow(size, held, steps, solved);
            flow.max(of_limbs).saturating_add(base)
        }
        Work::Eigenpairs => {
            let count = settings.eigenpairs.min(vertices);
            // The states come when the basis has gone, but not the eigenfunctions.
            let functions = count.saturating_add(steps.saturating_mul(3));
            needs::eigenpairs(size, count).max(needs::flow(
                size,
                functions,
                1,
                needs::Solved::Exactly,
            ))
        }
        Work::Base => needs::flow(size, 3, BASE_STEPS, solved).max(of_limbs),
    }
}

/// The same for `mesh`.
pub(super) fn decomposition_memory_of(mesh: &TriangleMesh, settings: &Settings) -> u64 {
    decomposition_memory(mesh.vertex_count(), mesh.triangles().len(), settings)
}

/// Refuses to decompose what does not fit into the memory that is available.
///
/// # Errors
/// [`crate::Error::Memory`].
pub(super) fn check_memory(mesh: &TriangleMesh, settings: &Settings, stage: Stage) -> Result<()> {
    let vertices = mesh.vertex_count();
    let needed = decomposition_memory_of(mesh, settings);
    let advice = match settings.method.facts().work {
        Work::Eigenpairs => FEWER,
        _ => ADVICE,
    };
    stage.require(needed, &format!("decomposing {vertices} vertices"), advice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Method;

    #[test]
    fn more_steps_vertices_and_eigenpairs_take_more() {
        let bytes = |vertices: usize, settings: &Settings| {
            decomposition_memory(vertices, vertices.saturating_mul(2), settings)
        };
        let flow = |steps: usize| Settings {
            steps,
            ..Settings::m1()
        };
        // A million vertices: single precision, 12 bytes for each step and vertex.
        let growth = bytes(1_000_000, &flow(40)) - bytes(1_000_000, &flow(30));
        assert_eq!(growth, 120_000_000);
        let heat = Settings::from(Method::Heat);
        assert!(bytes(2_000, &heat) < bytes(3_000, &heat));
        let pairs = |eigenpairs| Settings {
            eigenpairs,
            ..Method::LaplaceBeltrami.into()
        };
        assert!(bytes(9_000, &pairs(100)) < bytes(9_000, &pairs(200)));
        assert_eq!(
            bytes(9_000, &pairs(9_000)),
            bytes(9_000, &pairs(usize::MAX))
        );
        assert!(bytes(usize::MAX, &flow(usize::MAX)) == u64::MAX);
    }
}
