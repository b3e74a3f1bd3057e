//! Spectral TV of images: pixels as a function on a grid, in the metric of the plane or of the
//! image's own graph (Brokman et al. 2024, Sec. 9.3).

mod decompose;
mod grid;

pub use decompose::{Image, Settings, decompose_image, decompose_image_with};
pub use grid::Metric;
