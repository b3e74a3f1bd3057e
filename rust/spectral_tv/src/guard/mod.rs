//! What a displacement does to the faces of a mesh: which of them fold, stretch or cross others, and
//! how much of it is safe.

mod crossing;
mod displaced;
mod face;
mod folds;
mod ramp;
mod safe_displacement;
mod screen;
mod self_intersections;
mod slabs;
mod stretch;

pub use folds::{Folds, folds, folds_with};
pub use safe_displacement::{SafeDisplacement, safe_displacement, safe_displacement_with};
pub use self_intersections::{self_intersections, self_intersections_with};
pub use stretch::DEFAULT_STRETCH;
