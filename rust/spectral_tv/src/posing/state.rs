//! Where every vertex is, and how it is turned.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

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
    match norm > 1e-12 {
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
