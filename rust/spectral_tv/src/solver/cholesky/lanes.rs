//! Functions on a unit, several side by side.

use ndarray::ArrayView2;

use crate::solver::cholesky::number::{Number, Numbers};
use crate::solver::cholesky::units::Unit;

/// The values of L functions at one unknown.
pub(super) type Lanes<const L: usize> = [f64; L];

/// Columns that rows are read once for.
pub(super) const BLOCK: usize = 4;

/// The right-hand sides in a unit's columns, and zeros in its boundary.
pub(super) fn gather<const L: usize>(unit: &Unit, right: ArrayView2<f64>, lanes: &mut Vec<f64>) {
    lanes.clear();
    lanes.resize(L * (unit.columns.len() + unit.boundary.len()), 0.0);
    let lanes = lanes.as_chunks_mut::<L>().0;
    for (lane, row) in right.rows().into_iter().enumerate() {
        for (&vertex, lanes) in unit.columns.iter().zip(&mut *lanes) {
            lanes[lane] = row[vertex as usize];
        }
    }
}

/// Adds to `lanes` what the units right below one leave over in its columns and boundary.
pub(super) fn add_left_over<N, const L: usize>(
    units: &[Unit],
    unit: &Unit,
    below: &[Numbers<N>],
    lanes: &mut [Lanes<L>],
) {
    for &child in &unit.below {
        let child_numbers = &below[(child - unit.first) as usize];
        let child = &units[child as usize];
        let left_over = &child_numbers.lanes.as_chunks::<L>().0[child.columns.len()..];
        for (&place, value) in child.boundary.iter().zip(left_over) {
            add(&mut lanes[place as usize], value);
        }
    }
}

/// x −= A x₁, for the rows A of a panel below its diagonal block, x₁ in its columns; `sums` is room.
#[inline(always)]
pub(super) fn subtract_below<N: Number, const L: usize, const FUSED: bool>(
    panel: &[N],
    rows: &[u32],
    (height, width): (usize, usize),
    column: usize,
    x: &mut [Lanes<L>],
    sums: &mut Vec<Lanes<L>>,
) {
    let own = &x[column..][..width];
    sums.clear();
    sums.resize(rows.len(), [0.0; L]);
    let blocks = panel.chunks_exact(BLOCK * height);
    for (block, own) in blocks.zip(own.chunks_exact(BLOCK)) {
        let columns: [&[N]; BLOCK] =
            std::array::from_fn(|c| &block[c * height + width..(c + 1) * height]);
        for (row, sum) in sums.iter_mut().enumerate() {
            for c in 0..BLOCK {
                subtract::<L, FUSED>(sum, columns[c][row].to_double(), &own[c]);
            }
        }
    }
    let columns = panel.chunks_exact(height).zip(own);
    for (values, own) in columns.skip(width / BLOCK * BLOCK) {
        for (sum, value) in sums.iter_mut().zip(&values[width..]) {
            subtract::<L, FUSED>(sum, value.to_double(), own);
        }
    }
    for (&row, sum) in rows.iter().zip(&*sums) {
        add(&mut x[row as usize], sum);
    }
}

/// sum += value.
#[inline(always)]
pub(super) fn add<const L: usize>(sum: &mut Lanes<L>, value: &Lanes<L>) {
    for lane in 0..L {
        sum[lane] += value[lane];
    }
}

/// sum −= factor x.
#[inline(always)]
pub(super) fn subtract<const L: usize, const FUSED: bool>(
    sum: &mut Lanes<L>,
    factor: f64,
    x: &Lanes<L>,
) {
    for lane in 0..L {
        sum[lane] = match FUSED {
            true => (-factor).mul_add(x[lane], sum[lane]),
            false => sum[lane] - factor * x[lane],
        };
    }
}
