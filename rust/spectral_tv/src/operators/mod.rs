//! The discrete operators on piecewise linear functions: one value per vertex and channel.
//!
//! A function with C channels is an array of shape (C, V), each channel contiguous.

mod discretization;
mod edge_laplacian;
mod gradient;
mod inner_product;
mod laplacian;
mod side_by_side;
mod total_variation;

pub(crate) use discretization::invertible_masses;
pub use discretization::{Discretization, positions};
pub use edge_laplacian::EdgeLaplacian;
pub use gradient::{FaceVector, Gradient};
pub use inner_product::{inner_product, squared_norm};
pub use laplacian::{LaplacianPattern, Neighbour, element_stiffness, pin};
pub use side_by_side::SideBySide;
pub use total_variation::total_variation;
