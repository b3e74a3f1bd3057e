//! One interface to the solvers, and the choice between them.

use std::sync::Arc;

use ndarray::Array2;
use rayon::prelude::*;
use sprs::CsMatI;

use crate::error::{Error, Result};
use crate::graph::Graph;
use crate::memory::needs::Solved;
use crate::monitor::Stage;
use crate::named::named;
use crate::parallel;
use crate::solver::{Cholesky, Multigrid, Symbolic};

/// Number of unknowns up to which a factorization takes some milliseconds on any shape, and is
/// exact.
const SMALL: usize = 10_000;
/// Number of unknowns from which multigrid is taken without a look at their couplings, as it
/// takes less memory; and the same for several solutions of single functions. There a
/// factorization takes two thirds of the time at 650 000 and at a million, and at 650 000 a third more memory.
const LARGE: usize = 100_000;
const HUGE: usize = 1_200_000;
/// Entries in a row of the factor from which multigrid is faster between these. A shape of thin
/// limbs falls apart in small parts and has 36 at 50 000 vertices, where a factorization takes a
/// fourth to a half of multigrid's time; a compact scan has 50 at 36 000, where both take the
/// same, and an even lattice 67 at 17 000, where multigrid takes two thirds. All of this in
/// orders of minimum degree, whichever is taken.
const LARGE_FILL: f64 = 50.0;
/// Entries beyond these where a matrix serves several solutions, which cost multigrid about as
/// much as the first, and twice as many for single functions, which do not fill its registers.
const MORE_FILL: f64 = 12.0;

named! {
    /// How linear systems are solved.
    pub enum Solver: "solver" {
        /// By what is faster at the size at hand.
        #[default]
        Auto = "auto",
        /// By factorization: exact to rounding, for small meshes and as the reference.
        Cholesky = "cholesky",
        /// By factorization in single precision, for shapes of thin limbs and for single functions: rounding
        /// leaves some 1e-6 of each solution.
        Single = "single",
        /// By conjugate gradients with multigrid: linear in time and memory.
        Multigrid = "multigrid",
    }
}

impl Solver {
    /// How systems of so many unknowns are solved, whatever couples them.
    pub fn solved(self, unknowns: usize, demand: Demand) -> Solved {
        match self {
            Self::Auto if unknowns >= demand.most_unknowns() => Solved::Iteratively,
            Self::Auto if unknowns <= SMALL => Solved::Exactly,
            Self::Auto | Self::Single => Solved::InSingle,
            Self::Cholesky => Solved::Exactly,
            Self::Multigrid => Solved::Iteratively,
        }
    }

    /// Which of the others it is for what is demanded of matrices with the pattern of `lower`,
    /// which has this `symbolic`.
    ///
    /// # Errors
    /// [`Error::Solver`] if the index range does not suffice.
    pub fn chosen(
        self,
        lower: &CsMatI<f64, u32>,
        symbolic: &Symbolic,
        demand: Demand,
    ) -> Result<Self> {
        Ok(match (self, self.solved(lower.cols(), demand)) {
            (_, Solved::Exactly) => Self::Cholesky,
            (_, Solved::Iteratively) => Self::Multigrid,
            (Self::Auto, _) => match demand.largest_fill() {
                Some(largest) if symbolic.fill(lower)? >= largest => Self::Multigrid,
                _ => Self::Single,
            },
            _ => Self::Single,
        })
    }
}

/// What a matrix is taken for.
#[derive(Debug, Clone, Copy)]
pub struct Demand {
    /// Solutions with each matrix.
    pub solutions: usize,
    /// Functions solved for at once.
    pub channels: usize,
}

impl Demand {
    /// Unknowns from which systems are iterated on.
    fn most_unknowns(self) -> usize {
        match (self.solutions, self.channels) {
            (2.., 1) => HUGE,
            _ => LARGE,
        }
    }

