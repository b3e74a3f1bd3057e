//! The kernels of [`super::front`] for fronts with many columns to eliminate. They use faer, whose
//! blocked products pay from some dozens of columns on.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par, Spec};
use rayon::prelude::*;

/// Multiplications that are worth sharing among threads, and columns of a share.
const SHARED: usize = 1 << 20;
const SHARE: usize = 64;

/// Columns from which on a front is wide, if it is not large.
const LEAST_WIDTH: usize = 32;

/// Whether a front of this height and width is for this module.
pub(super) fn is_wide((height, width): (usize, usize)) -> bool {
    width >= LEAST_WIDTH || (height - width).pow(2) * width >= SHARED
}

/// [`super::front::eliminate`].
pub(super) fn eliminate(panel: &mut [f64], height: usize, width: usize) -> bool {
    let panel = MatMut::from_column_major_slice_mut(panel, height, width);
    let (mut own, below) = panel.split_at_row_mut(width);
    let request = cholesky_in_place_scratch::<f64>(width, Par::Seq, Spec::default());
    let outcome = cholesky_in_place(
        own.rb_mut(),
        LltRegularization::default(),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(request)),
        Spec::default(),
    );
    if outcome.is_err() {
        return false;
    }
    solve(own.rb(), below);
    for column in 0..width {
        own[(column, column)] = own[(column, column)].recip();
    }
    true
}

/// `below` ← `below` L⁻ᵀ, for the diagonal block L; parts of its rows side by side.
fn solve(block: MatRef<f64>, below: MatMut<f64>) {
    let rows = below.nrows();
    if rows < 2 * SHARE || rows * block.nrows().pow(2) < SHARED {
        solve_lower_triangular_in_place(block, below.transpose_mut(), Par::Seq);
        return;
    }
    let (above, below) = below.split_at_row_mut(rows / 2 / 8 * 8);
    rayon::join(|| solve(block, above), || solve(block, below));
}

/// [`super::front::subtract_square`], parts of the columns side by side.
pub(super) fn subtract_square(update: &mut [f64], size: usize, panel: &[f64], width: usize) {
    let below = MatRef::from_column_major_slice(panel, size + width, width);
    let below = below.subrows(width, size);
    let columns = match size * size * width < SHARED {
        true => size,
        false => SHARE,
    };
    let parts = update.par_chunks_mut((columns * size).max(1)).enumerate();
    parts.with_max_len(1).for_each(|(part, update)| {
        let first = part * columns;
        let count = update.len() / size;
        let update = MatMut::from_column_major_slice_mut(update, size, count);
        let (_, update) = update.split_at_row_mut(first);
        let (square, rest) = update.split_at_row_mut(count);
        let (right, left) = below.subrows(first, size - first).split_at_row(count);
        let lower = BlockStructure::TriangularLower;
        subtract_product(square, lower, right, right);
        subtract_product(rest, BlockStructure::Rectangular, left, right);
    });
}

/// `target` −= A Bᵀ, as far as its structure goes.
fn subtract_product(
    target: MatMut<f64>,
    structure: BlockStructure,
    left: MatRef<f64>,
    right: MatRef<f64>,
) {
    let whole = BlockStructure::Rectangular;
    let (add, right) = (Accum::Add, right.transpose());
    matmul(
        target,
        structure,
        add,
        left,
        whole,
        right,
        whole,
        -1.0,
        Par::Seq,
    );
}
