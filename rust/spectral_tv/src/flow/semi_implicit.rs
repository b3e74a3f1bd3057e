//! Semi-implicit stepping: one linear system a step, the weights taken at a known state.

use ndarray::{Array2, ArrayView2};

use crate::error::Result;
use crate::flow::duality_gap::duality_gap;
use crate::flow::law::Law;
use crate::flow::prediction::{predicted_gradients, predicted_increment, predicted_masses};
use crate::flow::time_step::{History, TimeStep};
use crate::flow::trajectory::{Recorder, Solution, Trajectory};
use crate::minimization::Energy;
use crate::monitor::Stage;
use crate::operators::{Discretization, element_stiffness};
use crate::solver::{LinearSolver, Solver};

/// Where a semi-implicit step takes its weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weights {
    /// At the last state, with backward Euler: the paper's step.
    Lagged,
    /// Extrapolated to the end of the step, with BDF2 and one correction by the same
    /// matrix: a sixth of the lagged error for a third more time.
    Extrapolated,
}

/// Growth of TV in a step that is put down to rounding.
const ROUNDING: f64 = 1e-12;
/// Error of a step's increment that an iterative solver leaves, relative to the increment, in
/// the energy norm.
const TOLERANCE: f64 = 2e-6;

/// Runs `law` from `initial` (C, V) through `times`, its systems solved by `solver`.
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
    solver: Solver,
    stage: Stage,
) -> Result<Trajectory> {
    // On a thread of the pool that the solver shares its work with.
    rayon::scope(|_| {
        let mut record = Recorder::new(operators, initial.view(), times)?;
        let mut steps = StepSolver::new(operators, law, solver, stage)?;
        for k in 0..times.len() - 1 {
            stage.report(k as f64 / (times.len() - 1) as f64)?;
            let solution = steps.step(&record, weights, times, k)?;
            record.push(&solution);
        }
        stage.report(1.0)?;
        Ok(record.finish())
    })
}

/// Takes the steps of one flow; their systems share one pattern.
struct StepSolver<'a> {
    operators: &'a Discretization,
    law: &'a dyn Law,
    solver: LinearSolver,
    stage: Stage<'a>,
}

impl<'a> StepSolver<'a> {
    fn new(
        operators: &'a Discretization,
        law: &'a dyn Law,
        solver: Solver,
        stage: Stage<'a>,
    ) -> Result<Self> {
        Ok(Self {
            operators,
            law,
            solver: LinearSolver::new(operators.pattern().zeros(), solver, stage)?,
            stage,
        })
    }

    /// The step from t_k to t_{k+1}.
    fn step(
        &mut self,
        record: &Recorder,
        weights: Weights,
        times: &[f64],
        k: usize,
    ) -> Result<Solution> {
        let dt = times[k + 1] - times[k];
        let history = History {
            state: record.state(k),
            previous: (k > 0).then(|| (record.state(k - 1), times[k] - times[k - 1])),
        };
        let guess = predicted_increment(|k| record.state(k), times, k);
        if weights == Weights::Extrapolated {
            let solution = self.extrapolated(&history, dt, guess.as_ref())?;
            let bound = record.last_total_variation() * (1.0 + ROUNDING);
            if record.total_variation(&solution.state) <= bound {
                return Ok(solution);
            }
            // The extrapolation overshot an extinction; the lagged step never raises TV.
        }
        self.lagged(&history, dt, guess.as_ref())
    }

    /// Backward Euler with the weights of the last state.
    fn lagged(
        &mut self,
        history: &History,
        dt: f64,
        guess: Option<&Array2<f64>>,
    ) -> Result<Solution> {
        let step = TimeStep::backward_euler(history, dt);
        let norms = self.operators.gradient().norms(history.state);
        let masses = self.masses(history.state);
        let state = self.solve(history, &step, &norms, &masses, guess)?;
        Ok(self.certified(state, &step))
    }

