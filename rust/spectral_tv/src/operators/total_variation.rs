//! TV(u) = Σ_f A_f |∇u|_f, over all channels together.

use ndarray::ArrayView2;

use crate::operators::Gradient;

/// The total variation of `values` (C, V) in the metric of `gradient`, unit of the values × length:
/// NETV for one channel, VNETV for several (Brokman et al. 2024, Eqs. 13 and 54).
pub fn total_variation(gradient: &Gradient, values: ArrayView2<f64>) -> f64 {
    gradient
        .norms(&values.into())
        .iter()
        .zip(gradient.face_areas())
        .map(|(norm, area)| area * norm)
        .sum()
}
