//! Sparse Cholesky factorization: symbolic once for a pattern, numeric for every matrix.
//!
//! The symbolic analysis is faer's. So are the orders for shapes with limbs. On even, compact
//! meshes orders of nested dissection, which faer does not have, halve the work. faer's numeric
//! factorization goes through the supernodes one by one. Those of a surface are small and many, and
//! from some thousand vertices on the elimination tree has work for all threads. So nested
//! dissection and the numeric factorization are our own.

mod dissection;
mod factor;
mod front;
mod lanes;
mod number;
mod part;
mod separator;
mod solve;
mod supernodes;
#[cfg(test)]
mod tests;
mod tree;
mod units;
mod wide;

use std::any::Any;
use std::sync::{Arc, Mutex, OnceLock};

use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis};
use rayon::prelude::*;
use sprs::CsMatI;

use crate::error::{Error, Result};
use crate::monitor::Stage;
use crate::parallel;
use crate::solver::scratch;
use factor::Matrix;
use number::{Number, Numbers};
use supernodes::Supernodes;
use units::Unit;

/// For refusals.
const WHAT: &str = "the factor of the mesh's matrix";
const ADVICE: &str = "take a smaller mesh, or the multigrid solver for a flow";

/// Multiplications that are worth handing to another thread.
const LEAST_WORK: f64 = 1.5e5;

/// Relative enlargements of the diagonal to try in turn.
const ENLARGEMENTS: [f64; 3] = [1e-12, 1e-9, 1e-6];

/// Entries in a row of the factor, in an order of approximate minimum degree, from which nested
/// dissection pays: with half of the multiplications on even, compact meshes.
const COMPACT_FILL: f64 = 45.0;
/// Columns up to which it takes longer than what it saves in some tens of factorizations.
const FEW: usize = 5_000;
/// Vertices up to which a part is not dissected.
const SMALL: usize = 400;
/// Columns from which on it is taken without a look at that: orders of minimum degree take too
/// long to find where nothing can interrupt it.
const LARGE: usize = 100_000;

/// The symbolic factorization of matrices of one pattern, found when it is first asked for.
#[derive(Debug, Clone, Default)]
pub struct Symbolic(Arc<Found>);

#[derive(Debug, Default)]
struct Found {
    by_degree: OnceLock<Supernodes>,
    units: OnceLock<Arc<Units>>,
    /// Room that a factorization left, `Vec<Numbers<N>>`, for the next one of its precision: to have
    /// it from the system takes as long as a factorization.
    spare: Mutex<Option<Box<dyn Any + Send>>>,
}

impl Symbolic {
    /// Entries that the factor has in each row, on average, in an order of approximate minimum
    /// degree, for the pattern of `lower`.
    ///
    /// # Errors
    /// [`Error::Solver`] if the index range does not suffice.
    pub(super) fn fill(&self, lower: &CsMatI<f64, u32>) -> Result<f64> {
        self.by_degree(lower).map(Supernodes::fill)
    }

    fn by_degree(&self, lower: &CsMatI<f64, u32>) -> Result<&Supernodes> {
        let by_degree = &self.0.by_degree;
        if by_degree.get().is_none() {
            // Whoever was faster has found the same.
            let _ = by_degree.set(Supernodes::by_degree(lower)?);
        }
        Ok(by_degree.get().expect("found before"))
    }

    fn units(&self, lower: &CsMatI<f64, u32>, stage: Stage) -> Result<Arc<Units>> {
        if let Some(units) = self.0.units.get() {
            return Ok(Arc::clone(units));
        }
        let split = |nodes: &Supernodes| units::split(nodes, lower, LEAST_WORK, stage);
        let pays = match lower.cols() {
            ..=FEW => false,
            LARGE.. => true,
            _ => self.fill(lower)? >= COMPACT_FILL,
        };
        let units = match pays {
            true => split(&Supernodes::by_dissection(lower, SMALL, stage)?)?,
            false => split(self.by_degree(lower)?)?,
        };
        let units = Arc::new(Units::from(units));
        Ok(Arc::clone(self.0.units.get_or_init(|| units)))
    }
}

