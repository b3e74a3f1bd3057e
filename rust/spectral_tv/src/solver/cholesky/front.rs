//! Dense kernels on the fronts of supernodes: columns of a triangle, one after another in memory.
//!
//! Sums have the same order whatever the width of registers. All functions are inlined into a
//! caller that is compiled for the processor's instructions. `FUSED` says whether these multiply
//! and add at once.

use crate::solver::cholesky::number::Number;

/// Columns that are eliminated before those to their right are updated.
const BLOCK: usize = 8;
/// Rows in double and in single precision, and columns, that are kept in registers.
const TALL: usize = 8;
const TALL_SINGLE: usize = 16;
const WIDE: usize = 4;
/// Parts of a sum that do not wait for each other.
const PARTS: usize = 8;

/// Factorizes the leading columns of a front: `panel` holds its first `width` columns, of `height`
/// rows, and then those of L, reciprocals in place of the diagonal's entries. Entries above it
/// have no meaning. `false` if the matrix is not positive definite.
///
/// Where `sums` are given, the diagonal is made from them.
#[inline(always)]
pub(super) fn eliminate<N: Number, const FUSED: bool>(
    panel: &mut [N],
    (height, width): (usize, usize),
    mut sums: Option<Sums>,
) -> bool {
    for first in (0..width).step_by(BLOCK) {
        let count = BLOCK.min(width - first);
        let (known, rest) = panel.split_at_mut(first * height);
        let block = &mut rest[..count * height];
        if first > 0 {
            subtract_products::<N, FUSED>(
                &mut block[first..],
                height,
                (height - first, count),
                &known[first..],
                height,
                first,
            );
        }
        for column in 0..count {
            let (left, right) = block.split_at_mut((column + 1) * height);
            let pivot = &mut left[column * height + first + column..];
            let (diagonal, below) = pivot
                .split_first_mut()
                .expect("the panel is as high as wide");
            let place = first + column;
            if let Some(sums) = &sums {
                *diagonal = N::from_double(sums.of_rows[place] - total(below));
            }
            if !(*diagonal > N::ZERO && diagonal.is_usable()) {
                return false;
            }
            let scale = diagonal.root().inverse();
            *diagonal = scale;
            for value in &mut *below {
                *value = (*value * scale).cleared();
            }
            if let Some(sums) = &mut sums {
                sums.settle(place, below);
            }
            for other in column + 1..count {
                let factor = below[other - column - 1];
                let below = &below[other - column - 1..];
                let start = (other - column - 1) * height + first + other;
                for (target, &value) in right[start..].iter_mut().zip(below) {
                    *target -= factor * value;
                }
            }
        }
    }
    true
}

/// What the first rows of a front sum to, and the reciprocals of L's diagonal that are made from it.
///
/// If no entry beside the diagonal is positive, nothing is subtracted (Grassmann, Taksar and Heyman 1985; Alfa,
/// Xue and Ye 2002). L Lᵀ has just these sums, in double precision, whatever rounding does to the other entries.
/// So the error is that of a small relative change of what couples the rows.
pub(super) struct Sums<'a> {
    /// Afterwards L⁻¹ times them.
    pub of_rows: &'a mut [f64],
    pub diagonal: &'a mut [f64],
}

impl Sums<'_> {
    /// Goes on from the sum s of the row at `place` to those after it, where L has the column (d, `below`): both
    /// d y = s and d + Σ `below` = y = (Lᵀ 1)_place.
    #[inline(always)]
    pub fn settle<N: Number>(&mut self, place: usize, below: &[N]) {
        let (own, rest) = self.of_rows[place..].split_first_mut().expect("a row");
        let off = total(below);
        let scale = 2.0 / ((off * off + 4.0 * *own).sqrt() - off);
        self.diagonal[place] = scale;
        *own *= scale;
        for (sum, value) in rest.iter_mut().zip(below) {
            *sum -= value.to_double() * *own;
        }
    }
}

