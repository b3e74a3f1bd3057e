//! Semi-implicit stepping: one linear system a step, the weights taken at a known state.

use std::borrow::Cow;

use ndarray::{Array2, ArrayView2, Zip};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::force::{Force, variation};
use crate::flow::increment::Precision;
use crate::flow::law::Law;
use crate::flow::line::Line;
use crate::flow::means::Means;
use crate::flow::prediction::{predicted_gradients, predicted_increment, predicted_masses};
use crate::flow::recorder::{Recorder, Solution};
use crate::flow::time_step::{History, TimeStep};
use crate::flow::trajectory::Trajectory;
use crate::minimization::least_along;
use crate::monitor::Stage;
use crate::operators::{SideBySide, inner_product, squared_norm};
use crate::solver::{Demand, LinearSolver, Solver};

/// Where a semi-implicit step takes its weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weights {
    /// At the last state, with backward Euler: the paper's step.
    Lagged,
    /// Extrapolated to the end of the step, with BDF2 and one correction by the same
    /// matrix: a sixth of the lagged error for a third more time.
    Extrapolated,
}

impl Weights {
    /// What a flow of so many channels takes each matrix for.
    pub(crate) fn demand(self, channels: usize) -> Demand {
        let solutions = match self {
            Self::Lagged => 1,
            Self::Extrapolated => 2,
        };
        Demand {
            solutions,
            channels,
        }
    }
}

/// Shift of a component, relative to its largest increment, beyond which single precision has
/// left too few digits of the rest.
const LARGEST_SHIFT: f64 = 100.0;
/// Growth of TV in a step that is put down to rounding.
const ROUNDING: f64 = 1e-12;
/// Error of a step's increment that an iterative solver leaves, relative to the increment, in
/// the energy norm. States then are within 1e-6 of the object's size.
const TOLERANCE: f64 = 3e-6;
/// The same for flows that magnify errors: where masses collapse, and single functions, whose
/// gradients have no other channel to vanish with.
const FINE_TOLERANCE: f64 = 1e-6;

/// Runs `law` from `initial` (C, V) through `times`, its systems solved by `solver`.
///
/// # Errors
/// If the times do not increase from 0, a value is not finite, a system cannot be solved, or
/// the monitor was cancelled.
pub fn semi_implicit_flow(
    operators: &Discretization,
    law: &dyn Law,
    weights: Weights,
    initial: Array2<f64>,
    times: &[f64],
    solver: Solver,
    stage: Stage,
) -> Result<Trajectory> {
    // On a thread of the pool that the solver shares its work with.
    rayon::scope(|_| {
        let mut record = stage.pass(|| Recorder::new(operators, initial, times))??;
        let mut steps = StepSolver::new(operators, law, weights, record.state(), solver, stage)?;
        for k in 0..times.len() - 1 {
            stage.report(k as f64 / (times.len() - 1) as f64)?;
            let (solution, next) = steps.step(&record, weights, times, k)?;
            record.push(solution, next.total_variation);
            steps.advance(next);
        }
        stage.report(1.0)?;
        Ok(record.finish())
    })
}

/// What is known of a state.
struct Measured<'a> {
    /// |∇u| on every face.
    norms: Vec<f64>,
    total_variation: f64,
    /// M, of the current shape where the law says so.
    masses: Cow<'a, [f64]>,
    /// L(w) u for the law's weights at u, where it was needed already.
    force: Option<Force>,
}

/// Takes the steps of one flow; their systems share one pattern.
struct StepSolver<'a> {
    operators: &'a Discretization,
    law: &'a dyn Law,
    means: Means,
    solver: LinearSolver,
    tolerance: f64,
    stage: Stage<'a>,
    now: Measured<'a>,
    /// Norms and masses of the state before.
    before: Option<(Vec<f64>, Cow<'a, [f64]>)>,
}

