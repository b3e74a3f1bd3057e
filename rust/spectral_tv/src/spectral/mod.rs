//! The spectral transform of a flow, and what is made of it: spectrum, bands, filters.

mod bands;
mod transform;

pub(crate) use bands::check_edges;
pub use bands::even_edges;
pub use transform::SpectralTransform;
