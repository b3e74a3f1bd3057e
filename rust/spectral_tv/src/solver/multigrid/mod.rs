//! Conjugate gradients preconditioned by algebraic multigrid, in single precision.
//!
//! The systems are K = M + τ L(w). Their pattern stays, and their values change from step to step.
//! So orders, clusters, patterns and maps are computed once, and a new matrix only sends its values
//! through them. Vertices are clustered anew if convergence has suffered. The method is smoothed
//! aggregation (Vaněk, Mandel and Brezina 1996) with sparse prolongations and symmetric
//! Gauss–Seidel. Single precision is enough if the solution is an increment: the solution has a
//! relative error of 2e-6, and it is a fraction of the state.
//!
//! Crates with such solvers exist (`scirs2-sparse`, `nalgebra-sparse-linalg`, `numr`). They are
//! general: they set up in double precision, for each matrix anew, and solve for one vector at a
//! time. Here all steps share the set-up, and three channels travel in one register. A step costs
//! memory traffic, and single precision halves it. Hence an implementation of our own.

mod aggregation;
mod coarsest;
#[cfg(test)]
mod examples;
mod galerkin;
mod galerkin_pattern;
mod hierarchy;
mod matrix;
mod ordering;
mod pcg;
mod prolongation;
mod smoother;
mod system;
#[cfg(test)]
mod tests;
mod v_cycle;

use std::sync::Arc;

use ndarray::{Array2, ArrayView2, Axis};

use crate::error::{Error, Result};
use crate::graph::Graph;
use crate::monitor::Stage;
use crate::parallel;
use hierarchy::Hierarchy;
use ordering::Ordering;
use pcg::{Iteration, Report};

/// Iterations after which the clusters are taken to be unfit, and those after which new ones
/// are, too.
const MOST_ITERATIONS: usize = 60;
/// Iterations beyond those right after clustering that are borne before clustering anew, both
/// counted for a fixed gain.
const MOST_EXTRA_ITERATIONS: f64 = 4.0;
/// And those beyond the ones with up-to-date coarse levels before these follow every matrix,
/// which costs about two iterations.
const MOST_OUTDATED_ITERATIONS: f64 = 1.0;
/// Iterations beyond those right after clustering that make a solution start anew with new
/// clusters, which cost about eight.
const MOST_WASTED_ITERATIONS: f64 = 12.0;
/// That gain: six digits.
const GAIN: f64 = 1e-6;
/// Unknowns from which the vectors of iterations are given back after each solution. Others use that
/// memory in between, and to have it again costs little: the system takes large arrays back anyway.
const LARGE: usize = 1 << 19;

/// A solver for symmetric positive definite matrices of one pattern.
pub struct Multigrid {
    ordering: Ordering,
    hierarchy: Hierarchy,
    /// What the matrix was divided by.
    scale: f64,
    coarse_levels: CoarseLevels,
    upkeep: Upkeep,
    /// Iterations for [`GAIN`] right after the vertices were clustered.
    iterations_when_fresh: Option<f64>,
    /// Matrices that the clusters have served, and after which they are renewed unasked: where
    /// weights change from step to step, clusters that failed soon will do so again.
    age: usize,
    lifetime: usize,
    single: Option<Iteration<1>>,
    quadruple: Option<Iteration<4>>,
}

/// How the coarse levels serve the matrix at hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CoarseLevels {
    /// There are none, or none that would serve it.
    Unset,
    /// They are those of an earlier matrix.
    Outdated,
    /// They are its own.
    Current,
    /// They are its own, but the clusters no longer fit.
    Unfit,
}

/// When coarse levels are brought up to date.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Upkeep {
    /// When the vertices are clustered. Then a solution took so many iterations for [`GAIN`].
    WithClusters { iterations: f64 },
    /// With every matrix: where they had to be once, they will have to be again.
    WithMatrices,
}

impl CoarseLevels {
    fn are_current(self) -> bool {
        matches!(self, Self::Current | Self::Unfit)
    }
}

