//! Posing: some regions are moved, and the surface follows in rigid pieces that turn, with joints
//! at its bottlenecks.
//!
//! Every vertex has a position x and a rotation R. The result is the stationary point of
//!
//! E = Σ_f A (φ(e) + 20 s (0.4 − J)₊²) + (ρ/D) Σ_v m √(|x − p|² + (0.01 D)²),
//! e² = |∇x − R̄ T|² + ℓ² |∇R|² + ε², φ(e) = e + s e²/2,
//!
//! which is found from the last one. T is a face's tangent basis at rest, R̄ the mean rotation of
//! its corners, |∇R| the rate of turning, J the ratio of its areas in the plane of R̄ T. D is the
//! diagonal of the bounding box, m the vertex areas, and p the rest positions, moved along with the
//! greater part of what is held. The term of J keeps faces from turning over.
//!
//! E is least for rigid motions. A hinge costs its angle times the perimeter and the radius of what
//! is cut, so that joints go to bottlenecks. Linearized, E is the total variation of a field of
//! twists. With s = 0, ℓ → ∞ and ρ = 0 it is that of displacements, which [`crate::deformation`]
//! minimizes. It is not convex: a small gradient certifies a stationary point, not the least. A
//! face whose corners are half a turn apart can keep it from getting small.
//!
//! It is minimized by reweighted Gauss–Newton steps on a coarse mesh whose vertices are some of
//! the fine one's. The fine mesh follows each, and is smoothed. Conjugate gradients on the fine
//! mesh go the last way; the coarse mesh and the smoother are their preconditioner.

mod blocks;
mod coarse;
mod current;
mod decimation;
mod energy;
mod field;
mod frames;
mod handles;
mod levels;
mod lift;
mod linearized;
mod model;
mod motion;
mod newton;
mod outcome;
mod pieces;
mod poser;
mod quadric;
mod rig;
mod search;
mod settings;
mod smoother;
mod state;
#[cfg(test)]
mod tests;
mod waypoints;

pub use handles::Handles;
pub use outcome::Pose;
pub use poser::{Poser, pose, pose_with};
pub use rig::{Rig, rig, rig_with};
pub use settings::Settings;
pub use state::Snapshot;
