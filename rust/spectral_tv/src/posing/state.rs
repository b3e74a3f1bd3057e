//! Where every vertex is, and how it is turned.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use ndarray::Array2;

use crate::error::{ArgumentError, Result, unusable_values};
use crate::parallel;
use crate::posing::field::Field;

/// Unit quaternions are as long as 1 to this.
const UNIT: f64 = 1e-6;

/// A pose as numbers, from which another poser of the same mesh and handles goes on alike.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Where the handles were taken, one for each entry.
    pub targets: Vec<[f64; 3]>,
    /// x, (3, V), before floating pieces were carried.
    pub positions: Array2<f64>,
    /// R as unit quaternions w, x, y, z, (4, V).
    pub rotations: Array2<f64>,
    /// The same of every free body, (4, B).
    pub bodies: Array2<f64>,
}

/// A pose while it is sought.
#[derive(Debug, Clone)]
pub(super) struct State {
    /// x, V.
    pub positions: Vec<Vector3<f64>>,
    /// R as unit quaternions, V.
    pub rotations: Vec<Quaternion<f64>>,
    /// Of every free body.
    pub bodies: Vec<Quaternion<f64>>,
}

impl State {
    /// Rest.
    pub fn at_rest(positions: &[Vector3<f64>], bodies: usize) -> Self {
        Self {
            positions: positions.to_vec(),
            rotations: vec![Quaternion::identity(); positions.len()],
            bodies: vec![Quaternion::identity(); bodies],
        }
    }

    /// What moved it here from another state.
    pub fn since(&self, other: &Self) -> Field {
        let turns = |after: &[Quaternion<f64>], before: &[Quaternion<f64>]| {
            parallel::values(after.len(), |i| {
                let turn = aligned(after[i] * before[i].conjugate(), &Quaternion::identity());
                UnitQuaternion::new_unchecked(turn).scaled_axis()
            })
        };
        let moves = self.positions.iter().zip(&other.positions);
        Field {
            moves: moves.map(|(after, before)| after - before).collect(),
            turns: turns(&self.rotations, &other.rotations),
            bodies: turns(&self.bodies, &other.bodies),
        }
    }

    /// As numbers, with the targets that led to it.
    pub fn snapshot(&self, targets: &[[f64; 3]]) -> Snapshot {
        let positions = Array2::from_shape_fn((3, self.positions.len()), |(axis, vertex)| {
            self.positions[vertex][axis]
        });
        Snapshot {
            targets: targets.to_vec(),
            positions,
            rotations: quaternions(&self.rotations),
            bodies: quaternions(&self.bodies),
        }
    }

    /// Of numbers, for so many vertices and free bodies.
    ///
    /// # Errors
    /// If there are not as many, one is not finite, or beyond 1e100, or a quaternion is not of
    /// length 1.
    pub fn of(snapshot: &Snapshot, vertices: usize, bodies: usize) -> Result<Self> {
        let parts = [
            ("positions", &snapshot.positions, (3, vertices)),
            ("rotations", &snapshot.rotations, (4, vertices)),
            ("bodies", &snapshot.bodies, (4, bodies)),
        ];
        for (name, part, shape) in parts {
            let is_usable = part.dim() == shape && unusable_values(part.view()).is_none();
            let mut columns = part.columns().into_iter();
            let is_turn = |norm: f64| (norm - 1.0).abs() < UNIT;
            let is_unit = shape.0 == 3 || columns.all(|q| is_turn(q.dot(&q).sqrt()));
            if !(is_usable && is_unit) {
                let must = format!(
                    "the {name} of a poser of {vertices} vertices and {bodies} free bodies must be \
                     {} of {} finite numbers, quaternions of length 1",
                    shape.1, shape.0
                );
                return Err(ArgumentError::contradiction("state", &[], must).into());
            }
        }
        let points = snapshot.positions.columns().into_iter();
        let read = |part: &Array2<f64>| {
            let columns = part.columns().into_iter();
            columns
                .map(|q| Quaternion::new(q[0], q[1], q[2], q[3]))
                .collect()
        };
        Ok(Self {
            positions: points.map(|p| Vector3::new(p[0], p[1], p[2])).collect(),
            rotations: read(&snapshot.rotations),
            bodies: read(&snapshot.bodies),
        })
    }
}

/// As numbers w, x, y, z, (4, N).
pub(super) fn quaternions(rotations: &[Quaternion<f64>]) -> Array2<f64> {
    Array2::from_shape_fn((4, rotations.len()), |(part, index)| match part {
        0 => rotations[index].w,
        part => rotations[index].imag()[part - 1],
    })
}

/// `rotation` turned further by the rotation vector `turn`.
#[inline]
pub(super) fn turned(rotation: &Quaternion<f64>, turn: &Vector3<f64>) -> Quaternion<f64> {
    UnitQuaternion::from_scaled_axis(*turn).into_inner() * rotation
}

/// `arm` turned by a unit quaternion.
#[inline]
pub(super) fn rotated(rotation: &Quaternion<f64>, arm: &Vector3<f64>) -> Vector3<f64> {
    let (w, v) = (rotation.w, rotation.imag());
    let twice = 2.0 * v.cross(arm);
    arm + w * twice + v.cross(&twice)
}

/// The unit quaternion of a sum of some, or none if they cancel.
#[inline]
pub(super) fn normalized(sum: Quaternion<f64>) -> Quaternion<f64> {
    let norm = sum.norm();
    match norm > f64::MIN_POSITIVE {
        true => sum / norm,
        false => Quaternion::identity(),
    }
}

/// `rotation` or its negative, which turns alike: the one nearer to `other`.
#[inline]
pub(super) fn aligned(rotation: Quaternion<f64>, other: &Quaternion<f64>) -> Quaternion<f64> {
    match rotation.coords.dot(&other.coords) < 0.0 {
        true => -rotation,
        false => rotation,
    }
}
