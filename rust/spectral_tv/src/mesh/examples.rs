//! Small meshes for tests.

use crate::mesh::TriangleMesh;

/// Any triangles between five vertices, the last of which is far from the others.
pub fn five_vertices(triangles: &[[i64; 3]]) -> TriangleMesh {
    let vertices = vec![
        [0., 0., 0.],
        [1., 0., 0.],
        [0.3, 2., 0.5],
        [1., 1., -1.],
        [9., 9., 9.],
    ];
    TriangleMesh::new(vertices, triangles).unwrap()
}
