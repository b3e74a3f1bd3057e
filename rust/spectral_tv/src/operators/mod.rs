//! The discrete operators on piecewise linear functions: one value per vertex and channel.
//!
//! A function with C channels is an array of shape (C, V), each channel contiguous.

mod discretization;
mod edge_laplacian;
mod gradient;
mod lanes;
mod laplacian;
mod total_variation;

pub(crate) use discretization::invertible_masses;
pub use discretization::{Discretization, positions};
pub use edge_laplacian::EdgeLaplacian;
pub use gradient::{FaceVector, Gradient};
pub use laplacian::{LaplacianPattern, Neighbour, element_stiffness, pin};
pub use total_variation::total_variation;
