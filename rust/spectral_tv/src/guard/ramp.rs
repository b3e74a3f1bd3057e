//! Shares of a displacement at the vertices that change no faster than a ramp along the edges.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::error::Result;
use crate::mesh::TriangleMesh;
use crate::monitor::Stage;

/// A ramp from 0 to 1, and the graph of the edges that it goes along.
pub(super) struct Ramp<'a> {
    mesh: &'a TriangleMesh,
    length: f64,
    /// Where the faces of each vertex begin, V + 1, and the faces.
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl<'a> Ramp<'a> {
    /// One of so great a length.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(mesh: &'a TriangleMesh, length: f64, stage: Stage) -> Result<Self> {
        let corners = || (0_u32..).zip(mesh.triangles().iter());
        let mut starts = vec![0_u32; mesh.vertex_count() + 1];
        stage.for_each(corners(), |(_, corners)| {
            for &vertex in corners {
                starts[vertex as usize + 1] += 1;
            }
        })?;
        for vertex in 0..mesh.vertex_count() {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut faces = vec![0; 3 * mesh.triangles().len()];
        stage.for_each(corners(), |(face, corners)| {
            for &vertex in corners {
                let place = &mut next[vertex as usize];
                faces[*place as usize] = face;
                *place += 1;
            }
        })?;
        Ok(Self {
            mesh,
            length,
            starts,
            faces,
        })
    }

    /// Lowers every share to min_w (share at w + distance to w / length), the distance being that
    /// along edges (Dijkstra). Where shares were lowered since the last time is told by `lowered`.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn lower(
        &self,
        shares: &mut [f64],
        lowered: impl Iterator<Item = u32>,
        stage: Stage,
    ) -> Result<()> {
        // Bits of numbers that are not negative are in the order of the numbers.
        let key = |share: f64, vertex| Reverse((share.to_bits(), vertex));
        let first = lowered.map(|vertex| key(shares[vertex as usize], vertex));
        let mut queue: BinaryHeap<_> = first.collect();
        let settled = std::iter::from_fn(|| {
            let Reverse((bits, vertex)) = queue.pop()?;
            let share = f64::from_bits(bits);
            // It may have been lowered again since.
            if share == shares[vertex as usize] {
                for (neighbour, distance) in self.neighbours(vertex) {
                    let ramp = share + distance / self.length;
                    if ramp < shares[neighbour as usize] {
                        shares[neighbour as usize] = ramp;
                        queue.push(key(ramp, neighbour));
                    }
                }
            }
            Some(())
        });
        stage.for_each(settled, |()| {})
    }

    /// The other ends of a vertex' edges, each as often as there are faces at the edge, and how far
    /// away they are.
    fn neighbours(&self, vertex: u32) -> impl Iterator<Item = (u32, f64)> {
        let faces = self.starts[vertex as usize]..self.starts[vertex as usize + 1];
        let faces = &self.faces[faces.start as usize..faces.end as usize];
        faces.iter().flat_map(move |&face| {
            let face = face as usize;
            let others = self.mesh.triangles()[face].into_iter();
            others
                .filter(move |&other| other != vertex)
                .map(move |other| (other, self.distance(vertex, other)))
        })
    }

    fn distance(&self, one: u32, other: u32) -> f64 {
        let [p, q] = [one, other].map(|vertex| self.mesh.vertices()[vertex as usize]);
        let squares = (0..3).map(|axis| (p[axis] - q[axis]).powi(2));
        squares.sum::<f64>().sqrt()
    }
}
