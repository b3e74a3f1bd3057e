//! The methods that decompose a shape: which function is flowed, by which law, and how a
//! filtered function becomes a shape again.
//!
//! A new method is a variant of [`Method`] and an arm in `representation`, or in `decompose` if it
//! takes no steps.

mod accuracy;
mod adaptive_steps;
mod band_errors;
mod caricature;
mod decompose;
mod decomposition;
mod directional;
mod duration;
mod outward;
mod representation;
mod requirements;
mod schedule;

pub use accuracy::{Accuracy, AccuracyRequest, Errors, accuracy};
pub use adaptive_steps::check_accuracy;
pub use caricature::{Exaggeration, caricature};
pub use decompose::{Scheme, Settings, Steps, decompose, require_flow, run_flow};
pub use decomposition::Decomposition;
pub use directional::{Base, Displacement, Metric};
pub use duration::decomposition_duration;
pub use requirements::decomposition_memory;
pub use schedule::{default_times, graded_times, relative_scales};

/// A method of decomposing a shape into scales.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// Linear heat flow of the coordinates, for comparison.
    Heat,
    /// Each coordinate by its own TV flow; squares shapes along the axes (Sec. 7.2).
    Naive,
    /// M1, shape spectral TV: the coordinates together, in the metric of the shape (Sec. 7.3).
    ShapeTv,
    /// M2, conformalized P-Laplace (Sec. 7.4).
    ConformalLaplace {
        /// P: 1, 2 or 3. Only P = 3 is zero-homogeneous.
        p: u32,
    },
    /// M3, directional TV: the displacement from a smooth base (Sec. 7.5).
    DirectionalTv {
        /// The smooth base Ŝ.
        base: Base,
        /// Whose metric drives the flow.
        metric: Metric,
    },
    /// The eigenfunctions of the Laplace–Beltrami operator (Vallet and Lévy 2008), for
    /// comparison: components are ordered by 1/λ, the first is what the eigenpairs do not hold.
    LaplaceBeltrami {
        /// Number of eigenpairs, the lowest.
        eigenpairs: usize,
    },
    /// The whole displacement from a smooth base as one component, S + k (S − Ŝ) if amplified
    /// (Cignoni, Scopigno and Tarini 2005), for comparison.
    Displacement {
        /// The smooth base Ŝ.
        base: Base,
    },
}
