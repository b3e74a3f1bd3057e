//! The corners of faces that meet at each vertex, to add up there what each face has at its corners.
//!
//! Every sum is gathered in the order of faces. So threads can share the work, and the results do not depend
//! on how they do.

use crate::error::Result;
use crate::monitor::Stage;
use crate::operators::Gradient;
use crate::operators::grouped::grouped;

/// The corners at every vertex of a mesh.
pub struct Corners {
    /// First corner of each vertex, and the number of corners at the end.
    starts: Vec<u32>,
    /// Three times the face and the corner's place in it.
    corners: Vec<u32>,
}

impl Corners {
    /// Those of the mesh of `gradient`.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(gradient: &Gradient, stage: Stage) -> Result<Self> {
        let vertices = gradient.triangles().as_flattened();
        let (starts, corners) = grouped(vertices, gradient.vertex_count(), stage)?;
        Ok(Self { starts, corners })
    }

    /// The sum of `values`, three for every face, over the corners at `vertex`.
    #[inline]
    pub fn sum_at(&self, vertex: usize, values: &[[f64; 3]]) -> f64 {
        let values = values.as_flattened();
        let here = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
        let corners = self.corners[here].iter();
        corners.map(|&corner| values[corner as usize]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::examples::five_vertices;
    use crate::monitor::Monitor;

    #[test]
    fn fluxes_add_up_to_what_the_adjoint_gives() {
        // A non-manifold edge 1-2, a repeated index and a vertex without neighbours.
        let mesh = five_vertices(&[[0, 1, 2], [1, 3, 2], [2, 1, 0], [3, 3, 1]]);
        let monitor = Monitor::new();
        let gradient = Gradient::new(&mesh, monitor.whole()).unwrap();
        let corners = Corners::new(&gradient, monitor.whole()).unwrap();
        let field = [[1.0, 2.0], [-0.5, 3.0], [0.25, -1.0], [7.0, 1.0]];
        let fluxes: Vec<_> = (0..4)
            .map(|face| gradient.flux(face, field[face]))
            .collect();
        let expected = gradient.adjoint(|face| field[face]);
        for (vertex, expected) in expected.iter().enumerate() {
            assert!((corners.sum_at(vertex, &fluxes) - expected).abs() < 1e-13);
        }
    }
}
