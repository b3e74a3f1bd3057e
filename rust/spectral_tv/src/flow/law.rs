//! The law of a flow, u_t = −M(u)⁻¹ L(w(u)) u: its weights w and its masses M.

use ndarray::ArrayView2;

use crate::parallel;

/// The law of a diffusion whose face weights depend on the size of the gradient alone.
pub trait Law: Sync {
    /// Replaces n = |∇u| of some faces, over all channels, in the metric g₀, by their weights w.
    /// n w(n) must not fall as n grows: a step then minimises a convex energy.
    fn weigh(&self, gradient_norms: &mut [f64]);

    /// The weights of all faces.
    fn weights(&self, gradient_norms: &[f64]) -> Vec<f64> {
        parallel::changed(gradient_norms, |norms| self.weigh(norms))
    }

    /// Whether the weights are constants.
    fn is_linear(&self) -> bool {
        false
    }

    /// Whether the flow descends TV in the metric g₀, so that its steps can be taken exactly
    /// and have a duality gap.
    fn is_total_variation(&self) -> bool {
        false
    }

    /// Whether the masses are not those of g₀.
    fn moves_masses(&self) -> bool {
        false
    }

    /// The vertex masses at the state `values` (C, V), where they are not those of g₀.
    fn masses(&self, _values: ArrayView2<f64>) -> Option<Vec<f64>> {
        None
    }
}
