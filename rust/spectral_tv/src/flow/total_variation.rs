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
#[derive(Debug, Clone, Copy)]
pub struct TotalVariation {
    variation: Variation,
}

impl TotalVariation {
    /// The law for a flow that starts at `initial` (C, V); ε is 1e-3 of its mean gradient.
    ///
    /// # Errors
    /// If `initial` is not a finite function on the mesh.
    pub fn starting_at(operators: &Discretization, initial: ArrayView2<f64>) -> Result<Self> {
        let mean = mean_gradient(operators, initial)?;
        let variation = Variation::smoothed(SMOOTHING * mean);
        Ok(Self { variation })
    }

    /// The same with edges that are `softness` > 0 as soft: w = max(1/√(|∇u|² + (σG)²), 1/G) for the
    /// softness σ and the mean gradient G of `initial`. TV flattens a region at once, and what lies
    /// between it and the next stretches; with a bounded weight regions end gradually, and no gradient
    /// grows far beyond G. The flow is not zero-homogeneous, so spectra are those of TV in shape only.
    ///
    /// # Errors
    /// As [`Self::starting_at`].
    pub fn with_soft_edges(
        operators: &Discretization,
        initial: ArrayView2<f64>,
        softness: f64,
    ) -> Result<Self> {
        let steepest = mean_gradient(operators, initial)?;
        let epsilon = softness * steepest;
        let variation = Variation { epsilon, steepest };
        Ok(Self { variation })
    }
}

/// The mean |∇u| of values (C, V); 1 for a constant, which any law keeps as it is.
fn mean_gradient(operators: &Discretization, values: ArrayView2<f64>) -> Result<f64> {
    operators.check_values(values)?;
    let mean = total_variation(operators.gradient(), values) / operators.area();
    Ok(if mean > 0.0 { mean } else { 1.0 })
}

impl Law for TotalVariation {
    fn weights(&self, gradient_norms: &[f64]) -> Vec<f64> {
        self.variation.weights(gradient_norms)
    }

    fn is_total_variation(&self) -> bool {
        self.variation.steepest.is_infinite()
    }
}
