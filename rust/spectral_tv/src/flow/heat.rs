//! Heat flow: u_t = Δu, every weight 1.

use crate::flow::law::Law;

/// Linear diffusion on the fixed metric g₀ (Brokman et al. 2024, Eq. 12).
#[derive(Debug, Clone, Copy)]
pub struct Heat;

impl Law for Heat {
    fn weights(&self, gradient_norms: &[f64]) -> Vec<f64> {
        vec![1.0; gradient_norms.len()]
    }

    fn is_linear(&self) -> bool {
        true
    }
}
