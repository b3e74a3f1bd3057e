//! The discrete operators on piecewise linear functions: one unknown per vertex and channel, or one
//! per edge and channel.
//!
//! A function with C channels is an array of shape (C, V), each channel contiguous.

mod corners;
mod edge_elements;
mod edge_laplacian;
mod gradient;
mod grouped;
mod inner_product;
mod laplacian;
mod limiter;
mod mass;
mod masses;
mod over_lumping;
mod positions;
mod side_by_side;
mod total_variation;

pub use corners::Corners;
pub use edge_elements::EdgeElements;
pub use edge_laplacian::EdgeLaplacian;
pub use gradient::{FaceVector, Gradient};
pub(crate) use grouped::grouped;
pub use inner_product::{inner_product, squared_norm};
pub(crate) use laplacian::graph_of;
pub use laplacian::{LaplacianPattern, element_stiffness, pin};
pub use mass::Mass;
pub use masses::invertible_masses;
pub use positions::positions;
pub use side_by_side::SideBySide;
pub use total_variation::total_variation;
