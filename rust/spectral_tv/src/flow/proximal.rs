//! Exact total-variation flow: every step is the proximal step of TV, certified by its gap.

use ndarray::{Array2, ArrayView2};

use crate::error::{Error, Result};
use crate::flow::proximal_newton::ProximalNewton;
use crate::flow::time_step::{History, TimeStep};
use crate::flow::trajectory::{Recorder, Solution, Trajectory};
use crate::monitor::Stage;
use crate::operators::{Discretization, FaceVector};

/// Runs the TV flow, all channels of `initial` (C, V) coupled, by backward Euler steps
/// u⁺ = argmin ½‖u − u_k‖²_M + Δt TV(u), each to a duality gap of `tolerance` relative to
/// Δt TV(u_k). Eigenfunctions then decay in a straight line down to extinction.
///
/// # Errors
/// As [`crate::flow::semi_implicit_flow`], or for a tolerance not in (0, 1).
pub fn proximal_flow(
    operators: &Discretization,
    tolerance: f64,
    initial: &Array2<f64>,
    times: &[f64],
    stage: Stage,
) -> Result<Trajectory> {
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(Error::Argument(format!(
            "tolerance must be between 0 and 1, not {tolerance}"
        )));
    }
    let mut record = Recorder::new(operators, initial.view(), times)?;
    let mut newton = ProximalNewton::new(operators, initial.nrows())?;
    for k in 0..times.len() - 1 {
        stage.report(k as f64 / (times.len() - 1) as f64)?;
        let dt = times[k + 1] - times[k];
        let history = History {
            state: record.state(k),
            previous: None,
        };
        let step = TimeStep::backward_euler(&history, dt);
        let solution = match record.is_extinct() {
            true => Solution {
                state: step.data,
                gap: 0.0,
                tau: dt,
            },
            false => newton.solve(&step, record.last_total_variation(), tolerance, stage)?,
        };
        record.push(&solution);
    }
    stage.report(1.0)?;
    Ok(record.finish())
}

/// Primal minus dual energy of the proximal problem at `state`, for the dual field that comes
/// of clipping `fields` (C × F vectors) face by face to |z| ≤ 1. Never negative; 0 at the
/// solution. Written as a sum of non-negative terms, so that it loses no digits.
pub(super) fn duality_gap(
    operators: &Discretization,
    step: &TimeStep,
    state: ArrayView2<f64>,
    fields: &[Vec<FaceVector>],
) -> f64 {
    let gradient = operators.gradient();
    let mut misalignment = gradient.squared_norms(state);
    misalignment
        .iter_mut()
        .for_each(|square| *square = square.sqrt());
    let clip = clipping_factors(fields);
    let mut distance = 0.0;
    for ((channel, data), field) in state.rows().into_iter().zip(step.data.rows()).zip(fields) {
        let dual = |face: usize| field[face].map(|component| clip[face] * component);
        for (face, product) in misalignment.iter_mut().enumerate() {
            let ([x, y], [p, q]) = (gradient.on_face(face, &channel), dual(face));
            *product -= x * p + y * q;
        }
        let divergence = gradient.adjoint(dual);
        for (vertex, mass) in operators.masses().iter().enumerate() {
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

/// min(1, 1/|z|) on every face, |z| over all channels together.
pub(super) fn clipping_factors(fields: &[Vec<FaceVector>]) -> Vec<f64> {
    let mut factors = vec![0.0; fields.first().map_or(0, Vec::len)];
    for field in fields {
        for (square, [x, y]) in factors.iter_mut().zip(field) {
            *square += x * x + y * y;
        }
    }
    for factor in &mut factors {
        *factor = if *factor > 1.0 {
            factor.sqrt().recip()
        } else {
            1.0
        };
    }
    factors
}
