//! The triangles at every vertex.

use crate::thickness::scaled::Scaled;

/// The triangles with area at every vertex, in order.
pub(super) struct Incidence {
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Incidence {
    pub fn new(shape: &Scaled) -> Self {
        let faces = || shape.parts.iter().flatten().copied();
        let mut starts = vec![0; shape.points.len() + 1];
        for face in faces() {
            for corner in shape.triangles[face as usize] {
                starts[corner as usize + 1] += 1;
            }
        }
        for vertex in 0..shape.points.len() {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut places = vec![0; starts[shape.points.len()] as usize];
        for face in faces() {
            for corner in shape.triangles[face as usize] {
                let place = &mut next[corner as usize];
                places[*place as usize] = face;
                *place += 1;
            }
        }
        Self {
            starts,
            faces: places,
        }
    }

    /// The triangles at a vertex.
    pub fn faces(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.faces[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// The corners of the triangles at a vertex: itself, and each neighbour as often as they share
    /// triangles.
    pub fn around<'a>(&'a self, shape: &'a Scaled, vertex: u32) -> impl Iterator<Item = u32> + 'a {
        let faces = self.faces(vertex).iter();
        faces.flat_map(|face| shape.triangles[*face as usize])
    }
}
