//! Which vertices hang together.

use petgraph::unionfind::UnionFind;

use crate::mesh::TriangleMesh;

/// A label for every vertex that is the same within a connected component. A triangle without
/// area connects nothing; a vertex in no other is a component of its own.
pub(crate) fn connected_components(mesh: &TriangleMesh) -> Vec<u32> {
    let triangles = mesh.triangles().iter().zip(mesh.face_areas());
    let triangles = triangles.filter(|(_, area)| **area > 0.0);
    components_of(mesh.vertex_count(), triangles.map(|(corners, _)| *corners))
}

/// The same for the vertices that `triangles` connect.
pub(crate) fn components_of(
    vertex_count: usize,
    triangles: impl Iterator<Item = [u32; 3]>,
) -> Vec<u32> {
    let mut components = UnionFind::new(vertex_count);
    for [i, j, k] in triangles {
        components.union(i, j);
        components.union(j, k);
    }
    components.into_labeling()
}
