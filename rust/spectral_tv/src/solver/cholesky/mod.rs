//! Sparse Cholesky factorization: the analysis is done once, each step factorizes anew.
//!
//! Orders and patterns are faer's. Its numeric factorization goes through the supernodes one by
//! one; those of a surface are small and many, and the elimination tree has room for all threads
//! from some thousand vertices on, so that part is our own.

mod factor;
mod front;
mod solve;
mod supernodes;
#[cfg(test)]
mod tests;
mod tree;
mod units;
mod wide;

use ndarray::{Array2, Axis};
use sprs::CsMatI;

use crate::error::{Error, Result};
use factor::Numbers;
use supernodes::Supernodes;
use units::Unit;

/// For refusals.
const WHAT: &str = "the factor of the mesh's matrix";
const ADVICE: &str = "take a smaller mesh, or the solver \"multigrid\" for a flow";

/// Multiplications that are worth handing to another thread.
const LEAST_WORK: f64 = 1.5e5;

/// Relative enlargements of the diagonal to try in turn.
const ENLARGEMENTS: [f64; 3] = [1e-12, 1e-9, 1e-6];

/// A factorization P K Pᵀ = L Lᵀ of symmetric positive definite matrices of one pattern.
///
/// Results are the same however many threads share the work.
pub struct Cholesky {
    units: Vec<Unit>,
    numbers: Vec<Numbers>,
    is_factorized: bool,
}

/// What a factorization of matrices of one pattern will look like.
pub(super) struct Analysis(Supernodes);

impl Analysis {
    /// Analyses the pattern of `lower`, the lower triangle of the matrices to come.
    ///
    /// # Errors
    /// [`Error::Memory`], or [`Error::Solver`] if the index range does not suffice.
    pub fn new(lower: &CsMatI<f64, u32>) -> Result<Self> {
        Supernodes::new(lower).map(Self)
    }

    /// Entries that the factor will have in each row, on average.
    pub fn fill(&self) -> f64 {
        self.0.fill()
    }

    /// Makes room for the factor of matrices with the pattern of `lower`.
    ///
    /// # Errors
    /// [`Error::Memory`], or [`Error::Solver`] if the index range does not suffice.
    pub fn prepare(self, lower: &CsMatI<f64, u32>) -> Result<Cholesky> {
        self.prepare_in_units(lower, LEAST_WORK)
    }

    fn prepare_in_units(self, lower: &CsMatI<f64, u32>, least_work: f64) -> Result<Cholesky> {
        let units = units::split(&self.0, lower, least_work)?;
        let numbers = units.iter().map(|unit| Numbers::new(unit, WHAT, ADVICE));
        Ok(Cholesky {
            numbers: numbers.collect::<Result<_>>()?,
            units,
            is_factorized: false,
        })
    }
}

impl Cholesky {
    /// Analyses the pattern of `lower`, the lower triangle of the matrices to come.
    ///
    /// # Errors
    /// [`Error::Memory`], or [`Error::Solver`] if the index range does not suffice.
    pub fn analyse(lower: &CsMatI<f64, u32>) -> Result<Self> {
        Analysis::new(lower)?.prepare(lower)
    }

    /// Factorizes the matrix whose lower triangle is `lower`.
    ///
    /// Rounding can cost a nearly singular matrix its definiteness, as where areas vanish; its
    /// diagonal is then enlarged, by 1e-6 of itself at most, until it has it back.
    ///
    /// # Errors
    /// [`Error::Solver`] if the matrix is far from positive definite, or not finite.
    pub fn factorize(&mut self, lower: &CsMatI<f64, u32>) -> Result<()> {
        self.is_factorized = factor::factorize(&self.units, &mut self.numbers, lower.data());
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
            self.is_factorized = factor::factorize(&self.units, &mut self.numbers, enlarged.data());
        }
        match self.is_factorized {
            true => Ok(()),
            false => Err(Error::Solver("the matrix is not positive definite".into())),
        }
    }

    /// Replaces each row b of `right_hand_sides` (C, V) by the solution of K x = b.
    ///
    /// # Panics
    /// If nothing was factorized before.
    pub fn solve_in_place(&mut self, right_hand_sides: &mut Array2<f64>) {
        assert!(self.is_factorized, "factorize before solving");
        for block in right_hand_sides.axis_chunks_iter_mut(Axis(0), 4) {
            match block.nrows() {
                1 => solve::solve::<1>(&self.units, &mut self.numbers, block),
                _ => solve::solve::<4>(&self.units, &mut self.numbers, block),
            }
        }
    }
}
