//! The spectral transform of a flow, and what is made of it: spectrum, bands, filters.

mod bands;
mod transform;

pub use bands::{check_edges, even_edges};
pub use transform::SpectralTransform;