    /// Entries in a row of the factor from which systems are iterated on; `None` if never.
    fn largest_fill(self) -> Option<f64> {
        match (self.solutions, self.channels) {
            (2.., 1) => None,
            (..=1, 1) => Some(LARGE_FILL + 2.0 * MORE_FILL),
            (..=1, _) => Some(LARGE_FILL),
            _ => Some(LARGE_FILL + MORE_FILL),
        }
    }
}

/// Solves systems with symmetric positive definite matrices of one pattern.
pub struct LinearSolver {
    graph: Arc<Graph>,
    masses: Vec<f64>,
    /// Of the matrix at hand, as far as it may still have to be factorized; and τ.
    couplings: Vec<f64>,
    tau: f64,
    symbolic: Symbolic,
    approach: Approach,
    /// The matrix at hand, and its factor, where it is solved exactly: by this approach, or where another
    /// fails.
    lower: Option<CsMatI<f64, u32>>,
    factor: Factor,
}

/// How systems are solved at first.
enum Approach {
    Exact,
    Single(Cholesky<f32>),
    Multigrid(Box<Multigrid>),
}

/// What there is of a factorization.
enum Factor {
    /// Nothing.
    None,
    /// Room for one, or that of an earlier matrix.
    Room(Cholesky),
    /// That of the matrix at hand.
    Ready(Cholesky),
}

impl LinearSolver {
    /// Chooses for matrices with this `graph`, whose pattern has this `symbolic` factorization.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if memory does not suffice.
    pub(crate) fn new(
        graph: &Arc<Graph>,
        symbolic: &Symbolic,
        solver: Solver,
        demand: Demand,
        stage: Stage,
    ) -> Result<Self> {
        let (mut lower, mut factor) = (None, Factor::None);
        let chosen = match solver.solved(graph.size(), demand) {
            Solved::Iteratively => Solver::Multigrid,
            _ => {
                let lower = lower.insert(stage.pass(|| graph.lower_triangle())?);
                stage.pass(|| solver.chosen(lower, symbolic, demand))??
            }
        };
        let approach = match (chosen, lower.take()) {
            (Solver::Cholesky, Some(pattern)) => {
                factor = Factor::Room(Cholesky::new(&pattern, symbolic, stage)?);
                lower = Some(pattern);
                Approach::Exact
            }
            (Solver::Single, Some(pattern)) => {
                Approach::Single(Cholesky::new(&pattern, symbolic, stage)?)
            }
            _ => Approach::Multigrid(Box::new(Multigrid::analyse(Arc::clone(graph), stage)?)),
        };
        Ok(Self {
            graph: Arc::clone(graph),
            masses: vec![0.0; graph.size()],
            couplings: Vec::new(),
            tau: 0.0,
            symbolic: symbolic.clone(),
            approach,
            lower,
            factor,
        })
    }

    /// Takes the matrix diag(`masses`) + `tau` L, where L has the off-diagonal entries
    /// −`couplings`, one for every entry of the pattern, and rows that sum to 0.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if the matrix is not positive definite.
    pub fn set_matrix(
        &mut self,
        masses: &[f64],
        couplings: Vec<f64>,
        tau: f64,
        stage: Stage,
    ) -> Result<()> {
        self.couplings = couplings;
        self.tau = tau;
        self.masses.copy_from_slice(masses);
        self.factor = match std::mem::replace(&mut self.factor, Factor::None) {
            Factor::Ready(cholesky) => Factor::Room(cholesky),
            factor => factor,
        };
        let laplacian = (&self.couplings[..], tau);
        let outcome = match &mut self.approach {
            Approach::Exact => return self.factorize(stage),
            Approach::Single(cholesky) => cholesky.factorize_laplacian(masses, laplacian, stage),
            Approach::Multigrid(multigrid) => multigrid.set_matrix(masses, laplacian, stage),
        };
        match outcome {
            Err(Error::Solver(_)) => self.factorize(stage),
            outcome => outcome,
        }
    }

