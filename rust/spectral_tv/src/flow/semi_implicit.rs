//! Semi-implicit stepping: one linear system a step, the weights taken at a known state.

use std::borrow::Cow;

use ndarray::{Array2, ArrayView2, Zip};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::correction::correct;
use crate::flow::dual_steps::{DualStep, DualSteps};
use crate::flow::force::{Force, variation};
use crate::flow::law::Law;
use crate::flow::prediction::{predicted_gradients, predicted_increment, predicted_masses};
use crate::flow::recorder::{Recorder, Solution};
use crate::flow::step_system::StepSystem;
use crate::flow::time_step::{History, TimeStep};
use crate::flow::trajectory::Trajectory;
use crate::monitor::Stage;
use crate::operators::inner_product;
use crate::solver::{Demand, Solver};

/// Where a semi-implicit step takes its weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weights {
    /// At the last state, with backward Euler: the paper's step.
    Lagged,
    /// Extrapolated to the end of the step, with BDF2 and corrections by the same matrix: a sixth of the
    /// lagged error for a third more time. Steps of total variation of one channel are two iterations of
    /// Newton's method instead, each with a matrix of its own.
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

/// Growth of TV in a step that is put down to rounding.
const ROUNDING: f64 = 1e-12;
/// Error of a step's increment that an iterative solver leaves, relative to the increment, in the energy
/// norm. Bands are within 0.05 % of those by factorization, where the steps leave several percent.
const TOLERANCE: f64 = 1e-4;
/// The same of lagged steps of other flows than that of total variation: on a slender man M2's bands moved by 0.8 %
/// at 1e-4, and by 0.06 % here. What lies along a base takes over its errors.
const FINE_TOLERANCE: f64 = 3e-5;

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
    let flow = || recorded(operators, law, weights, initial, times, solver, stage);
    // On a thread of the pool that the solver shares its work with.
    rayon::scope(|_| Ok(flow()?.finish()))
}

/// The last state of [`semi_implicit_flow`], (C, V), which the increments kept may not add up to.
///
/// # Errors
/// As [`semi_implicit_flow`].
pub(super) fn semi_implicit_end(
    operators: &Discretization,
    law: &dyn Law,
    weights: Weights,
    initial: Array2<f64>,
    times: &[f64],
    solver: Solver,
    stage: Stage,
) -> Result<Array2<f64>> {
    let flow = || recorded(operators, law, weights, initial, times, solver, stage);
    rayon::scope(|_| Ok(flow()?.end()))
}

