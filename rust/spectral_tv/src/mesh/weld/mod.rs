//! Joins surfaces along open edges that lie on one another.
//!
//! Corners at the same place become one. Then corners near one another become one, and edges are
//! split at corners that lie on them, until nothing more is found. All is treated in the order of
//! places, so the result does not depend on the order of vertices or triangles.

mod coincident;
mod joining;
mod junctions;
mod near;
mod patch;
mod surface;

use crate::error::{ArgumentError, Result};
use crate::mesh::findings::Findings;
use crate::mesh::open_edges::{open_edges, vertices_of};
pub(super) use patch::Patch;

/// Refuses tolerances that are no lengths.
pub(super) fn check_tolerance(tolerance: f64) -> Result<()> {
    match tolerance >= 0.0 && tolerance.is_finite() {
        true => Ok(()),
        false => {
            Err(ArgumentError::value("weld", "must be a length of 0 or more", tolerance).into())
        }
    }
}

/// What joining made of a mesh.
pub(super) struct Welded {
    /// Positions of all vertices; those of vertices that were joined to another are not used.
    pub vertices: Vec<[f64; 3]>,
    /// The triangles in their order, and the parts of those that were split.
    pub triangles: Vec<[u32; 3]>,
    /// Of every vertex, the one that it is now: the first of those joined.
    pub place: Vec<u32>,
    /// Counts of open edges, and of what was done about them.
    pub findings: Findings,
}

/// Joins what is within `tolerance` along open edges; with 0 at exactly the same place alone.
pub(super) fn weld(mut vertices: Vec<[f64; 3]>, triangles: &[[u32; 3]], tolerance: f64) -> Welded {
    let border = open_edges(vertices.len(), triangles);
    let mut findings = Findings::of_border(&border);
    let mut place: Vec<u32> = (0..vertices.len() as u32).collect();
    let mut triangles = triangles.to_vec();
    if !border.is_empty() {
        let mut patch = Patch::at(&vertices_of(&border), &vertices, &triangles);
        patch.surface.join_coincident();
        if tolerance > 0.0 {
            patch.surface.join_within(tolerance);
        }
        findings.open_edges = patch.surface.border().len();
        findings.joined_corners = patch.surface.joined_count();
        findings.closed_junctions = patch.surface.junctions();
        patch.put_back(&mut vertices, &mut triangles, &mut place);
    }
    Welded {
        vertices,
        triangles,
        place,
        findings,
    }
}
