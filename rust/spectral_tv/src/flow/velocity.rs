//! p(u), the velocity −u_t that a law gives a state.

use ndarray::{Array2, ArrayView2, aview1};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::force::Force;
use crate::flow::law::Law;
use crate::monitor::Stage;

/// p(u) = M(u)⁻¹ L(w(u)) u at the state u (C, V) (Brokman et al. 2024, Eq. 49), (C, V).
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn velocity(
    operators: &Discretization,
    law: &dyn Law,
    state: ArrayView2<f64>,
    stage: Stage,
) -> Result<Array2<f64>> {
    let lanes = state.into();
    let norms = operators.gradient().norms(&lanes);
    let force = Force::new(operators, law, &norms, &lanes, stage)?;
    Ok(match law.masses(state) {
        Some(masses) => force.flux / aview1(&masses),
        None => force.flux / aview1(operators.masses()),
    })
}
