//! Total-variation flow: u_t ∈ −∂TV(u), all channels coupled.

use ndarray::ArrayView2;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::law::Law;
use crate::minimization::Variation;
use crate::operators::total_variation;

/// ε relative to the mean |∇f|: small enough for edges to stay crisp, large enough for the
/// systems to stay well conditioned.
const SMOOTHING: f64 = 1e-3;

/// w = 1/√(|∇u|² + ε²): NETV for one channel (Brokman et al. 2024, Eq. 20), shape spectral TV
/// (M1, Eq. 54) for the three coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TotalVariation {
    epsilon: f64,
}

impl Default for TotalVariation {
    /// The law for functions whose mean gradient is 1.
    fn default() -> Self {
        Self { epsilon: SMOOTHING }
    }
}

impl TotalVariation {
    /// The law for a flow that starts at `initial` (C, V); ε is 1e-3 of its mean gradient.
    ///
    /// # Errors
    /// If `initial` is not a finite function on the mesh.
    pub fn starting_at(
        mut self,
        operators: &Discretization,
        initial: ArrayView2<f64>,
    ) -> Result<Self> {
        operators.check_values(initial)?;
        let mean = total_variation(operators.gradient(), initial) / operators.area();
        // A constant function has no gradient; any ε keeps it as it is.
        if mean > 0.0 {
            self.epsilon *= mean;
        }
        Ok(self)
    }
}

impl Law for TotalVariation {
    fn weights(&self, gradient_norms: &[f64]) -> Vec<f64> {
        Variation::smoothed(self.epsilon).weights(gradient_norms)
    }

    fn is_total_variation(&self) -> bool {
        true
    }
}
