//! The spectral transform of a flow, and what is made of it: spectrum, bands, filters.

mod bands;
mod soft_edge;
mod thickness_cut;
mod transform;

pub(crate) use bands::check_edges;
pub use bands::even_edges;
pub(crate) use soft_edge::band_between;
pub(crate) use thickness_cut::ThicknessCut;
pub use transform::SpectralTransform;
