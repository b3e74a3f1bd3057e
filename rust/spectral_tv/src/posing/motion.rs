//! Rigid motions, and the one that most of what is held has in common.

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use crate::deformation::nearest_rotation;
use crate::posing::state::{State, rotated};

/// What no turn counts, relative to the handles, in finding what they have in common.
const PRIOR: f64 = 1e-3;
/// Distances from a common motion, relative to the diagonal, within which points are taken to have
/// it: more and more exactly.
const CLOSE: [f64; 3] = [1e-2, 1e-5, 1e-8];
const MOST_ITERATIONS: usize = 60;

/// What a point counts, where it is at rest, and where it goes.
pub(super) type Pair = (f64, Vector3<f64>, Vector3<f64>);

/// A rigid motion: turns, then moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Motion {
    pub rotation: Quaternion<f64>,
    pub translation: Vector3<f64>,
}

impl Motion {
    pub fn none() -> Self {
        Self {
            rotation: Quaternion::identity(),
            translation: Vector3::zeros(),
        }
    }

    pub fn applied(&self, point: &Vector3<f64>) -> Vector3<f64> {
        rotated(&self.rotation, point) + self.translation
    }

    /// Moves a whole state.
    pub fn carry(&self, state: &mut State) {
        if *self == Self::none() {
            return;
        }
        for position in &mut state.positions {
            *position = self.applied(position);
        }
        for rotation in state.rotations.iter_mut().chain(&mut state.bodies) {
            *rotation = (self.rotation * *rotation).normalize();
        }
    }

    /// What leads from this one to `next`.
    pub fn to(&self, next: &Self) -> Self {
        let rotation = next.rotation * self.rotation.conjugate();
        let translation = next.translation - rotated(&rotation, &self.translation);
        Self {
            rotation,
            translation,
        }
    }
}

/// The rigid motion of the least Σ m |M p − t| over `points`, which is that of the greater part if it
/// moves rigidly. `diagonal` is that of the mesh.
pub(super) fn common_motion(points: &[Pair], diagonal: f64) -> Motion {
    let total: f64 = points.iter().map(|point| point.0).sum();
    let none = Motion::none();
    let is_still = |p: &Pair| p.1 == p.2;
    let still: f64 = points.iter().filter(|p| is_still(p)).map(|p| p.0).sum();
    if still >= 0.5 * total {
        return none;
    }
    // What lies on a motion to within each of these in turn decides it more exactly.
    let close = CLOSE.map(|close| close * diagonal);
    let exact = |mut motion: Motion| {
        for close in close {
            let is_on = |p: &Pair| (motion.applied(&p.1) - p.2).norm() < close;
            let on_it: f64 = points.iter().filter(|p| is_on(p)).map(|p| p.0).sum();
            if on_it <= 0.5 * total {
                return None;
            }
            let own = |p: &Pair| if is_on(p) { p.0 } else { 0.0 };
            motion = fitted(points, &motion, 0.0, own);
        }
        Some(motion)
    };
    let all = fitted(points, &none, 0.0, |p| p.0);
    if let Some(motion) = exact(all) {
        return motion;
    }
    // Turns that a line or a point leaves open are none.
    let prior = PRIOR * total * diagonal;
    let mut motion = none;
    for _ in 0..MOST_ITERATIONS {
        let weight = |p: &Pair| p.0 / (motion.applied(&p.1) - p.2).norm().max(close[2]);
        let next = fitted(points, &motion, prior, weight);
        let change = motion.to(&next);
        motion = next;
        let shifts = points.iter().map(|p| (change.applied(&p.2) - p.2).norm());
        if shifts.fold(0.0, f64::max) < close[2] {
            break;
        }
    }
    exact(motion).unwrap_or(motion)
}

/// The rigid motion of least Σ w |M p − t|², no turn counting as much as `prior`, mass × length².
pub(super) fn fitted(
    points: &[Pair],
    known: &Motion,
    prior: f64,
    weight: impl Fn(&Pair) -> f64,
) -> Motion {
    let weights: Vec<f64> = points.iter().map(weight).collect();
    let total: f64 = weights.iter().sum();
    if total <= 0.0 {
        return *known;
    }
    let (mut before, mut after) = (Vector3::zeros(), Vector3::zeros());
    for (point, weight) in points.iter().zip(&weights) {
        before += weight / total * point.1;
        after += weight / total * point.2;
    }
    let mut covariance = Matrix3::from_diagonal_element(prior);
    for (point, weight) in points.iter().zip(&weights) {
        covariance += *weight * (point.2 - after) * (point.1 - before).transpose();
    }
    let known = UnitQuaternion::from_quaternion(known.rotation).to_rotation_matrix();
    let rotation: Rotation3<f64> = nearest_rotation(covariance, &known);
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation).into_inner();
    Motion {
        translation: after - rotated(&rotation, &before),
        rotation,
    }
}