    /// BDF2, masses or else weights predicted, and one correction.
    fn extrapolated(
        &mut self,
        history: &History,
        dt: f64,
        guess: Option<&Array2<f64>>,
    ) -> Result<Solution> {
        let gradient = self.operators.gradient();
        let mut norms = gradient.norms(history.state);
        let mut masses = self.masses(history.state);
        let mut step = TimeStep::backward_euler(history, dt);
        if let (Some(bdf2), Some((previous, growth))) =
            (TimeStep::bdf2(history, dt), history.usable(dt))
        {
            step = bdf2;
            match self.law.masses(previous) {
                Some(before) => masses = predicted_masses(&masses, &before, growth),
                None => norms = predicted_gradients(&norms, &gradient.norms(previous), growth),
            }
        }
        let mut state = self.solve(history, &step, &norms, &masses, guess)?;
        if !self.law.is_linear() {
            self.correct(&step, &masses, &mut state)?;
        }
        Ok(self.certified(state, &step))
    }

    /// M at `state`, of the current shape where the law says so.
    fn masses(&self, state: ArrayView2<f64>) -> Vec<f64> {
        let current = self.law.masses(state);
        current.unwrap_or_else(|| self.operators.masses().to_vec())
    }

    /// Solves (M + τ L(w)) u⁺ = M û, with w from `norms` and M of `masses`, for the increment
    /// u⁺ − u, of which `guess` is a first guess: where the mesh lies in space then costs no
    /// digits.
    fn solve(
        &mut self,
        history: &History,
        step: &TimeStep,
        norms: &[f64],
        masses: &[f64],
        guess: Option<&Array2<f64>>,
    ) -> Result<Array2<f64>> {
        let gradient = self.operators.gradient();
        let weights = self.law.weights(norms);
        let stiffness = |face: usize| {
            let scale = step.tau * gradient.face_areas()[face] * weights[face];
            element_stiffness(&gradient.hats()[face], scale)
        };
        let pattern = self.operators.pattern();
        let assemble = |system: &mut _| pattern.assemble(gradient, masses, stiffness, system);
        self.solver.set_matrix(masses, assemble, self.stage)?;

        let mut increment = &step.data - &history.state;
        for (mut row, channel) in increment.rows_mut().into_iter().zip(history.state.rows()) {
            let laplacian = gradient.weighted_laplacian(&weights, channel);
            for ((value, mass), curvature) in row.iter_mut().zip(masses).zip(laplacian) {
                *value = mass * *value - step.tau * curvature;
            }
        }
        let increment = self.solver.solve(increment, guess, TOLERANCE, self.stage)?;
        Ok(increment + history.state)
    }

    /// One descent step on the energy of the time step, preconditioned by the matrix at hand,
    /// with the best step length.
    fn correct(&mut self, step: &TimeStep, masses: &[f64], state: &mut Array2<f64>) -> Result<()> {
        let energy = Energy {
            operators: self.operators,
            weights: &|norms| self.law.weights(norms),
            least_weight: 0.0,
            masses,
            data: &step.data,
            tau: step.tau,
            fixed: &[],
        };
        let slope = energy.slope(state.view());
        let descent = energy.descent(state.view(), &slope);
        let direction = self
            .solver
            .solve(descent.clone(), None, TOLERANCE, self.stage)?;
        let length = energy.line_search(&slope, &direction, &descent);
        state.scaled_add(length, &direction);
        Ok(())
    }

    /// Adds the duality gap of a TV step, for the dual field w ∇u.
    fn certified(&self, state: Array2<f64>, step: &TimeStep) -> Solution {
        let mut gap = 0.0;
        if self.law.is_total_variation() {
            let energy = Energy {
                operators: self.operators,
                weights: &|norms| self.law.weights(norms),
                least_weight: 0.0,
                masses: self.operators.masses(),
                data: &step.data,
                tau: step.tau,
                fixed: &[],
            };
            let fluxes = energy.slope(state.view()).fluxes();
            gap = duality_gap(self.operators, step, state.view(), &fluxes);
        }
        Solution {
            state,
            gap,
            tau: step.tau,
        }
    }
}
