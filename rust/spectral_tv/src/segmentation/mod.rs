//! Co-segmentation: the same label on the same part of a shape in every pose, from the spectra of
//! its vertices (Brokman et al. 2024, Sec. 9.3 and the figure of the Michael models).

mod cosegment;
mod earth_mover;
mod k_means;

pub use cosegment::{cosegment, cosegment_with};
