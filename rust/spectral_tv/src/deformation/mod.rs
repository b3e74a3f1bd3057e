//! Deformation: some vertices are moved, and the surface follows in rigid pieces. The stretch goes
//! to its bottlenecks (Brokman et al. 2024, section "Shape Deformation").
//!
//! The result is the displacement d = S′ − S of least total variation among those that meet the
//! constraints. [`Deformer`] solves that convex problem; the other algorithms are for comparison. A
//! new algorithm is a file, and a line in `algorithm`.

mod algorithm;
mod as_rigid_as_possible;
mod constraints;
mod deform;
mod deformer;
mod enclosing_ball;
mod floating;
mod outcome;
mod problem;
mod quadratic;
mod reweighted;
mod rotation;
mod span;

pub use algorithm::Algorithm;
pub use constraints::Constraints;
pub use deform::{Settings, deform, deform_with};
pub use deformer::Deformer;
pub use outcome::Deformation;
pub(crate) use rotation::nearest_rotation;
