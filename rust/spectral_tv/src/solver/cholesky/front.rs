//! Dense kernels on the fronts of supernodes: columns of a triangle, one after another in memory.
//!
//! Sums have the same order whatever the width of registers. All functions are inlined into a
//! caller that is compiled for the processor's instructions. `FUSED` says whether these multiply
//! and add at once.

/// Columns that are eliminated before those to their right are updated.
const BLOCK: usize = 8;
/// Rows and columns that are kept in registers.
const TALL: usize = 8;
const WIDE: usize = 4;

/// Factorizes the leading columns of a front: `panel` holds its first `width` columns, of `height`
/// rows, and then those of L, reciprocals in place of the diagonal's entries. Entries above it
/// have no meaning. `false` if the matrix is not positive definite.
#[inline(always)]
pub(super) fn eliminate<const FUSED: bool>(panel: &mut [f64], height: usize, width: usize) -> bool {
    for first in (0..width).step_by(BLOCK) {
        let count = BLOCK.min(width - first);
        let (known, rest) = panel.split_at_mut(first * height);
        let block = &mut rest[..count * height];
        if first > 0 {
            subtract_products::<FUSED>(
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
            if !(*diagonal > 0.0 && diagonal.is_finite()) {
                return false;
            }
            let scale = diagonal.sqrt().recip();
            *diagonal = scale;
            for value in &mut *below {
                *value *= scale;
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

/// `update` −= A Aᵀ in and below the diagonal, where A are the rows of `panel` below its diagonal
/// block, `size` of them.
#[inline(always)]
pub(super) fn subtract_square<const FUSED: bool>(
    update: &mut [f64],
    size: usize,
    panel: &[f64],
    (height, width): (usize, usize),
) {
    let left = &panel[width..];
    subtract_products::<FUSED>(update, size, (size, size), left, height, width);
}

/// `target` −= A Bᵀ in and below the diagonal, for `shape` rows and columns, where A are the
/// leading rows of `depth` columns at `left`, and B the first of these.
#[inline(always)]
fn subtract_products<const FUSED: bool>(
    target: &mut [f64],
    target_height: usize,
    (rows, columns): (usize, usize),
    left: &[f64],
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
                (WIDE, TALL..) => tile::<FUSED, TALL, WIDE>(sides, at),
                (WIDE, 4..) => tile::<FUSED, 4, WIDE>(sides, at),
                (WIDE, _) => tile::<FUSED, 1, WIDE>(sides, at),
                (3, TALL..) => tile::<FUSED, TALL, 3>(sides, at),
                (3, _) => tile::<FUSED, 1, 3>(sides, at),
                (2, TALL..) => tile::<FUSED, TALL, 2>(sides, at),
                (2, _) => tile::<FUSED, 1, 2>(sides, at),
                (_, TALL..) => tile::<FUSED, TALL, 1>(sides, at),
                _ => tile::<FUSED, 1, 1>(sides, at),
            };
        }
        column += count;
    }
}

/// Target, its height, A, its height, its columns.
type Sides<'a> = (&'a mut [f64], usize, &'a [f64], usize, usize);

/// The R rows before `end` of C columns; returns R.
#[inline(always)]
fn tile<const FUSED: bool, const R: usize, const C: usize>(
    (target, target_height, left, left_height, depth): Sides,
    (end, column): (usize, usize),
) -> usize {
    let start = end - R;
    let mut sums = [[0.0; R]; C];
    for values in left.chunks(left_height).take(depth) {
        let above: &[f64; R] = values[start..end].try_into().expect("R rows");
        let beside: &[f64; C] = values[column..column + C].try_into().expect("C columns");
        for c in 0..C {
            for r in 0..R {
                sums[c][r] = match FUSED {
                    true => above[r].mul_add(beside[c], sums[c][r]),
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
