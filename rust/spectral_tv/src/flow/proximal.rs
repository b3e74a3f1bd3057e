//! Exact total-variation flow: every step is the proximal step of TV, certified by its gap.

use ndarray::Array2;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::increment::Precision;
use crate::flow::proximal_newton::ProximalNewton;
use crate::flow::recorder::{Recorder, Solution};
use crate::flow::time_step::{History, TimeStep};
use crate::flow::trajectory::Trajectory;
use crate::minimization::check_tolerance;
use crate::monitor::Stage;
use crate::operators::total_variation;

/// Runs the TV flow, all channels of `initial` (C, V) coupled, by backward Euler steps
/// u⁺ = argmin ½‖u − u_k‖²_M + Δt TV(u), each to a duality gap of `tolerance` relative to
/// Δt TV(u_k). Eigenfunctions then decay in a straight line down to extinction.
///
/// # Errors
/// As [`crate::flow::Stepping::run`], or for a tolerance not in (0, 1).
pub(crate) fn proximal_flow(
    operators: &Discretization,
    tolerance: f64,
    initial: Array2<f64>,
    times: &[f64],
    stage: Stage,
) -> Result<Trajectory> {
    check_tolerance(tolerance)?;
    let mut newton = ProximalNewton::new(operators, initial.nrows(), stage)?;
    let mut record = Recorder::new(operators, initial, times)?;
    for k in 0..times.len() - 1 {
        stage.report(k as f64 / (times.len() - 1) as f64)?;
        let dt = times[k + 1] - times[k];
        let history = History {
            state: record.state(),
            previous: None,
        };
        let step = TimeStep::backward_euler(&history, dt);
        let solution = match record.is_extinct() {
            true => Solution {
                state: step.data,
                precision: Precision::Double,
                gap: 0.0,
                tau: dt,
            },
            false => newton.solve(&step, record.last_total_variation(), tolerance, stage)?,
        };
        let variation = total_variation(operators.gradient(), solution.state.view());
        record.push(solution, variation);
    }
    stage.report(1.0)?;
    Ok(record.finish())
}
