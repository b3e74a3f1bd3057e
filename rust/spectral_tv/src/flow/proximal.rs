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
/// w⁺ = argmin ½‖w − w_k‖²_H + Δt TV(w) of its unknowns, each to a duality gap of `tolerance`
/// relative to Δt TV(w_k). Eigenfunctions then decay in a straight line down to extinction.
///
/// The steps go on from the unknowns; the values that are recorded for each state do not act back.
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
    let mut unknowns = operators.unknowns(record.state());
    for k in 0..times.len() - 1 {
        stage.report(k as f64 / (times.len() - 1) as f64)?;
        let dt = times[k + 1] - times[k];
        if record.is_extinct() {
            let state = record.state().to_owned();
            let solution = Solution {
                state,
                precision: Precision::Double,
                gap: 0.0,
                tau: dt,
            };
            let variation = record.last_total_variation();
            record.push(solution, variation);
            continue;
        }
        let history = History {
            state: unknowns.as_ref().map_or(record.state(), |w| w.view()),
            previous: None,
        };
        let step = TimeStep::backward_euler(&history, dt);
        let mut solution = newton.solve(&step, record.last_total_variation(), tolerance, stage)?;
        let variation = total_variation(operators.gradient(), solution.state.view());
        if let Some(unknowns) = &mut unknowns {
            unknowns.assign(&solution.state);
        }
        solution.state = operators.values(solution.state, record.state());
        record.push(solution, variation);
    }
    stage.report(1.0)?;
    Ok(record.finish())
}