    /// Frees what is kept of the matrix at hand in case it has to be factorized. Another has to be set before
    /// the next solution.
    pub fn forget_matrix(&mut self) {
        self.couplings = Vec::new();
    }

    /// Solves K x = b for every row b of `right_hand_sides` (C, V). An iteration starts from
    /// `guess`, if given, and ends once its error is `tolerance` times x in the energy norm; a
    /// factorization needs neither, and also takes over where an iteration does not converge.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if the matrix is not positive definite.
    pub fn solve(
        &mut self,
        right_hand_sides: &Array2<f64>,
        guess: Option<Array2<f64>>,
        tolerance: f64,
        stage: Stage,
    ) -> Result<Array2<f64>> {
        let right = right_hand_sides.view();
        match &mut self.approach {
            _ if matches!(self.factor, Factor::Ready(_)) => {}
            Approach::Exact => {}
            Approach::Single(cholesky) => return Ok(cholesky.solve(right)),
            Approach::Multigrid(multigrid) => {
                match multigrid.solve(right, guess, tolerance, stage) {
                    Err(Error::Solver(_)) => {}
                    outcome => return outcome,
                }
            }
        }
        self.solve_exactly(right_hand_sides, stage)
    }

    /// [`Self::solve`] by factorization, whatever the solver.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if the matrix is not positive definite.
    pub fn solve_exactly(
        &mut self,
        right_hand_sides: &Array2<f64>,
        stage: Stage,
    ) -> Result<Array2<f64>> {
        if !matches!(self.factor, Factor::Ready(_)) {
            self.factorize(stage)?;
        }
        match &mut self.factor {
            Factor::Ready(cholesky) => Ok(cholesky.solve(right_hand_sides.view())),
            Factor::Room(_) | Factor::None => unreachable!("factorized above"),
        }
    }

    /// Whether solutions begin with a guess.
    pub fn is_iterative(&self) -> bool {
        matches!(self.approach, Approach::Multigrid(_))
    }

    /// Whether solutions of the matrix at hand are exact to rounding.
    pub fn is_exact(&self) -> bool {
        matches!(self.approach, Approach::Exact) || matches!(self.factor, Factor::Ready(_))
    }

    fn factorize(&mut self, stage: Stage) -> Result<()> {
        let lower = match &mut self.lower {
            Some(lower) => lower,
            lower => lower.insert(stage.pass(|| self.graph.lower_triangle())?),
        };
        let tau = self.tau;
        let entries = lower.data_mut().par_iter_mut().zip(&self.couplings);
        stage.pass(|| parallel::for_each(entries, |(entry, coupling)| *entry = -tau * coupling))?;
        if matches!(self.approach, Approach::Exact) {
            self.couplings = Vec::new();
        }
        complete_diagonal(&self.graph, &self.masses, lower);
        let mut cholesky = match std::mem::replace(&mut self.factor, Factor::None) {
            Factor::Room(cholesky) | Factor::Ready(cholesky) => cholesky,
            Factor::None => Cholesky::new(lower, &self.symbolic, stage)?,
        };
        let outcome = cholesky.factorize(lower, stage);
        self.factor = match outcome {
            Ok(()) => Factor::Ready(cholesky),
            Err(_) => Factor::Room(cholesky),
        };
        outcome
    }
}

/// Gives the rows of the matrix with the lower triangle `lower` the sums `masses`.
fn complete_diagonal(graph: &Graph, masses: &[f64], lower: &mut CsMatI<f64, u32>) {
    let entries = lower.data();
    let diagonal = parallel::values(masses.len(), |row| {
        let neighbours = graph.neighbours_of(row).iter();
        let couplings = neighbours.map(|&(_, entry)| entries[entry as usize]);
        masses[row] - couplings.sum::<f64>()
    });
    for (mut column, value) in lower.outer_iterator_mut().zip(diagonal) {
        if let Some(entry) = column.iter_mut().next() {
            *entry.1 = value;
        }
    }
}
