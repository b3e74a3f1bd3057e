//! Total-variation flow: u_t ∈ −∂TV(u), all channels coupled.

use ndarray::ArrayView2;

use crate::error::Result;
use crate::flow::law::Law;
use crate::flow::proximal::duality_gap;
use crate::flow::time_step::TimeStep;
use crate::operators::{Discretization, total_variation};

/// ε relative to the mean |∇f|: small enough for edges to stay crisp, large enough for the
/// systems to stay well conditioned.
const SMOOTHING: f64 = 1e-3;

/// w = 1/√(|∇u|² + ε²): NETV for one channel (Brokman et al. 2024, Eq. 26), shape spectral TV
/// (M1, Eq. 33) for the three coordinates.
#[derive(Debug, Clone, Copy)]
pub struct TotalVariation {
    epsilon: f64,
}

impl TotalVariation {
    /// The law for a flow that starts at `initial` (C, V); ε is 1e-3 of its mean gradient.
    ///
    /// # Errors
    /// If `initial` is not a finite function on the mesh.
    pub fn starting_at(operators: &Discretization, initial: ArrayView2<f64>) -> Result<Self> {
        operators.check_values(initial)?;
        let mean = total_variation(operators.gradient(), initial) / operators.area();
        // A constant function has no gradient; any ε keeps it as it is.
        let epsilon = if mean > 0.0 { SMOOTHING * mean } else { 1.0 };
        Ok(Self { epsilon })
    }
}

impl Law for TotalVariation {
    fn weights(&self, squared_gradients: &[f64]) -> Vec<f64> {
        let square = self.epsilon * self.epsilon;
        squared_gradients
            .iter()
            .map(|norm| (norm + square).sqrt().recip())
            .collect()
    }

    fn is_total_variation(&self) -> bool {
        true
    }

    fn gap(
        &self,
        operators: &Discretization,
        step: &TimeStep,
        state: ArrayView2<f64>,
        weights: &[f64],
    ) -> f64 {
        let fields: Vec<_> = state
            .rows()
            .into_iter()
            .map(|channel| {
                let mut field = operators.gradient().apply(channel);
                for (vector, weight) in field.iter_mut().zip(weights) {
                    *vector = vector.map(|component| weight * component);
                }
                field
            })
            .collect();
        duality_gap(operators, step, state, &fields)
    }
}
