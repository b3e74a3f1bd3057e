//! Heat flow: u_t = Δu, every weight 1.

use crate::flow::law::Law;

/// Linear diffusion on the fixed metric g₀ (Brokman et al. 2024, Eq. 12).
#[derive(Debug, Clone, Copy)]
pub struct Heat;

impl Law for Heat {
    fn weigh(&self, gradient_norms: &mut [f64]) {
        gradient_norms.fill(1.0);
    }

    fn is_linear(&self) -> bool {
        true
    }
}
