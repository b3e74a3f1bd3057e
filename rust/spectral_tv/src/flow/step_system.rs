//! The linear systems of the steps of one flow, which share one pattern.

use std::borrow::Cow;

use ndarray::{Array2, ArrayView2};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::force::Force;
use crate::flow::increment::Precision;
use crate::flow::law::Law;
use crate::flow::means::Means;
use crate::flow::time_step::TimeStep;
use crate::monitor::Stage;
use crate::solver::{Demand, LinearSolver, Solver};

/// Shift of a component, relative to its largest increment, beyond which single precision has
/// left too few digits of the rest.
const LARGEST_SHIFT: f64 = 100.0;

/// Matrices M + τ L, and increments by them.
pub(super) struct StepSystem<'a> {
    pub operators: &'a Discretization,
    pub law: &'a dyn Law,
    pub stage: Stage<'a>,
    pub solver: LinearSolver,
    means: Means,
}

impl<'a> StepSystem<'a> {
    /// For the steps of `law`, solved by `solver` for what is demanded of each matrix.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], or [`crate::Error::Solver`] if memory does not suffice.
    pub fn new(
        operators: &'a Discretization,
        law: &'a dyn Law,
        solver: Solver,
        demand: Demand,
        stage: Stage<'a>,
    ) -> Result<Self> {
        let prepare = || {
            operators.prepare_edges(stage)?;
            stage.pass(|| Means::new(operators))
        };
        // An analysis has work for one thread for the most part.
        let (solver, means) = rayon::join(|| operators.solver(solver, demand, stage), prepare);
        Ok(Self {
            means: means?,
            solver: solver?,
            operators,
            law,
            stage,
        })
    }

    /// L(w) u with the law's weights at |∇u| = `norms`.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn force(&self, norms: Cow<[f64]>, state: ArrayView2<f64>) -> Result<Force> {
        Force::new(self.operators, self.law, norms, state, self.stage)
    }

    /// What increments by these systems are worth. Small parts beside large ones, as dust, would be moved
    /// by more than their size if they had units in common.
    pub fn precision(&self) -> Precision {
        match (self.solver.is_exact(), self.means.is_of_one_component()) {
            (true, _) => Precision::Double,
            (false, true) => Precision::Short,
            (false, false) => Precision::Single,
        }
    }

    /// The solution x for the `residual` at the state `start`, with the matrix at hand: within `tolerance`
    /// times itself, in the energy norm, where it is found by iteration. That starts from `guess`.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], or [`crate::Error::Solver`] if the matrix is not positive definite.
    pub fn increment(
        &mut self,
        residual: &Array2<f64>,
        (step, masses): (&TimeStep, &[f64]),
        start: ArrayView2<f64>,
        guess: Option<Array2<f64>>,
        tolerance: f64,
    ) -> Result<Array2<f64>> {
        let is_exact = self.solver.is_exact();
        let mut increment = self.solver.solve(residual, guess, tolerance, self.stage)?;
        let restored = || self.means.restore(&mut increment, step, masses, start);
        let shift = self.stage.pass(restored)?;
        if !is_exact && (shift.is_nan() || shift > LARGEST_SHIFT) {
            increment = self.solver.solve_exactly(residual, self.stage)?;
            self.means.restore(&mut increment, step, masses, start);
        }
        Ok(increment)
    }
}