/// The elimination tree in units of work.
#[derive(Debug)]
struct Units {
    units: Vec<Unit>,
    /// For each unknown its unit, and its column there.
    places: Vec<(u32, u32)>,
    /// Whether there are fronts that are multiplied as matrices.
    has_wide: bool,
}

impl From<Vec<Unit>> for Units {
    fn from(units: Vec<Unit>) -> Self {
        let nodes = units.iter().flat_map(|unit| &unit.nodes);
        let mut shapes = nodes.map(|node| (node.height, node.width));
        let count = units.iter().map(|unit| unit.columns.len()).sum();
        let mut places = vec![(0, 0); count];
        for (index, unit) in units.iter().enumerate() {
            for (column, &unknown) in unit.columns.iter().enumerate() {
                places[unknown as usize] = (index as u32, column as u32);
            }
        }
        Self {
            has_wide: shapes.any(wide::is_wide),
            units,
            places,
        }
    }
}

/// A factorization P K Pᵀ = L Lᵀ of symmetric positive definite matrices of one pattern.
///
/// Results are the same however many threads share the work.
pub struct Cholesky<N: Number = f64> {
    units: Arc<Units>,
    numbers: Vec<Numbers<N>>,
    /// What the matrix was divided by.
    divisor: f64,
    is_factorized: bool,
    symbolic: Symbolic,
}

impl<N: Number> Drop for Cholesky<N> {
    fn drop(&mut self) {
        if let Ok(mut spare) = self.symbolic.0.spare.lock() {
            *spare = Some(Box::new(std::mem::take(&mut self.numbers)));
        }
    }
}

impl<N: Number> Cholesky<N> {
    /// Room for the factor of matrices with the pattern of `lower`, which has this `symbolic`
    /// factorization.
    ///
    /// # Errors
    /// [`Error::Memory`], [`Error::Solver`] if the index range does not suffice, or
    /// [`Error::Cancelled`].
    pub fn new(lower: &CsMatI<f64, u32>, symbolic: &Symbolic, stage: Stage) -> Result<Self> {
        let units = symbolic.units(lower, stage)?;
        Self::in_units(units, symbolic.clone(), stage)
    }

