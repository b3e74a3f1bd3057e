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

/// A factorization P K Pᵀ = L Lᵀ of symmetric positive definite matrices of one pattern.
///
/// Sequential: faer parallelises only dense kernels, which are small for surfaces.
pub struct Cholesky {
    symbolic: SymbolicCholesky<u32>,
    factor: Vec<f64>,
    workspace: MemBuffer,
    is_factorized: bool,
}

impl Cholesky {
    /// Analyses the pattern of `lower`, the lower triangle of the matrices to come.
    ///
    /// # Errors
    /// [`Error::Solver`] if memory or the index range does not suffice.
    pub fn analyse(lower: &CsMatI<f64, u32>) -> Result<Self> {
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
        let request = StackReq::any_of(&[
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()),
            symbolic.solve_in_place_scratch::<f64>(MOST_RIGHT_HAND_SIDES, Par::Seq),
        ]);
        let workspace = MemBuffer::try_new(request)
            .map_err(|_| Error::Solver("out of memory for the factorization".into()))?;
        let mut factor = Vec::new();
        factor
            .try_reserve_exact(symbolic.len_val())
            .map_err(|_| Error::Solver("out of memory for the factor".into()))?;
        factor.resize(symbolic.len_val(), 0.0);
        Ok(Self {
            symbolic,
            factor,
            workspace,
            is_factorized: false,
        })
    }

    /// Factorizes the matrix whose lower triangle is `lower`.
    ///
    /// # Errors
    /// [`Error::Solver`] if the matrix is not numerically positive definite.
    pub fn factorize(&mut self, lower: &CsMatI<f64, u32>) -> Result<()> {
        self.is_factorized = false;
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
            .map_err(|_| Error::Solver("the matrix is not positive definite".into()))?;
        self.is_factorized = true;
        Ok(())
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
