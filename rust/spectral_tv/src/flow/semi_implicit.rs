//! Semi-implicit stepping: one linear solve a step, the weights taken at a known state.

use ndarray::{Array2, ArrayView2};
use sprs::CsMatI;

use crate::error::Result;
use crate::flow::law::Law;
use crate::flow::time_step::{History, TimeStep};
use crate::flow::trajectory::{Recorder, Solution, Trajectory};
use crate::monitor::Stage;
use crate::operators::{Discretization, element_stiffness};
use crate::solver::Cholesky;

/// Where a semi-implicit step takes its weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weights {
    /// At the last state, with backward Euler: the paper's step.
    Lagged,
    /// At the state extrapolated to the end of the step, with BDF2: the same cost, about half
    /// the error.
    Extrapolated,
}

/// Growth of TV in a step that is put down to rounding.
const ROUNDING: f64 = 1e-12;

/// Runs `law` from `initial` (C, V) through `times`.
///
/// # Errors
/// If the times do not increase from 0, a value is not finite, a system cannot be solved, or
/// the monitor was cancelled.
pub fn semi_implicit_flow(
    operators: &Discretization,
    law: &dyn Law,
    weights: Weights,
    initial: &Array2<f64>,
    times: &[f64],
    stage: Stage,
) -> Result<Trajectory> {
    let mut record = Recorder::new(operators, initial.view(), times)?;
    let mut solver = StepSolver::new(operators, law)?;
    for k in 0..times.len() - 1 {
        stage.report(k as f64 / (times.len() - 1) as f64)?;
        let dt = times[k + 1] - times[k];
        let history = History {
            state: record.state(k),
            previous: (k > 0).then(|| (record.state(k - 1), times[k] - times[k - 1])),
        };
        let mut solution = match weights {
            Weights::Lagged => solver.lagged(&history, dt)?,
            Weights::Extrapolated => solver.extrapolated(&history, dt)?,
        };
        let bound = record.last_total_variation() * (1.0 + ROUNDING);
        if weights == Weights::Extrapolated && record.total_variation(&solution.state) > bound {
            // The extrapolation overshot an extinction; the lagged step never raises TV.
            solution = solver.lagged(&history, dt)?;
        }
        record.push(&solution);
    }
    stage.report(1.0)?;
    Ok(record.finish())
}

/// Solves the linear systems of one flow, all of one pattern.
struct StepSolver<'a> {
    operators: &'a Discretization,
    law: &'a dyn Law,
    system: CsMatI<f64, u32>,
    cholesky: Cholesky,
}

impl<'a> StepSolver<'a> {
    fn new(operators: &'a Discretization, law: &'a dyn Law) -> Result<Self> {
        let system = operators.pattern().zeros();
        let cholesky = Cholesky::analyse(&system)?;
        Ok(Self {
            operators,
            law,
            system,
            cholesky,
        })
    }

    /// Backward Euler with the weights of the last state.
    fn lagged(&mut self, history: &History, dt: f64) -> Result<Solution> {
        let step = TimeStep::backward_euler(history, dt);
        self.solve(history, &step, history.state)
    }

    /// BDF2 with the weights of the extrapolated state. The first step, which has no history,
    /// takes its weights from a lagged trial of itself.
    fn extrapolated(&mut self, history: &History, dt: f64) -> Result<Solution> {
        match (TimeStep::bdf2(history, dt), history.extrapolated(dt)) {
            (Some(step), Some(ahead)) => self.solve(history, &step, ahead.view()),
            _ => {
                let trial = self.lagged(history, dt)?;
                let step = TimeStep::backward_euler(history, dt);
                self.solve(history, &step, trial.state.view())
            }
        }
    }

    /// Solves (M + τ L(w)) u⁺ = M û, with w and M at `at`, for the increment u⁺ − u: where the
    /// mesh lies in space then costs no digits.
    fn solve(
        &mut self,
        history: &History,
        step: &TimeStep,
        at: ArrayView2<f64>,
    ) -> Result<Solution> {
        let gradient = self.operators.gradient();
        let weights = self.law.weights(&gradient.squared_norms(at));
        let current = self.law.masses(at);
        let masses = current.as_deref().unwrap_or(self.operators.masses());

        let stiffness = |face: usize| {
            let scale = step.tau * gradient.face_areas()[face] * weights[face];
            element_stiffness(&gradient.hats()[face], scale)
        };
        let pattern = self.operators.pattern();
        pattern.assemble(gradient, masses, stiffness, &mut self.system);
        self.cholesky.factorize(&self.system)?;

        let mut increment = &step.data - &history.state;
        for (mut row, channel) in increment.rows_mut().into_iter().zip(history.state.rows()) {
            let laplacian = gradient.weighted_laplacian(&weights, channel);
            for ((value, mass), curvature) in row.iter_mut().zip(masses).zip(laplacian) {
                *value = mass * *value - step.tau * curvature;
            }
        }
        self.cholesky.solve_in_place(&mut increment);
        let state = &history.state + &increment;
        let gap = self.law.gap(self.operators, step, state.view(), &weights);
        Ok(Solution {
            state,
            gap,
            tau: step.tau,
        })
    }
}
