//! Connected components of a mesh.

use petgraph::unionfind::UnionFind;

/// A label for every vertex that is the same within a connected component. A vertex in no
/// triangle is a component of its own.
pub fn connected_components(vertex_count: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut components = UnionFind::new(vertex_count);
    for &[i, j, k] in triangles {
        components.union(i, j);
        components.union(j, k);
    }
    components.into_labeling()
}