impl<'a> StepSolver<'a> {
    fn new(
        operators: &'a Discretization,
        law: &'a dyn Law,
        weights: Weights,
        initial: ArrayView2<f64>,
        solver: Solver,
        stage: Stage<'a>,
    ) -> Result<Self> {
        operators.prepare_edges(stage)?;
        let weights = if law.is_linear() {
            Weights::Lagged
        } else {
            weights
        };
        let demand = weights.demand(initial.nrows());
        let magnifies = law.moves_masses() || initial.nrows() == 1;
        Ok(Self {
            tolerance: if magnifies { FINE_TOLERANCE } else { TOLERANCE },
            now: stage.pass(|| measured(operators, law, initial, &initial.into()))?,
            means: stage.pass(|| Means::new(operators))?,
            operators,
            law,
            solver: operators.solver(solver, demand, stage)?,
            stage,
            before: None,
        })
    }

    /// The step from t_k to t_{k+1}.
    fn step(
        &mut self,
        record: &Recorder,
        weights: Weights,
        times: &[f64],
        k: usize,
    ) -> Result<(Solution, Measured<'a>)> {
        let dt = times[k + 1] - times[k];
        let history = History {
            state: record.state(),
            previous: record
                .previous()
                .map(|previous| (previous, times[k] - times[k - 1])),
        };
        let is_iterative = self.solver.is_iterative();
        let guess = || match is_iterative {
            true => predicted_increment(record.increments(), times, history.state.dim()),
            false => None,
        };
        if weights == Weights::Extrapolated {
            let (solution, next) = self.extrapolated(&history, dt, guess())?;
            if next.total_variation <= self.now.total_variation * (1.0 + ROUNDING) {
                return Ok((solution, next));
            }
            // The extrapolation overshot an extinction; the lagged step never raises TV.
        }
        self.lagged(&history, dt, guess())
    }

    /// Goes on from the state that is measured by `next`.
    fn advance(&mut self, next: Measured<'a>) {
        let now = std::mem::replace(&mut self.now, next);
        self.before = Some((now.norms, now.masses));
    }

    /// Backward Euler with the weights of the last state.
    fn lagged(
        &mut self,
        history: &History,
        dt: f64,
        guess: Option<Array2<f64>>,
    ) -> Result<(Solution, Measured<'a>)> {
        let step = self.stage.pass(|| TimeStep::backward_euler(history, dt))?;
        let force = match self.now.force.take() {
            Some(force) => force,
            None => self.force(&self.now.norms, &history.state.into())?,
        };
        let masses = self.now.masses.clone();
        let state = self.solve(history, &step, force, &masses, guess)?;
        self.certified(state, &step)
    }

    /// BDF2, masses or else weights predicted, and one correction.
    fn extrapolated(
        &mut self,
        history: &History,
        dt: f64,
        guess: Option<Array2<f64>>,
    ) -> Result<(Solution, Measured<'a>)> {
        let mut norms = None;
        let mut masses = self.now.masses.clone();
        let step = match (history.usable(dt), &self.before) {
            (Some(usable), Some((norms_before, masses_before))) => {
                let (now, growth) = (&self.now, usable.growth);
                match self.law.moves_masses() {
                    true => masses = predicted_masses(&masses, masses_before, growth).into(),
                    false => norms = Some(predicted_gradients(&now.norms, norms_before, growth)),
                }
                TimeStep::bdf2(history.state, &usable, dt)
            }
            _ => TimeStep::backward_euler(history, dt),
        };
        let weighing = norms.as_deref().unwrap_or(&self.now.norms);
        let force = self.force(weighing, &history.state.into())?;
        drop(norms);
        let mut state = self.solve(history, &step, force, &masses, guess)?;
        if !self.law.is_linear() {
            self.correct(&step, &masses, &mut state)?;
        }
        let (solution, mut next) = self.certified(state, &step)?;
        // The next step predicts its weights; memory is better spent otherwise.
        next.force = None;
        Ok((solution, next))
    }

    /// Solves (M + τ L(w)) u⁺ = M û, with L(w) of `force` and M of `masses`, for the increment
    /// u⁺ − u, of which `guess` is a first guess: where the mesh lies in space then costs no
    /// digits.
    fn solve(
        &mut self,
        history: &History,
        step: &TimeStep,
        force: Force,
        masses: &[f64],
        guess: Option<Array2<f64>>,
    ) -> Result<Array2<f64>> {
        self.solver
            .set_matrix(masses, &force.couplings, step.tau, self.stage)?;
        let stage = self.stage;
        let residual = stage.pass(|| force.residual(step, masses, history.state))?;
        let mut state = self.increment(&residual, step, masses, history.state, guess)?;
        let add = |value: &mut f64, start: &f64| *value += start;
        stage.pass(|| Zip::from(&mut state).and(&history.state).par_for_each(add))?;
        Ok(state)
    }

