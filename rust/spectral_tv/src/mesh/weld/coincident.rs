//! Corners at exactly the same place.

use crate::mesh::open_edges::{OpenEdge, open_edges};
use crate::mesh::weld::Surface;

/// Makes all corners on open edges that are at one place one; how many went.
pub(super) fn join(surface: &mut Surface, border: &mut Vec<OpenEdge>) -> usize {
    let corners = surface.corners(border);
    let groups = corners.chunk_by(|a, b| a.position == b.position);
    let groups = groups.filter(|group| group.len() > 1);
    let groups: Vec<Vec<u32>> = groups
        .map(|group| group.iter().map(|corner| corner.vertex).collect())
        .collect();
    for group in &groups {
        let weight = group.iter().map(|&v| surface.weights[v as usize]).sum();
        let first = group.iter().min().expect("groups have members");
        surface.weights[*first as usize] = weight;
    }
    surface.join(&groups);
    let gone = groups.iter().map(|group| group.len() - 1).sum();
    if gone > 0 {
        *border = open_edges(surface.vertices.len(), &surface.triangles);
    }
    gone
}