    /// The same for a pattern that nothing is known of.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn analyse(lower: &CsMatI<f64, u32>, stage: Stage) -> Result<Self> {
        Self::new(lower, &Symbolic::default(), stage)
    }

    fn in_units(units: Arc<Units>, symbolic: Symbolic, stage: Stage) -> Result<Self> {
        let spare = symbolic.0.spare.lock();
        let left = spare.ok().and_then(|mut spare| spare.take());
        let numbers = match left.and_then(|left| left.downcast().ok()) {
            Some(numbers) => *numbers,
            None => {
                let units = &units.units;
                let sizes = units
                    .iter()
                    .map(|unit| unit.panel_length + unit.stack_length);
                stage.require(
                    size_of::<N>() as u64 * sizes.sum::<usize>() as u64,
                    WHAT,
                    ADVICE,
                )?;
                // By threads, as the system takes its time to give it.
                let room = |unit: &Unit| stage.pass(|| Numbers::new(unit, WHAT, ADVICE))?;
                units.par_iter().map(room).collect::<Result<_>>()?
            }
        };
        Ok(Self {
            numbers,
            units,
            divisor: 1.0,
            is_factorized: false,
            symbolic,
        })
    }

    /// Factorizes the matrix whose lower triangle is `lower`.
    ///
    /// Rounding can cost a nearly singular matrix its definiteness, as where areas vanish; its
    /// diagonal is then enlarged, by 1e-6 of itself at most, until it has it back.
    ///
    /// # Errors
    /// [`Error::Solver`] if the matrix is far from positive definite, or not finite, or
    /// [`Error::Cancelled`].
    pub fn factorize(&mut self, lower: &CsMatI<f64, u32>, stage: Stage) -> Result<()> {
        self.divisor = 1.0;
        self.attempt(Matrix::of(lower), stage)?;
        for enlargement in ENLARGEMENTS {
            if self.is_factorized {
                break;
            }
            let mut enlarged = lower.clone();
            for (column, mut entries) in enlarged.outer_iterator_mut().enumerate() {
                if let Some(diagonal) = entries.get_mut(column) {
                    *diagonal *= 1.0 + enlargement;
                }
            }
            self.attempt(Matrix::of(&enlarged), stage)?;
        }
        self.outcome()
    }

    /// Factorizes diag(`masses`) + `tau` L, where L has the off-diagonal entries −`couplings`, one for every
    /// entry of the pattern, and rows that sum to 0.
    ///
    /// Entries of the diagonal are made from what rows sum to. So the masses keep their digits beside the
    /// couplings, and the error is that of a relative change of each coupling by rounding: in single precision
    /// solutions are right to some 1e-6 in the energy norm, however ill-conditioned the matrix is. That holds
    /// where no coupling is negative, and is nearly so on the meshes that were tried.
    ///
    /// # Errors
    /// [`Error::Solver`] if the matrix is not positive definite, or not finite, or [`Error::Cancelled`].
    pub fn factorize_laplacian(
        &mut self,
        masses: &[f64],
        (couplings, tau): (&[f64], f64),
        stage: Stage,
    ) -> Result<()> {
        // Single precision has no room for areas of any unit.
        let divisor = masses.iter().fold(0.0_f64, |max, mass| max.max(*mass));
        let sums = Array2::from_shape_fn((1, masses.len()), |(_, row)| masses[row] / divisor);
        let matrix = Matrix {
            entries: couplings,
            scale: -tau / divisor,
            sums: Some(&sums),
        };
        self.divisor = divisor;
        self.attempt(matrix, stage)?;
        self.outcome()
    }

    fn attempt(&mut self, matrix: Matrix, stage: Stage) -> Result<()> {
        self.is_factorized = false;
        if self.units.has_wide {
            // Here, as these threads may be others than those of the symbolic factorization.
            scratch::prepare(stage)?;
        }
        let units = &self.units.units;
        self.is_factorized = factor::factorize(units, &mut self.numbers, matrix, stage)?;
        Ok(())
    }

    fn outcome(&self) -> Result<()> {
        match self.is_factorized {
            true => Ok(()),
            false => Err(Error::Solver("the matrix is not positive definite".into())),
        }
    }

    /// Solves K x = b for each row b of `right_hand_sides` (C, V).
    ///
    /// # Panics
    /// If nothing was factorized before.
    pub fn solve(&mut self, right_hand_sides: ArrayView2<f64>) -> Array2<f64> {
        let mut solutions = parallel::zeros(right_hand_sides.dim());
        let blocks = right_hand_sides.axis_chunks_iter(Axis(0), 4);
        for (right, solutions) in blocks.zip(solutions.axis_chunks_iter_mut(Axis(0), 4)) {
            self.solve_block(right);
            self.write_block(solutions);
        }
        solutions
    }

    /// Replaces each row b of `right_hand_sides` (C, V) by the solution of K x = b.
    ///
    /// # Panics
    /// If nothing was factorized before.
    pub fn solve_in_place(&mut self, right_hand_sides: &mut Array2<f64>) {
        for block in right_hand_sides.axis_chunks_iter_mut(Axis(0), 4) {
            self.solve_block(block.view());
            self.write_block(block);
        }
    }

    fn solve_block(&mut self, right: ArrayView2<f64>) {
        assert!(self.is_factorized, "factorize before solving");
        let units = &self.units.units;
        match right.nrows() {
            1 => solve::solve::<N, 1>(units, &mut self.numbers, right),
            _ => solve::solve::<N, 4>(units, &mut self.numbers, right),
        }
    }

    fn write_block(&self, solutions: ArrayViewMut2<f64>) {
        let (places, scale) = (&self.units.places, self.divisor.recip());
        match solutions.nrows() {
            1 => solve::write::<N, 1>(places, &self.numbers, solutions, scale),
            _ => solve::write::<N, 4>(places, &self.numbers, solutions, scale),
        }
    }
}