/// The flow with its last state.
fn recorded(
    operators: &Discretization,
    law: &dyn Law,
    weights: Weights,
    initial: Array2<f64>,
    times: &[f64],
    solver: Solver,
    stage: Stage,
) -> Result<Recorder> {
    let mut record = stage.pass(|| Recorder::of_unknowns(operators, initial, times))??;
    let mut steps = StepSolver::new(operators, law, weights, record.state(), solver, stage)?;
    for k in 0..times.len() - 1 {
        stage.report(k as f64 / (times.len() - 1) as f64)?;
        let (solution, next) = steps.step(&record, weights, times, k)?;
        record.push(solution, next.total_variation);
        steps.advance(next);
    }
    stage.report(1.0)?;
    Ok(record)
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

/// Takes the steps of one flow.
struct StepSolver<'a> {
    system: StepSystem<'a>,
    /// Where steps are taken by Newton's method.
    dual: Option<DualSteps>,
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
        let weights = if law.is_linear() {
            Weights::Lagged
        } else {
            weights
        };
        let channels = initial.nrows();
        let demand = weights.demand(channels);
        let is_dual = weights == Weights::Extrapolated && law.is_total_variation() && channels == 1;
        let system = StepSystem::new(operators, law, solver, demand, stage)?;
        let dual = match is_dual {
            true => Some(DualSteps::new(&system)?),
            false => None,
        };
        Ok(Self {
            system,
            dual,
            now: stage.pass(|| measured(operators, law, initial))?,
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
                .increments()
                .last()
                .map(|increment| (increment, times[k] - times[k - 1])),
        };
        let is_iterative = self.system.solver.is_iterative();
        let guess = || match is_iterative {
            true => predicted_increment(record.increments(), times, history.state.dim()),
            false => None,
        };
        if weights == Weights::Extrapolated {
            let (solution, next) = match self.dual.take() {
                None => self.extrapolated(&history, dt, guess)?,
                Some(dual) => self.by_newton(dual, &history, dt)?,
            };
            if next.total_variation <= self.now.total_variation * (1.0 + ROUNDING) {
                return Ok((solution, next));
            }
            // The extrapolation overshot an extinction; the lagged step never raises TV.
        }
        self.lagged(&history, dt, guess)
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
        guess: impl FnOnce() -> Option<Array2<f64>>,
    ) -> Result<(Solution, Measured<'a>)> {
        let stage = self.system.stage;
        let step = stage.pass(|| TimeStep::backward_euler(history, dt))?;
        let force = match self.now.force.take() {
            Some(force) => force,
            None => self.system.force((&self.now.norms).into(), history.state)?,
        };
        let masses = self.now.masses.clone();
        let tolerance = match self.system.law.is_total_variation() {
            true => TOLERANCE,
            false => FINE_TOLERANCE,
        };
        let (state, _) = self.solve(history, &step, force, &masses, guess, tolerance)?;
        self.certified(state, &step)
    }

    /// BDF2 by two iterations of Newton's method.
    fn by_newton(
        &mut self,
        mut dual: DualSteps,
        history: &History,
        dt: f64,
    ) -> Result<(Solution, Measured<'a>)> {
        let step = match history.usable(dt) {
            Some(usable) => TimeStep::bdf2(history.state, &usable, dt),
            None => TimeStep::backward_euler(history, dt),
        };
        let DualStep { state, norms, gap } = dual.solve(&mut self.system, &step)?;
        self.dual = Some(dual);
        let operators = self.system.operators;
        let next = Measured {
            total_variation: variation(operators, &norms),
            norms,
            masses: operators.masses().into(),
            force: None,
        };
        Ok((self.solution(state, gap, &step), next))
    }

    /// BDF2, masses or else weights predicted, and corrections.
    fn extrapolated(
        &mut self,
        history: &History,
        dt: f64,
        guess: impl FnOnce() -> Option<Array2<f64>>,
    ) -> Result<(Solution, Measured<'a>)> {
        let mut norms = None;
        let mut masses = self.now.masses.clone();
        let step = match (history.usable(dt), &self.before) {
            (Some(usable), Some((norms_before, masses_before))) => {
                let (now, growth) = (&self.now, usable.growth);
                match self.system.law.moves_masses() {
                    true => masses = predicted_masses(&masses, masses_before, growth).into(),
                    false => norms = Some(predicted_gradients(&now.norms, norms_before, growth)),
                }
                TimeStep::bdf2(history.state, &usable, dt)
            }
            _ => TimeStep::backward_euler(history, dt),
        };
        let weighing = norms.map_or((&self.now.norms).into(), Cow::Owned);
        let force = self.system.force(weighing, history.state)?;
        let (mut state, size) = self.solve(history, &step, force, &masses, guess, TOLERANCE)?;
        correct(&mut self.system, &step, &masses, size, &mut state)?;
        let (solution, mut next) = self.certified(state, &step)?;
        // The next step predicts its weights; memory is better spent otherwise.
        next.force = None;
        Ok((solution, next))
    }

    /// Solves (M + τ L(w)) u⁺ = M û, with L(w) of `force` and M of `masses`, for the increment
    /// u⁺ − u, of which `guess` makes a first guess: where the mesh lies in space then costs no
    /// digits. Returns u⁺ and the square of the increment's energy norm.
    fn solve(
        &mut self,
        history: &History,
        step: &TimeStep,
        mut force: Force,
        masses: &[f64],
        guess: impl FnOnce() -> Option<Array2<f64>>,
        tolerance: f64,
    ) -> Result<(Array2<f64>, f64)> {
        let (system, start) = (&mut self.system, history.state);
        let stage = system.stage;
        let couplings = std::mem::take(&mut force.couplings);
        system
            .solver
            .set_matrix(masses, couplings, step.tau, stage)?;
        let residual = stage.pass(|| force.residual(step, masses, start))?;
        let at = (step, masses);
        // Made no sooner: until here memory is needed otherwise.
        let guess = stage.pass(guess)?;
        let mut state = system.increment(&residual, at, start, guess, tolerance)?;
        let size = stage.pass(|| inner_product(residual.view(), state.view()))?;
        let add = |value: &mut f64, start: &f64| *value += start;
        stage.pass(|| Zip::from(&mut state).and(&start).par_for_each(add))?;
        Ok((state, size))
    }

    /// Measures a state and adds the duality gap of a TV step, for the dual field w ∇u.
    fn certified(
        &mut self,
        state: Array2<f64>,
        step: &TimeStep,
    ) -> Result<(Solution, Measured<'a>)> {
        self.system.solver.forget_matrix();
        let StepSystem {
            operators,
            law,
            stage,
            ..
        } = self.system;
        let mut next = stage.pass(|| measured(operators, law, state.view()))?;
        let mut gap = 0.0;
        if law.is_total_variation() {
            let force = self.system.force((&next.norms).into(), state.view())?;
            gap = stage.pass(|| force.gap(operators, step, &next.norms, state.view()))?;
            next.force = Some(force);
        }
        Ok((self.solution(state, gap, step), next))
    }

    fn solution(&self, state: Array2<f64>, gap: f64, step: &TimeStep) -> Solution {
        Solution {
            state,
            gap,
            tau: step.tau,
            precision: self.system.precision(),
        }
    }
}

/// Measures a `state`.
fn measured<'a>(
    operators: &'a Discretization,
    law: &dyn Law,
    state: ArrayView2<f64>,
) -> Measured<'a> {
    let norms = operators.gradient().norms(&state.into());
    let masses = law.masses(state);
    Measured {
        total_variation: variation(operators, &norms),
        norms,
        masses: masses.map_or(operators.masses().into(), Cow::Owned),
        force: None,
    }
}
