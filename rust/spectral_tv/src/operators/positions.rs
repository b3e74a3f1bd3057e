//! A shape as a function on itself.

use ndarray::Array2;

use crate::mesh::TriangleMesh;

/// The positions of a mesh's vertices as a function with three channels, (3, V), in length.
pub fn positions(mesh: &TriangleMesh) -> Array2<f64> {
    let vertices = mesh.vertices();
    Array2::from_shape_fn((3, vertices.len()), |(axis, vertex)| vertices[vertex][axis])
}