    /// The solution for the `residual` at `start`, with the matrix at hand.
    fn increment(
        &mut self,
        residual: &Array2<f64>,
        step: &TimeStep,
        masses: &[f64],
        start: ArrayView2<f64>,
        guess: Option<Array2<f64>>,
    ) -> Result<Array2<f64>> {
        let is_exact = self.solver.is_exact();
        let (guess, tolerance) = (guess.as_ref(), self.tolerance);
        let mut increment = self.solver.solve(residual, guess, tolerance, self.stage)?;
        let restored = || self.means.restore(&mut increment, step, masses, start);
        let shift = self.stage.pass(restored)?;
        if !is_exact && (shift.is_nan() || shift > LARGEST_SHIFT) {
            increment = self.solver.solve_exactly(residual, self.stage)?;
            self.means.restore(&mut increment, step, masses, start);
        }
        Ok(increment)
    }

    /// One descent step on the energy of the time step, preconditioned by the matrix at hand,
    /// with the best step length.
    fn correct(&mut self, step: &TimeStep, masses: &[f64], state: &mut Array2<f64>) -> Result<()> {
        let (stage, law, gradient) = (self.stage, self.law, self.operators.gradient());
        let lanes = stage.pass(|| SideBySide::from(state.view()))?;
        let norms = stage.pass(|| gradient.norms(&lanes))?;
        let mut force = self.force(&norms, &lanes)?;
        let weights = std::mem::take(&mut force.weights);
        let descent = stage.pass(|| force.residual(step, masses, state.view()))?;
        let direction = self.increment(&descent, step, masses, state.view(), None)?;
        let start = stage.pass(|| -inner_product(descent.view(), direction.view()))?;
        drop(descent);
        let direction_lanes = stage.pass(|| direction.view().into())?;
        let line = stage.pass(|| Line::new(law, gradient, norms, &lanes, &direction_lanes))?;
        drop((lanes, direction_lanes));
        let quadratic = stage.pass(|| squared_norm(direction.view(), masses))?;
        let linear = start - step.tau * stage.pass(|| line.slope_at_start(&weights))?;
        drop(weights);
        let slope = |alpha: f64| linear + alpha * quadratic + step.tau * line.slope(alpha);
        let length = stage.pass(|| least_along(start, slope))?;
        let advance = |value: &mut f64, direction: &f64| *value += length * direction;
        stage.pass(|| Zip::from(state).and(&direction).par_for_each(advance))
    }

    fn force(&self, norms: &[f64], state: &SideBySide) -> Result<Force> {
        Force::new(self.operators, self.law, norms, state, self.stage)
    }

    /// Measures a state and adds the duality gap of a TV step, for the dual field w ∇u.
    fn certified(&self, state: Array2<f64>, step: &TimeStep) -> Result<(Solution, Measured<'a>)> {
        let lanes = state.view().into();
        let measured = || measured(self.operators, self.law, state.view(), &lanes);
        let mut next = self.stage.pass(measured)?;
        let mut gap = 0.0;
        if self.law.is_total_variation() {
            let force = self.force(&next.norms, &lanes)?;
            let found = || force.gap(self.operators, step, &next.norms, state.view());
            gap = self.stage.pass(found)?;
            next.force = Some(force);
        }
        let solution = Solution {
            state,
            gap,
            tau: step.tau,
            precision: match self.solver.is_exact() {
                true => Precision::Double,
                false => Precision::Single,
            },
        };
        Ok((solution, next))
    }
}

/// Measures a `state`, whose channels are side by side in `lanes`.
fn measured<'a>(
    operators: &'a Discretization,
    law: &dyn Law,
    state: ArrayView2<f64>,
    lanes: &SideBySide,
) -> Measured<'a> {
    let norms = operators.gradient().norms(lanes);
    let masses = law.masses(state);
    Measured {
        total_variation: variation(operators, &norms),
        norms,
        masses: masses.map_or(operators.masses().into(), Cow::Owned),
        force: None,
    }
}
