//! The methods that decompose a shape. A method says which function flows, by which law, and how a
//! filtered function becomes a shape again.
//!
//! A new method is a variant of [`Method`], a row in `facts`, and an arm in `representation`, or in
//! `decompose` if it takes no steps. A new option is a line in `options`.

mod accuracy;
mod adaptive_steps;
mod band_errors;
mod caricature;
mod checks;
mod decompose;
mod decomposition;
mod directional;
mod duration;
mod facts;
mod limbs;
mod options;
mod outward;
mod representation;
mod requirements;
mod schedule;
mod settings;
mod value;

pub use accuracy::{Accuracy, AccuracyRequest, Errors, accuracy, accuracy_with};
pub use caricature::{Exaggeration, caricature, caricature_with};
pub use decompose::{decompose, decompose_with};
pub use decomposition::Decomposition;
pub use directional::{Base, Displacement, Flowing, Metric};
pub use duration::decomposition_duration;
pub use facts::{Facts, Work};
pub use options::{Choice, OPTIONS, Settings};
pub use requirements::decomposition_memory;
pub use schedule::graded_times;
pub use value::{Kind, Value};

use crate::named::named;

named! {
    /// A method of decomposing a shape into scales.
    pub enum Method: "method" {
        /// M1, shape spectral TV: the coordinates together, in the metric of the shape (Brokman et al.
        /// 2024, Sec. 7.3).
        #[default]
        ShapeTv = "m1",
        /// M2, conformalized P-Laplace (Sec. 7.4).
        ConformalLaplace = "m2",
        /// M3, directional TV: the displacement from a smooth base (Sec. 7.5).
        DirectionalTv = "m3",
        /// Each coordinate by its own TV flow; squares shapes along the axes (Sec. 7.2).
        Naive = "naive",
        /// Linear heat flow of the coordinates, for comparison.
        Heat = "heat",
        /// The eigenfunctions of the Laplace–Beltrami operator (Vallet and Lévy 2008), for
        /// comparison: components are ordered by 1/λ, the first is what the eigenpairs do not hold.
        LaplaceBeltrami = "lb",
        /// The whole displacement from a smooth base as one component, S + k (S − Ŝ) if amplified
        /// (Cignoni, Scopigno and Tarini 2005), for comparison.
        Displacement = "displacement",
    }
}
