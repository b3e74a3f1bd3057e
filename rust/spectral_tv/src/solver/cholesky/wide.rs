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

use crate::solver::cholesky::front::{self, Sums};
use crate::solver::cholesky::number::Number;

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
#[inline(always)]
pub(super) fn eliminate<N: Number, const FUSED: bool>(
    panel: &mut [N],
    shape: (usize, usize),
    sums: Option<Sums>,
) -> bool {
    match sums {
        Some(sums) => eliminate_by_sums::<N, FUSED>(panel, shape, sums),
        None => eliminate_by_faer(panel, shape),
    }
}

/// Block by block, as faer's does: with the sums of the rows below it as one more row, a diagonal block can go
/// before these.
#[inline(always)]
fn eliminate_by_sums<N: Number, const FUSED: bool>(
    panel: &mut [N],
    (height, width): (usize, usize),
    mut sums: Sums,
) -> bool {
    let (mut room, mut of_rows, mut diagonal) = (Vec::new(), Vec::new(), vec![0.0; SHARE]);
    for first in (0..width).step_by(SHARE) {
        let count = SHARE.min(width - first);
        let (known, rest) = panel.split_at_mut(first * height);
        let block = &mut rest[..count * height];
        if first > 0 {
            let known = MatRef::from_column_major_slice(known, height, first);
            let known = known.subrows(first, height - first);
            let block = MatMut::from_column_major_slice_mut(block, height, count);
            let (_, block) = block.split_at_row_mut(first);
            subtract_in_parts(block, known, known.subrows(0, count));
        }
        room.clear();
        for column in block.chunks_exact(height) {
            let (own, below) = column[first..].split_at(count);
            room.extend_from_slice(own);
            room.push(N::from_double(front::total(below)));
        }
        of_rows.clear();
        of_rows.extend_from_slice(&sums.of_rows[first..][..count]);
        let trial = Sums {
            of_rows: &mut of_rows,
            diagonal: &mut diagonal,
        };
        if !front::eliminate::<N, FUSED>(&mut room, (count + 1, count), Some(trial)) {
            return false;
        }
        for (own, column) in room
            .chunks_exact(count + 1)
            .zip(block.chunks_exact_mut(height))
        {
            let (known, below) = column[first..].split_at_mut(count);
            known.copy_from_slice(&own[..count]);
            clear(below);
        }
        let mut own = MatMut::from_column_major_slice_mut(&mut room, count + 1, count);
        invert_diagonal(own.rb_mut());
        let below = MatMut::from_column_major_slice_mut(&mut *block, height, count);
        let (_, below) = below.split_at_row_mut(first + count);
        solve(own.rb().subrows(0, count), below);
        for (place, column) in (first..).zip(block.chunks_exact_mut(height)) {
            clear(&mut column[first + count..]);
            sums.settle(place, &column[place + 1..]);
        }
    }
    true
}

fn clear<N: Number>(values: &mut [N]) {
    values.iter_mut().for_each(|value| *value = value.cleared());
}

/// `target` −= A Bᵀ; parts of its rows side by side.
fn subtract_in_parts<N: Number>(target: MatMut<N>, left: MatRef<N>, right: MatRef<N>) {
    let rows = target.nrows();
    if rows < 2 * SHARE || rows * right.nrows() * right.ncols() < SHARED {
        subtract_product(target, BlockStructure::Rectangular, left, right);
        return;
    }
    let half = rows / 2 / 16 * 16;
    let (above, below) = target.split_at_row_mut(half);
    let (left_above, left_below) = left.split_at_row(half);
    rayon::join(
        || subtract_in_parts(above, left_above, right),
        || subtract_in_parts(below, left_below, right),
    );
}

fn eliminate_by_faer<N: Number>(panel: &mut [N], (height, width): (usize, usize)) -> bool {
    let panel = MatMut::from_column_major_slice_mut(panel, height, width);
    let (mut own, below) = panel.split_at_row_mut(width);
    let request = cholesky_in_place_scratch::<N>(width, Par::Seq, Spec::default());
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
    invert_diagonal(own);
    true
}

fn invert_diagonal<N: Number>(mut panel: MatMut<N>) {
    for column in 0..panel.ncols() {
        panel[(column, column)] = panel[(column, column)].inverse();
    }
}

/// `below` ← `below` L⁻ᵀ, for the diagonal block L; parts of its rows side by side.
fn solve<N: Number>(block: MatRef<N>, below: MatMut<N>) {
    let rows = below.nrows();
    if rows < 2 * SHARE || rows * block.nrows().pow(2) < SHARED {
        solve_lower_triangular_in_place(block, below.transpose_mut(), Par::Seq);
        return;
    }
    let (above, below) = below.split_at_row_mut(rows / 2 / 8 * 8);
    rayon::join(|| solve(block, above), || solve(block, below));
}

/// [`super::front::subtract_square`], parts of the columns side by side.
pub(super) fn subtract_square<N: Number>(update: &mut [N], size: usize, panel: &[N], width: usize) {
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
fn subtract_product<N: Number>(
    target: MatMut<N>,
    structure: BlockStructure,
    left: MatRef<N>,
    right: MatRef<N>,
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
        -N::ONE,
        Par::Seq,
    );
}
