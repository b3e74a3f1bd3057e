//! How thick a shape is at every vertex.
//!
//! The thickness is the radius of the largest inscribed ball that reaches the vertex, as in the local
//! thickness of Hildebrand and Rüegsegger 1997. It is computed in this order:
//!
//! 1. `scaled`: the mesh in units of its own size, in its connected parts;
//! 2. `outward`: which side of each triangle is outside;
//! 3. `samples`: points all over the surface;
//! 4. `inscribed`: the `ball` at each point that touches the surface from inside (the shrinking-ball
//!    algorithm of Ma, Bae and Choi 2012), grown where the `space` around it has more room;
//! 5. `reach`: the largest ball that reaches each vertex. This passes over the small balls below
//!    bumps, grooves and folds of the skin, but not onto what stands out;
//! 6. `limit`: from thin parts on, thickness grows slowly along the surface.
//!
//! `following` has the thickness of a shape that moves go on from frame to frame.

mod ball;
mod following;
mod incidence;
mod inscribed;
mod limit;
mod outward;
mod reach;
mod samples;
pub(crate) mod scaled;
mod search;
mod space;
pub(crate) mod triangle;

use crate::error::Result;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
pub use following::{thickness_after, thickness_after_with};
use incidence::Incidence;
use inscribed::Balls;
use limit::{filled, limited, smoothed};
use outward::Outward;
use reach::reached;
use scaled::Scaled;

/// Bytes per vertex that it takes at most: 595 were measured at 100 000 vertices, 643 at 400 000.
const MEMORY: u64 = 650;

/// The thickness of the shape at every vertex, V, length.
///
/// A closed surface has that of the solid inside it. A sheet has none; there the balls on either side
/// count, so that a sleeve is as thick as an arm. The same holds for a closed shell whose two layers
/// are much wider than the distance between them. No thickness exceeds that of the ball with the area
/// of the connected part. A vertex in no triangle has the thickness 0. It is measured once for a mesh
/// and its clones.
///
/// # Errors
/// [`crate::Error::Memory`] if the work does not fit into what is available.
pub fn thickness(mesh: &TriangleMesh) -> Result<&[f64]> {
    thickness_with(mesh, Monitor::new().whole())
}

/// [`thickness`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`thickness`], or [`crate::Error::Cancelled`].
pub fn thickness_with<'a>(mesh: &'a TriangleMesh, stage: Stage) -> Result<&'a [f64]> {
    if mesh.thickness.get().is_none() {
        // Whoever was faster has found the same.
        let _ = mesh.thickness.set(measured(mesh, stage)?);
    }
    Ok(mesh.thickness.get().expect("set above"))
}

fn measured(mesh: &TriangleMesh, stage: Stage) -> Result<Vec<f64>> {
    stage.claim(
        MEMORY.saturating_mul(mesh.vertex_count().max(mesh.triangles().len() / 2) as u64),
        &format!("the thickness of {} vertices", mesh.vertex_count()),
        "take a mesh of fewer vertices",
    )?;
    stage.report(0.0)?;
    let shape = stage.pass(|| Scaled::new(mesh))?;
    let incidence = stage.pass(|| Incidence::new(&shape))?;
    let outward = Outward::new(&shape, &incidence, stage)?;
    stage.report(0.2)?;
    let balls = Balls::inscribed(&shape, &outward, stage)?;
    stage.report(0.7)?;
    let mut radii = reached(&shape, &incidence, &outward, &balls, stage)?;
    filled(&shape, &incidence, &mut radii, stage)?;
    stage.report(0.8)?;
    limited(&shape, &incidence, &mut radii, stage)?;
    stage.report(0.9)?;
    let radii = smoothed(&shape, &incidence, radii, stage)?;
    stage.report(1.0)?;
    Ok(radii
        .into_iter()
        .map(|radius| radius * shape.unit)
        .collect())
}