/// Σ values.
#[inline(always)]
pub(super) fn total<N: Number>(values: &[N]) -> f64 {
    let (blocks, rest) = values.as_chunks::<PARTS>();
    let mut parts = [0.0; PARTS];
    for block in blocks {
        for part in 0..PARTS {
            parts[part] += block[part].to_double();
        }
    }
    for (part, value) in parts.iter_mut().zip(rest) {
        *part += value.to_double();
    }
    // By halves: none waits long for another.
    for half in [PARTS / 2, PARTS / 4, PARTS / 8] {
        for part in 0..half {
            parts[part] += parts[part + half];
        }
    }
    parts[0]
}

/// `update` −= A Aᵀ in and below the diagonal, where A are the rows of `panel` below its diagonal
/// block, `size` of them.
#[inline(always)]
pub(super) fn subtract_square<N: Number, const FUSED: bool>(
    update: &mut [N],
    size: usize,
    panel: &[N],
    (height, width): (usize, usize),
) {
    let left = &panel[width..];
    subtract_products::<N, FUSED>(update, size, (size, size), left, height, width);
}

/// `target` −= A Bᵀ in and below the diagonal, for `shape` rows and columns, where A are the
/// leading rows of `depth` columns at `left`, and B the first of these.
#[inline(always)]
fn subtract_products<N: Number, const FUSED: bool>(
    target: &mut [N],
    target_height: usize,
    (rows, columns): (usize, usize),
    left: &[N],
    left_height: usize,
    depth: usize,
) {
    let mut column = 0;
    while column < columns {
        let count = WIDE.min(columns - column);
        let mut end = rows;
        // From the bottom: what the last rows write above the diagonal has no meaning there.
        while end > column {
            let at = (end, column);
            let sides = (&mut *target, target_height, left, left_height, depth);
            end -= match (count, end) {
                (WIDE, TALL_SINGLE..) if N::IS_SINGLE => {
                    tile::<N, FUSED, TALL_SINGLE, WIDE>(sides, at)
                }
                (WIDE, TALL..) => tile::<N, FUSED, TALL, WIDE>(sides, at),
                (WIDE, 4..) => tile::<N, FUSED, 4, WIDE>(sides, at),
                (WIDE, _) => tile::<N, FUSED, 1, WIDE>(sides, at),
                (3, TALL..) => tile::<N, FUSED, TALL, 3>(sides, at),
                (3, _) => tile::<N, FUSED, 1, 3>(sides, at),
                (2, TALL..) => tile::<N, FUSED, TALL, 2>(sides, at),
                (2, _) => tile::<N, FUSED, 1, 2>(sides, at),
                (_, TALL..) => tile::<N, FUSED, TALL, 1>(sides, at),
                _ => tile::<N, FUSED, 1, 1>(sides, at),
            };
        }
        column += count;
    }
}

/// Target, its height, A, its height, its columns.
type Sides<'a, N> = (&'a mut [N], usize, &'a [N], usize, usize);

/// The R rows before `end` of C columns; returns R.
#[inline(always)]
fn tile<N: Number, const FUSED: bool, const R: usize, const C: usize>(
    (target, target_height, left, left_height, depth): Sides<N>,
    (end, column): (usize, usize),
) -> usize {
    let start = end - R;
    let mut sums = [[N::ZERO; R]; C];
    for values in left.chunks(left_height).take(depth) {
        let above: &[N; R] = values[start..end].try_into().expect("R rows");
        let beside: &[N; C] = values[column..column + C].try_into().expect("C columns");
        for c in 0..C {
            for r in 0..R {
                sums[c][r] = match FUSED {
                    true => above[r].fused(beside[c], sums[c][r]),
                    false => sums[c][r] + above[r] * beside[c],
                };
            }
        }
    }
    for (c, sums) in sums.iter().enumerate() {
        let place = (column + c) * target_height + start;
        for (value, &sum) in target[place..place + R].iter_mut().zip(sums) {
            *value -= sum;
        }
    }
    R
}