impl Multigrid {
    /// Analyses the `graph` of the matrices to come.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub(crate) fn analyse(graph: Arc<Graph>, stage: Stage) -> Result<Self> {
        let ordering = Ordering::breadth_first(graph, stage)?;
        let matrix = system::pattern(&ordering, stage)?;
        Ok(Self {
            ordering,
            hierarchy: Hierarchy::unset(matrix),
            scale: 1.0,
            coarse_levels: CoarseLevels::Unset,
            upkeep: Upkeep::WithClusters { iterations: 0.0 },
            iterations_when_fresh: None,
            age: 0,
            lifetime: usize::MAX,
            single: None,
            quadruple: None,
        })
    }

    /// Takes the matrix diag(`masses`) + `tau` L, where L has the off-diagonal entries −`couplings` and
    /// rows that sum to 0.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if the matrix is not positive definite.
    pub fn set_matrix(
        &mut self,
        masses: &[f64],
        (couplings, tau): (&[f64], f64),
        stage: Stage,
    ) -> Result<()> {
        let finest = &mut self.hierarchy.levels[0].matrix;
        let (ordering, values) = (&self.ordering, (couplings, tau));
        self.scale = stage.pass(|| system::refresh(finest, ordering, masses, values))?;
        let levels = self.coarse_levels;
        let must_coarsen = matches!(levels, CoarseLevels::Unset | CoarseLevels::Unfit);
        if must_coarsen || self.age >= self.lifetime {
            return self.coarsen(stage);
        }
        self.age += 1;
        if self.upkeep == Upkeep::WithMatrices {
            self.coarse_levels = CoarseLevels::Current;
            return self.hierarchy.refresh(stage);
        }
        self.coarse_levels = CoarseLevels::Outdated;
        self.hierarchy.refresh_finest()
    }

    /// Solves K x = b for every row b of `right_hand_sides` (C, V), from the rows of `guess` if
    /// given, until the error is `tolerance` times x in the energy norm.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if the iteration does not converge.
    pub fn solve(
        &mut self,
        right_hand_sides: ArrayView2<f64>,
        mut guess: Option<Array2<f64>>,
        tolerance: f64,
        stage: Stage,
    ) -> Result<Array2<f64>> {
        let mut solutions = parallel::zeros(right_hand_sides.dim());
        for (block, rows) in right_hand_sides.axis_chunks_iter(Axis(0), 4).enumerate() {
            let first = 4 * block;
            let is_last = first + rows.nrows() == right_hand_sides.nrows();
            let problem = Problem {
                rows,
                guess: match is_last {
                    true => Guess::Last(first, guess.take()),
                    false => Guess::Rows(first, guess.as_ref()),
                },
                tolerance,
                stage,
            };
            match rows.nrows() {
                1 => {
                    let mut iteration = self.single.take();
                    let outcome = self.run(problem, &mut iteration, &mut solutions, first);
                    self.single = iteration;
                    outcome?;
                }
                _ => {
                    let mut iteration = self.quadruple.take();
                    let outcome = self.run(problem, &mut iteration, &mut solutions, first);
                    self.quadruple = iteration;
                    outcome?;
                }
            }
        }
        Ok(solutions)
    }

    fn run<const L: usize>(
        &mut self,
        problem: Problem,
        kept: &mut Option<Iteration<L>>,
        solutions: &mut Array2<f64>,
        first: usize,
    ) -> Result<()> {
        let iteration = kept.get_or_insert_with(|| Iteration::new(&self.hierarchy));
        // Single precision has no room for lengths of any unit.
        let largest = system::largest(problem.rows);
        if largest == 0.0 {
            return Ok(());
        }
        let factor = self.scale / largest;
        let gather = |values: ArrayView2<f64>, factor, lanes: &mut [_]| {
            system::gather(&self.ordering, values, factor, lanes);
        };
        gather(problem.rows, largest.recip(), &mut iteration.residual);
        let has_guess = problem
            .guess
            .with_rows(problem.rows.nrows(), |guess| match guess {
                Some(guess) => gather(guess, factor, &mut iteration.solution),
                None => iteration.solution.fill([0.0; L]),
            });
        let (tolerance, stage) = (problem.tolerance, problem.stage);
        let is_fresh = self.age == 1 && self.coarse_levels.are_current();
        let most = match self.iterations_when_fresh {
            Some(fresh) if !is_fresh => (fresh + MOST_WASTED_ITERATIONS) as usize,
            _ => MOST_ITERATIONS,
        };
        let mut report = iteration.run(&self.hierarchy, has_guess, tolerance, most, stage)?;
        if !report.has_converged && !is_fresh {
            // From where the iteration got to.
            self.lifetime = self.age.saturating_sub(1).max(1);
            self.coarsen(stage)?;
            iteration.adapt(&self.hierarchy);
            let right_hand_side = &mut iteration.residual;
            system::gather(
                &self.ordering,
                problem.rows,
                largest.recip(),
                right_hand_side,
            );
            report = iteration.run(&self.hierarchy, true, tolerance, MOST_ITERATIONS, stage)?;
        }
        if !report.has_converged {
            self.coarse_levels = CoarseLevels::Unset;
            return Err(Error::Solver(format!(
                "no convergence in {} iterations",
                report.iterations
            )));
        }
        self.judge(report);
        let solution = std::mem::take(&mut iteration.solution);
        if solutions.ncols() >= LARGE {
            *kept = None;
        }
        system::scatter(&self.ordering, &solution, factor, solutions, first);
        if let Some(iteration) = kept {
            iteration.solution = solution;
        }
        Ok(())
    }

    fn coarsen(&mut self, stage: Stage) -> Result<()> {
        self.coarse_levels = CoarseLevels::Unset;
        self.iterations_when_fresh = None;
        self.hierarchy.coarsen(stage)?;
        if let Some(iteration) = &mut self.single {
            iteration.adapt(&self.hierarchy);
        }
        if let Some(iteration) = &mut self.quadruple {
            iteration.adapt(&self.hierarchy);
        }
        self.coarse_levels = CoarseLevels::Current;
        self.age = 1;
        Ok(())
    }

    /// Asks for new coarse levels or new clusters once these have become much worse than they
    /// were.
    fn judge(&mut self, report: Report) {
        if report.iterations == 0 {
            return;
        }
        let iterations = GAIN.ln() / report.rate.ln();
        if self.coarse_levels.are_current() {
            let fresh = *self.iterations_when_fresh.get_or_insert(iterations);
            if iterations > fresh + MOST_EXTRA_ITERATIONS {
                self.coarse_levels = CoarseLevels::Unfit;
            }
        }
        if let Upkeep::WithClusters { iterations: known } = &mut self.upkeep {
            if self.coarse_levels.are_current() {
                *known = iterations;
            } else if iterations > *known + MOST_OUTDATED_ITERATIONS {
                self.upkeep = Upkeep::WithMatrices;
            }
        }
    }
}

/// What is asked of one block of channels.
struct Problem<'a> {
    rows: ArrayView2<'a, f64>,
    guess: Guess<'a>,
    tolerance: f64,
    stage: Stage<'a>,
}

/// What a block starts from, if anything: the rows of a guess for all channels from one on.
enum Guess<'a> {
    Rows(usize, Option<&'a Array2<f64>>),
    /// Nobody needs it after this block: it is gone before the iteration begins.
    Last(usize, Option<Array2<f64>>),
}

impl Guess<'_> {
    /// Hands over the `count` rows, and returns whether there are any.
    fn with_rows(self, count: usize, take: impl FnOnce(Option<ArrayView2<f64>>)) -> bool {
        let (first, guess) = match &self {
            Self::Rows(first, guess) => (*first, *guess),
            Self::Last(first, guess) => (*first, guess.as_ref()),
        };
        take(guess.map(|guess| guess.slice_axis(Axis(0), (first..first + count).into())));
        guess.is_some()
    }
}
