//! One interface to the solvers, and the choice between them.

use ndarray::Array2;
use rayon::prelude::*;
use sprs::CsMatI;

use crate::error::{Error, Result};
use crate::monitor::Stage;
use crate::named::named;
use crate::parallel;
use crate::solver::graph::Graph;
use crate::solver::{Cholesky, Multigrid, Symbolic};

/// Number of unknowns up to which a factorization takes some milliseconds on any shape, and is
/// exact.
const SMALL: usize = 10_000;
/// Number of unknowns from which multigrid is taken without a look at their couplings, as it
/// takes less memory; and the same for several solutions of single functions, where a
/// factorization takes two thirds of the time at 300 000, but half as much memory again.
const LARGE: usize = 100_000;
const HUGE: usize = 400_000;
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
        /// By conjugate gradients with multigrid: linear in time and memory.
        Multigrid = "multigrid",
    }
}

impl Solver {
    /// Whether systems of so many unknowns are solved by iteration, whatever couples them.
    pub fn is_iterative(self, unknowns: usize, demand: Demand) -> bool {
        match self {
            Self::Auto => unknowns >= demand.most_unknowns(),
            Self::Cholesky => false,
            Self::Multigrid => true,
        }
    }

    /// Which of the two it is for what is demanded of matrices with the pattern of `lower`,
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
        let size = lower.cols();
        let is_direct = match self {
            Self::Auto if size >= demand.most_unknowns() => false,
            Self::Auto if size <= SMALL => true,
            Self::Auto => match demand.largest_fill() {
                Some(largest) => symbolic.fill(lower)? < largest,
                None => true,
            },
            _ => return Ok(self),
        };
        Ok(match is_direct {
            true => Self::Cholesky,
            false => Self::Multigrid,
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
    /// The lower triangle, its diagonal not written before a factorization needs it.
    lower: CsMatI<f64, u32>,
    masses: Vec<f64>,
    rows: Option<Rows>,
    symbolic: Symbolic,
    multigrid: Option<Multigrid>,
    factor: Factor,
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
    /// Chooses for the pattern of `lower`, the lower triangle of the matrices to come, which has
    /// this `symbolic` factorization.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if memory does not suffice.
    pub fn new(
        lower: CsMatI<f64, u32>,
        symbolic: &Symbolic,
        solver: Solver,
        demand: Demand,
        stage: Stage,
    ) -> Result<Self> {
        let chosen = stage.pass(|| solver.chosen(&lower, symbolic, demand))??;
        let (multigrid, factor) = match chosen == Solver::Multigrid {
            true => (Some(Multigrid::analyse(&lower, stage)?), Factor::None),
            false => {
                let cholesky = Cholesky::new(&lower, symbolic, stage)?;
                (None, Factor::Room(cholesky))
            }
        };
        Ok(Self {
            masses: vec![0.0; lower.cols()],
            rows: None,
            symbolic: symbolic.clone(),
            lower,
            multigrid,
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
        couplings: &[f64],
        tau: f64,
        stage: Stage,
    ) -> Result<()> {
        let entries = self.lower.data_mut().par_iter_mut().zip(couplings);
        stage.pass(|| parallel::for_each(entries, |(entry, coupling)| *entry = -tau * coupling))?;
        self.masses.copy_from_slice(masses);
        self.factor = match std::mem::replace(&mut self.factor, Factor::None) {
            Factor::Ready(cholesky) => Factor::Room(cholesky),
            factor => factor,
        };
        if let Some(multigrid) = &mut self.multigrid {
            match multigrid.set_matrix(&self.lower, masses, stage) {
                Err(Error::Solver(_)) => {}
                outcome => return outcome,
            }
        }
        self.factorize(stage)
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
        guess: Option<&Array2<f64>>,
        tolerance: f64,
        stage: Stage,
    ) -> Result<Array2<f64>> {
        if let Some(multigrid) = &mut self.multigrid
            && !matches!(self.factor, Factor::Ready(_))
        {
            let guess = guess.map(|guess| guess.view());
            match multigrid.solve(right_hand_sides.view(), guess, tolerance, stage) {
                Err(Error::Solver(_)) => {}
                outcome => return outcome,
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
        if !self.is_exact() {
            self.factorize(stage)?;
        }
        let mut solutions = right_hand_sides.clone();
        if let Factor::Ready(cholesky) = &mut self.factor {
            cholesky.solve_in_place(&mut solutions);
        }
        Ok(solutions)
    }

    /// Whether solutions begin with a guess.
    pub fn is_iterative(&self) -> bool {
        self.multigrid.is_some()
    }

    /// Whether solutions of the matrix at hand are exact to rounding.
    pub fn is_exact(&self) -> bool {
        self.multigrid.is_none() || matches!(self.factor, Factor::Ready(_))
    }

    fn factorize(&mut self, stage: Stage) -> Result<()> {
        let rows = match &mut self.rows {
            Some(rows) => rows,
            rows => rows.insert(Rows::new(&self.lower, stage)?),
        };
        rows.complete_diagonal(&mut self.lower, &self.masses);
        let mut cholesky = match std::mem::replace(&mut self.factor, Factor::None) {
            Factor::Room(cholesky) | Factor::Ready(cholesky) => cholesky,
            Factor::None => Cholesky::new(&self.lower, &self.symbolic, stage)?,
        };
        let outcome = cholesky.factorize(&self.lower, stage);
        self.factor = match outcome {
            Ok(()) => Factor::Ready(cholesky),
            Err(_) => Factor::Room(cholesky),
        };
        outcome
    }
}

/// The couplings and the diagonal of each row of a matrix, in its lower triangle.
struct Rows {
    graph: Graph,
    diagonal: Vec<Option<usize>>,
}

impl Rows {
    fn new(lower: &CsMatI<f64, u32>, stage: Stage) -> Result<Self> {
        let diagonal = (0..lower.cols()).map(|row| lower.nnz_index(row, row));
        Ok(Self {
            graph: Graph::new(lower, stage)?,
            diagonal: diagonal.map(|entry| entry.map(|entry| entry.0)).collect(),
        })
    }

    /// Gives the rows of the matrix with the lower triangle `lower` the sums `masses`.
    fn complete_diagonal(&self, lower: &mut CsMatI<f64, u32>, masses: &[f64]) {
        let entries = lower.data();
        let diagonal = parallel::values(masses.len(), |row| {
            let neighbours = self.graph.neighbours_of(row).iter();
            let couplings = neighbours.map(|&(_, entry)| entries[entry as usize]);
            masses[row] - couplings.sum::<f64>()
        });
        let entries = lower.data_mut();
        for (entry, value) in self.diagonal.iter().zip(diagonal) {
            if let Some(entry) = *entry {
                entries[entry] = value;
            }
        }
    }
}
