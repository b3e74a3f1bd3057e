//! Connected components without any constraint: they follow the surface nearest to them.

use nalgebra::{Matrix3, Rotation3, Vector3};
use ndarray::Array2;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::deformation::rotation::nearest_rotation;
use crate::mesh::TriangleMesh;

/// The pieces that nothing holds, such as the eyes of a head.
#[derive(Debug, Clone)]
pub(crate) struct Floating {
    /// Of every vertex, whether it is of such a piece.
    pub is_floating: Vec<bool>,
    pieces: Vec<Vec<Follower>>,
}

/// A floating vertex and the vertex nearest to it on what is held.
#[derive(Debug, Clone)]
struct Follower {
    vertex: usize,
    position: Vector3<f64>,
    nearest: usize,
    nearest_position: Vector3<f64>,
}

impl Floating {
    /// The components of `mesh` in which no vertex is in `held`.
    pub fn new(mesh: &TriangleMesh, held: impl Iterator<Item = usize>) -> Self {
        let components = mesh.connected_components();
        let mut is_held = vec![false; mesh.vertex_count()];
        for vertex in held {
            is_held[components[vertex] as usize] = true;
        }
        let is_floating: Vec<bool> = components.iter().map(|&c| !is_held[c as usize]).collect();
        Self {
            pieces: followers(mesh, &components, &is_floating),
            is_floating,
        }
    }

    /// Moves every piece by the rigid motion that fits the `displacement` (3, V) of the surface
    /// nearest to it.
    pub fn carry(&self, displacement: &mut Array2<f64>) {
        self.carry_and(displacement, |_, _| {});
    }

    /// [`Self::carry`], which tells `turn` each vertex and how it is turned.
    pub fn carry_and(
        &self,
        displacement: &mut Array2<f64>,
        mut turn: impl FnMut(usize, &Rotation3<f64>),
    ) {
        for piece in &self.pieces {
            let moved = |follower: &Follower| {
                let at = |axis: usize, _| displacement[[axis, follower.nearest]];
                follower.nearest_position + Vector3::from_fn(at)
            };
            let scale = 1.0 / piece.len() as f64;
            let before: Vector3<f64> = piece.iter().map(|f| f.nearest_position).sum();
            let after: Vector3<f64> = piece.iter().map(moved).sum();
            let (before, after) = (before * scale, after * scale);
            let mut covariance = Matrix3::zeros();
            for follower in piece {
                let arm = follower.nearest_position - before;
                covariance += (moved(follower) - after) * arm.transpose();
            }
            let rotation = nearest_rotation(covariance, &Rotation3::identity());
            for follower in piece {
                let target = after + rotation * (follower.position - before);
                for axis in 0..3 {
                    let change = target[axis] - follower.position[axis];
                    displacement[[axis, follower.vertex]] = change;
                }
                turn(follower.vertex, &rotation);
            }
        }
    }
}

fn followers(mesh: &TriangleMesh, components: &[u32], is_floating: &[bool]) -> Vec<Vec<Follower>> {
    let vertices = mesh.vertices();
    let held = (0..vertices.len()).filter(|&vertex| !is_floating[vertex]);
    let tree = RTree::bulk_load(held.map(|v| GeomWithData::new(vertices[v], v)).collect());
    let mut pieces: Vec<Vec<Follower>> = vec![Vec::new(); vertices.len()];
    for vertex in (0..vertices.len()).filter(|&vertex| is_floating[vertex]) {
        let Some(nearest) = tree.nearest_neighbor(&vertices[vertex]) else {
            continue;
        };
        pieces[components[vertex] as usize].push(Follower {
            vertex,
            position: Vector3::from(vertices[vertex]),
            nearest: nearest.data,
            nearest_position: Vector3::from(*nearest.geom()),
        });
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}
