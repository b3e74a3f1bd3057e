//! Supernodal sparse Cholesky: the analysis is done once, each step factorizes anew.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};
use ndarray::Array2;
use sprs::CsMatI;

use crate::error::{Error, Result};
use crate::memory::zeros;

/// For refusals.
const WHAT: &str = "the factor of the mesh's matrix";
const ADVICE: &str = "take a smaller mesh, or the solver \"multigrid\" for a flow";

/// A factorization P K Pᵀ = L Lᵀ of symmetric positive definite matrices of one pattern.
///
/// Sequential: faer parallelises only dense kernels, which are small for surfaces.
pub struct Cholesky {
    symbolic: SymbolicCholesky<u32>,
    factor: Vec<f64>,
    workspace: MemBuffer,
    is_factorized: bool,
}

/// What a factorization of matrices of one pattern will look like.
pub(super) struct Analysis(SymbolicCholesky<u32>);

impl Analysis {
    /// Analyses the pattern of `lower`, the lower triangle of the matrices to come.
    ///
    /// # Errors
    /// [`Error::Memory`], or [`Error::Solver`] if the index range does not suffice.
    pub fn new(lower: &CsMatI<f64, u32>) -> Result<Self> {
        let params = CholeskySymbolicParams {
            // Simplicial factorization is several times slower at every size that matters.
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let starts = lower.proper_indptr();
        let symbolic = factorize_symbolic_cholesky(
            faer_view(lower, &starts).symbolic(),
            Side::Lower,
            SymmetricOrdering::Amd,
            params,
        )
        .map_err(|error| Error::Solver(format!("analysis failed: {error:?}")))?;
        Ok(Self(symbolic))
    }

    /// Entries that the factor will have in each row, on average.
    pub fn fill(&self) -> f64 {
        self.0.len_val() as f64 / self.0.nrows().max(1) as f64
    }

    /// Makes room for the factor.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn prepare(self) -> Result<Cholesky> {
        let Self(symbolic) = self;
        let request = StackReq::any_of(&[
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()),
            symbolic.solve_in_place_scratch::<f64>(MOST_RIGHT_HAND_SIDES, Par::Seq),
        ]);
        let workspace = MemBuffer::try_new(request)
            .map_err(|_| Error::Memory(format!("{WHAT} cannot have its workspace; {ADVICE}")))?;
        let factor = zeros(symbolic.len_val(), WHAT, ADVICE)?;
        Ok(Cholesky {
            symbolic,
            factor,
            workspace,
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
        Analysis::new(lower)?.prepare()
    }

    /// Factorizes the matrix whose lower triangle is `lower`.
    ///
    /// Rounding can cost a nearly singular matrix its definiteness, as where areas vanish; its
    /// diagonal is then enlarged, by 1e-6 of itself at most, until it has it back.
    ///
    /// # Errors
    /// [`Error::Solver`] if the matrix is far from positive definite, or not finite.
    pub fn factorize(&mut self, lower: &CsMatI<f64, u32>) -> Result<()> {
        self.is_factorized = self.try_factorize(lower);
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
            self.is_factorized = self.try_factorize(&enlarged);
        }
        match self.is_factorized {
            true => Ok(()),
            false => Err(Error::Solver("the matrix is not positive definite".into())),
        }
    }

    fn try_factorize(&mut self, lower: &CsMatI<f64, u32>) -> bool {
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                faer_view(lower, &lower.proper_indptr()),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.workspace),
                Spec::default(),
            )
            .is_ok()
    }

    /// Replaces each row b of `right_hand_sides` (C, V) by the solution of K x = b.
    ///
    /// # Panics
    /// If nothing was factorized before.
    pub fn solve_in_place(&mut self, right_hand_sides: &mut Array2<f64>) {
        assert!(self.is_factorized, "factorize before solving");
        let (count, size) = right_hand_sides.dim();
        let values = right_hand_sides
            .as_slice_mut()
            .expect("channels are contiguous");
        let factor = LltRef::new(&self.symbolic, &self.factor);
        for block in values.chunks_mut(size * MOST_RIGHT_HAND_SIDES.min(count)) {
            let columns = block.len() / size;
            factor.solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(block, size, columns),
                Par::Seq,
                MemStack::new(&mut self.workspace),
            );
        }
    }
}

/// Relative enlargements of the diagonal to try in turn.
const ENLARGEMENTS: [f64; 3] = [1e-12, 1e-9, 1e-6];

/// More are solved in blocks of this many.
const MOST_RIGHT_HAND_SIDES: usize = 4;

fn faer_view<'a>(
    matrix: &'a CsMatI<f64, u32>,
    column_starts: &'a [u32],
) -> SparseColMatRef<'a, u32, f64> {
    let (rows, columns) = matrix.shape();
    let indices = matrix.indices();
    let pattern = SymbolicSparseColMatRef::new_checked(rows, columns, column_starts, None, indices);
    SparseColMatRef::new(pattern, matrix.data())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::arr2;
    use sprs::TriMatI;

    fn lower(entries: &[(usize, usize, f64)], size: usize) -> CsMatI<f64, u32> {
        let mut matrix = TriMatI::new((size, size));
        for &(row, column, value) in entries {
            matrix.add_triplet(row, column, value);
        }
        matrix.to_csc()
    }

    #[test]
    fn solves_several_right_hand_sides() {
        let matrix = lower(
            &[
                (0, 0, 4.0),
                (1, 0, 1.0),
                (1, 1, 3.0),
                (2, 1, -1.0),
                (2, 2, 2.0),
            ],
            3,
        );
        let mut cholesky = Cholesky::analyse(&matrix).unwrap();
        cholesky.factorize(&matrix).unwrap();
        // K (1, −2, 0.5), five times over, more than are solved at once.
        let mut solutions =
            Array2::from_shape_fn((5, 3), |(i, j)| [2.0, -5.5, 3.0][j] * (i + 1) as f64);
        cholesky.solve_in_place(&mut solutions);
        for (i, row) in solutions.rows().into_iter().enumerate() {
            for (value, expected) in row.iter().zip([1.0, -2.0, 0.5]) {
                assert!((value - expected * (i + 1) as f64).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_mended_and_an_indefinite_one_refused() {
        let singular = lower(&[(0, 0, 1.0), (1, 0, -1.0), (1, 1, 1.0)], 2);
        let mut cholesky = Cholesky::analyse(&singular).unwrap();
        cholesky.factorize(&singular).unwrap();
        let mut solution = arr2(&[[1.0, -1.0]]);
        cholesky.solve_in_place(&mut solution);
        assert!((solution[[0, 0]] - solution[[0, 1]] - 1.0).abs() < 1e-6);

        let indefinite = lower(&[(0, 0, 1.0), (1, 0, -2.0), (1, 1, 1.0)], 2);
        assert!(cholesky.factorize(&indefinite).is_err());
    }
}
