//! The certificate of a proximal step of TV: its duality gap.

use ndarray::{Array1, ArrayView2};

use crate::discretization::Discretization;
use crate::flow::time_step::TimeStep;
use crate::minimization::{TangentField, clipping_factors};

/// Primal minus dual energy of min ½‖u − û‖²_H + τ TV(u) at `state`, for the dual field that
/// comes of clipping `field` face by face to |z| ≤ 1. Never negative; 0 at the
/// solution. Written as a sum of non-negative terms, so that it loses no digits.
pub(super) fn duality_gap(
    operators: &Discretization,
    step: &TimeStep,
    state: ArrayView2<f64>,
    field: &TangentField,
) -> f64 {
    let (gradient, mass) = (operators.gradient(), operators.mass());
    let mut misalignment = gradient.norms(&state.into());
    let clip = clipping_factors(field);
    let mut distance = 0.0;
    for ((channel, data), field) in state.rows().into_iter().zip(step.data.rows()).zip(field) {
        let dual = |face: usize| field[face].map(|component| clip[face] * component);
        for (face, product) in misalignment.iter_mut().enumerate() {
            let ([x, y], [p, q]) = (gradient.on_face(face, &channel), dual(face));
            *product -= x * p + y * q;
        }
        let divergence = gradient.adjoint(dual);
        if !mass.is_lumped() {
            // ½ τ² ⟨q, H⁻¹ q⟩ and what goes with it, q = Gᵀ A z; see `Mass` for the bound.
            let mut residual = &channel - &data;
            mass.apply(residual.view_mut());
            residual.scaled_add(step.tau, &Array1::from(divergence));
            distance += 0.5 * mass.inverse_squared_norm(&residual.to_vec());
            continue;
        }
        for (vertex, mass) in mass.diagonal().iter().enumerate() {
            let off = channel[vertex] - data[vertex] + step.tau * divergence[vertex] / mass;
            distance += 0.5 * mass * off * off;
        }
    }
    let misaligned: f64 = misalignment
        .iter()
        .zip(gradient.face_areas())
        .map(|(product, area)| area * product.max(0.0))
        .sum();
    distance + step.tau * misaligned
}
