//! Total-variation flow: u_t ∈ −∂TV(u), all channels coupled.

use ndarray::ArrayView2;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::law::Law;
use crate::minimization::Variation;

/// ε relative to the mean |∇f|: small enough for edges to stay crisp, large enough for the
/// systems to stay well conditioned.
const SMOOTHING: f64 = 1e-3;

/// w = 1/√(|∇u|² + ε²): NETV for one channel (Brokman et al. 2024, Eq. 20), shape spectral TV
/// (M1, Eq. 54) for the three coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TotalVariation {
    /// How soft edges are, σ from 0 to 1. 0: TV. Else w = max(1/√(|∇u|² + (σG)²), 1/G) for the mean
    /// gradient G of the initial function. TV flattens a region at once, and what lies between it and
    /// the next stretches. With a bounded weight regions fade along their rims, and no gradient grows
    /// far beyond G. That flow is not zero-homogeneous.
    pub soft_edges: f64,
    /// G.
    gradient: f64,
}

impl Default for TotalVariation {
    /// The law for functions whose mean gradient is 1.
    fn default() -> Self {
        Self {
            soft_edges: 0.0,
            gradient: 1.0,
        }
    }
}

impl TotalVariation {
    /// The law with edges that are so soft, for functions whose mean gradient is 1.
    pub fn with_soft_edges(soft_edges: f64) -> Self {
        Self {
            soft_edges,
            ..Self::default()
        }
    }

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
        let mean = operators.total_variation(initial) / operators.area();
        // A constant function has no gradient; any law keeps it as it is.
        if mean > 0.0 {
            self.gradient *= mean;
        }
        Ok(self)
    }
}

impl Law for TotalVariation {
    fn weigh(&self, gradient_norms: &mut [f64]) {
        let variation = match self.is_total_variation() {
            true => Variation::smoothed(SMOOTHING * self.gradient),
            false => Variation {
                epsilon: self.soft_edges * self.gradient,
                steepest: self.gradient,
            },
        };
        variation.weigh(gradient_norms);
    }

    fn is_total_variation(&self) -> bool {
        self.soft_edges == 0.0
    }
}
