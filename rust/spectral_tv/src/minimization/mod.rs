//! Minimisation of convex energies of the gradient, TV above all: what implicit steps of flows
//! and deformations have in common.

mod energy;
mod fields;
mod line_search;
mod newton;
mod tolerance;
mod variation;

pub use energy::{Energy, Slope};
pub use fields::{TangentField, clipping_factors, inner_products};
pub use line_search::{FARTHEST, least_along, least_up_to};
pub use newton::PrimalDualNewton;
pub use tolerance::check_tolerance;
pub use variation::Variation;
