//! Corners at exactly the same place.

use crate::mesh::weld::surface::Surface;

/// Makes all corners on open edges that are at one place one.
pub(super) fn join(surface: &mut Surface) {
    let corners = surface.corners();
    let groups = corners.chunk_by(|a, b| a.position == b.position);
    let groups = groups.filter(|group| group.len() > 1);
    let groups: Vec<Vec<u32>> = groups
        .map(|group| group.iter().map(|corner| corner.vertex).collect())
        .collect();
    surface.join(&groups, true, 0.0);
}
