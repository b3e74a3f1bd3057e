//! Which vertices hang together.

use petgraph::unionfind::UnionFind;

use crate::mesh::TriangleMesh;

/// A label for every vertex that is the same within a connected component. A triangle without
/// area connects nothing; a vertex in no other is a component of its own.
pub(crate) fn connected_components(mesh: &TriangleMesh) -> Vec<u32> {
    let mut components = UnionFind::new(mesh.vertex_count());
    for (&[i, j, k], &area) in mesh.triangles().iter().zip(mesh.face_areas()) {
        if area > 0.0 {
            components.union(i, j);
            components.union(j, k);
        }
    }
    components.into_labeling()
}
