//! From coarse motions to fine ones, and back.

use nalgebra::{Quaternion, Vector3, Vector4};

use crate::parallel;
use crate::posing::decimation::Decimated;
use crate::posing::field::Field;
use crate::posing::state::{State, aligned, normalized, rotated};

/// Where every fine vertex is on the coarse mesh.
pub(super) struct Lift {
    /// The fine vertex that each coarse one is.
    pub vertices: Vec<u32>,
    /// Coarse corners and their shares; all 0 for a vertex that nothing holds.
    places: Vec<([u32; 3], [f64; 3])>,
}

impl Lift {
    pub fn new(positions: &[Vector3<f64>], decimated: &Decimated) -> Self {
        let coarse = &decimated.vertices;
        let triangles = &decimated.triangles;
        let mut around = vec![Vec::new(); coarse.len()];
        for (face, corners) in triangles.iter().enumerate() {
            for &corner in corners {
                around[corner as usize].push(face as u32);
            }
        }
        let near = |representative: u32| {
            let mut faces: Vec<u32> = around[representative as usize]
                .iter()
                .flat_map(|&face| triangles[face as usize])
                .flat_map(|corner| around[corner as usize].iter().copied())
                .collect();
            faces.sort_unstable();
            faces.dedup();
            faces
        };
        let near: Vec<Vec<u32>> = (0..coarse.len() as u32).map(near).collect();
        let place = |vertex: usize| {
            let Some(representative) = decimated.representatives[vertex] else {
                return ([0; 3], [0.0; 3]);
            };
            if coarse[representative as usize] as usize == vertex {
                return ([representative; 3], [1.0, 0.0, 0.0]);
            }
            let mut best = (f64::INFINITY, [representative; 3], [1.0, 0.0, 0.0]);
            for &face in &near[representative as usize] {
                let corners = triangles[face as usize];
                let points = corners.map(|corner| positions[coarse[corner as usize] as usize]);
                let shares = nearest(points, positions[vertex]);
                let at: Vector3<f64> = (0..3).map(|i| shares[i] * points[i]).sum();
                let distance = (at - positions[vertex]).norm_squared();
                if distance < best.0 {
                    best = (distance, corners, shares);
                }
            }
            (best.1, best.2)
        };
        Self {
            places: parallel::values(positions.len(), place),
            vertices: coarse.clone(),
        }
    }

    /// The coarse vertices of a fine state.
    pub fn injected(&self, fine: &State) -> State {
        State {
            positions: self.taken(&fine.positions),
            rotations: self.taken(&fine.rotations),
            bodies: fine.bodies.clone(),
        }
    }

    /// Moves a fine state along with the coarse one, from `before` to `after`.
    pub fn carry(&self, fine: &State, before: &State, after: &State) -> State {
        let turns: Vec<Quaternion<f64>> = before
            .rotations
            .iter()
            .zip(&after.rotations)
            .map(|(before, after)| after * before.conjugate())
            .collect();
        let carried = |vertex: usize| {
            let (corners, shares) = &self.places[vertex];
            let old = fine.positions[vertex];
            if *shares == [0.0; 3] {
                return (old, fine.rotations[vertex]);
            }
            let (mut position, mut turn) = (Vector3::zeros(), Quaternion::new(0.0, 0.0, 0.0, 0.0));
            let first = turns[corners[0] as usize];
            for (&corner, &share) in corners.iter().zip(shares) {
                let corner = corner as usize;
                let arm = old - before.positions[corner];
                position += share * (after.positions[corner] + rotated(&turns[corner], &arm));
                turn += aligned(turns[corner], &first) * share;
            }
            let rotation = normalized(turn) * fine.rotations[vertex];
            (position, rotation.normalize())
        };
        let (positions, rotations) = parallel::values(self.places.len(), carried)
            .into_iter()
            .unzip();
        State {
            positions,
            rotations,
            bodies: after.bodies.clone(),
        }
    }

    /// A coarse field at the fine vertices, `coarse` and `fine` being where they are.
    pub fn prolong(&self, field: &Field, coarse: &State, fine: &State) -> Field {
        let motion = |vertex: usize| {
            let (corners, shares) = &self.places[vertex];
            let (mut moved, mut turn) = (Vector3::zeros(), Vector3::zeros());
            for (&corner, &share) in corners.iter().zip(shares) {
                let corner = corner as usize;
                let arm = fine.positions[vertex] - coarse.positions[corner];
                let own = field.turns[corner];
                moved += share * (field.moves[corner] + own.cross(&arm));
                turn += share * own;
            }
            (moved, turn)
        };
        let (moves, turns) = parallel::values(self.places.len(), motion)
            .into_iter()
            .unzip();
        Field {
            moves,
            turns,
            bodies: field.bodies.clone(),
        }
    }

    /// The adjoint of [`Self::prolong`].
    pub fn restrict(&self, field: &Field, coarse: &State, fine: &State) -> Field {
        let mut sums = Field::zeros(self.vertices.len(), field.bodies.len());
        for (vertex, (corners, shares)) in self.places.iter().enumerate() {
            let (force, torque) = (field.moves[vertex], field.turns[vertex]);
            for (&corner, &share) in corners.iter().zip(shares) {
                let corner = corner as usize;
                let arm = fine.positions[vertex] - coarse.positions[corner];
                sums.moves[corner] += share * force;
                sums.turns[corner] += share * (torque + arm.cross(&force));
            }
        }
        sums.bodies.clone_from(&field.bodies);
        sums
    }

    /// What the vertices that are coarse ones too have.
    pub fn taken<T: Clone>(&self, values: &[T]) -> Vec<T> {
        let vertices = self.vertices.iter();
        vertices.map(|&v| values[v as usize].clone()).collect()
    }

    /// Sums at every coarse vertex of the shares of what fine ones have.
    pub fn shared(&self, value: impl Fn(usize) -> Vector4<f64>) -> Vec<Vector4<f64>> {
        let mut sums = vec![Vector4::zeros(); self.vertices.len()];
        for (vertex, (corners, shares)) in self.places.iter().enumerate() {
            let value = value(vertex);
            if value.w != 0.0 {
                for (&corner, &share) in corners.iter().zip(shares) {
                    sums[corner as usize] += share * value;
                }
            }
        }
        sums
    }
}

/// Barycentric coordinates of the point of a triangle nearest to another point (Ericson 2005,
/// "Real-Time Collision Detection", section 5.1.5).
fn nearest([a, b, c]: [Vector3<f64>; 3], point: Vector3<f64>) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let sum = va + vb + vc;
    match sum > 0.0 {
        true => [va / sum, vb / sum, vc / sum],
        false => [1.0, 0.0, 0.0],
    }
}
