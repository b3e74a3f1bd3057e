//! The algorithms of deformation, each with what finds a displacement by it.

use ndarray::Array2;

use crate::deformation::problem::Task;
use crate::error::Result;
use crate::named::named;

named! {
    /// How a deformation is found.
    pub enum Algorithm: "algorithm" {
        /// The convex problem itself: least TV(d), to a duality gap.
        #[default]
        Convex = "convex" => None,
        /// Algorithm 1 of Brokman et al. 2024: reweighted least squares of the subgradient.
        Paper = "paper" => Some(super::reweighted::reweighted),
        /// Least ∫|∇d|²: linear.
        Harmonic = "harmonic" => Some(super::quadratic::harmonic),
        /// Least ∫|Δd|²: linear, smooth at the handles.
        Biharmonic = "biharmonic" => Some(super::quadratic::biharmonic),
        /// As-rigid-as-possible surface modeling (Sorkine and Alexa 2007).
        AsRigidAsPossible = "arap" => Some(super::as_rigid_as_possible::as_rigid_as_possible),
    }
    /// How it is found for comparison; `None` for the convex problem, which a deformer solves.
    pub(super) fn comparison(self) -> Option<Comparison>;
}

/// Finds d (3, V), and tells in how many iterations.
type Comparison = fn(Task) -> Result<(Array2<f64>, usize)>;
