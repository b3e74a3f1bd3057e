//! Numeric factorization: front by front, with units side by side.
//!
//! The method is multifrontal (Duff and Reid 1983, Liu 1992). The front of a supernode is the sum
//! of the matrix's entries in its columns and of the updates from the supernodes below. Its columns
//! are eliminated, and the remaining update goes to the supernode above.

use std::sync::atomic::{AtomicBool, Ordering};

use ndarray::Array2;
use pulp::{Arch, Simd, WithSimd};
use sprs::CsMatI;

use crate::error::Result;
use crate::monitor::Stage;
use crate::solver::cholesky::front::{Sums, eliminate, subtract_square};
use crate::solver::cholesky::lanes::{add_left_over, gather, subtract_below};
use crate::solver::cholesky::number::{Number, Numbers, is_fused};
use crate::solver::cholesky::tree::upward;
use crate::solver::cholesky::units::Unit;
use crate::solver::cholesky::wide;

/// A matrix to be factorized.
#[derive(Clone, Copy)]
pub(super) struct Matrix<'a> {
    /// The lower triangle is `scale` times these.
    pub entries: &'a [f64],
    pub scale: f64,
    /// What its rows sum to, (1, V), if the diagonal is to be made from that.
    pub sums: Option<&'a Array2<f64>>,
}

impl<'a> Matrix<'a> {
    /// One with its diagonal.
    pub fn of(lower: &'a CsMatI<f64, u32>) -> Self {
        Self {
            entries: lower.data(),
            scale: 1.0,
            sums: None,
        }
    }
}

/// Factorizes the matrix of these entries; `false` if it is not positive definite.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(super) fn factorize<N: Number>(
    units: &[Unit],
    numbers: &mut [Numbers<N>],
    matrix: Matrix,
    stage: Stage,
) -> Result<bool> {
    let is_definite = AtomicBool::new(true);
    upward(units, units.len() - 1, numbers, &|unit, below, own| {
        if is_definite.load(Ordering::Relaxed) {
            let fronts = Fronts {
                units,
                unit,
                below,
                own,
                matrix,
                stage,
            };
            if !Arch::new().dispatch(fronts) {
                is_definite.store(false, Ordering::Relaxed);
            }
        }
    });
    stage.check()?;
    Ok(is_definite.into_inner())
}

/// The fronts of one unit.
struct Fronts<'a, N> {
    units: &'a [Unit],
    unit: &'a Unit,
    below: &'a [Numbers<N>],
    own: &'a mut Numbers<N>,
    matrix: Matrix<'a>,
    stage: Stage<'a>,
}

impl<N: Number> WithSimd for Fronts<'_, N> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        match is_fused::<S>() {
            true => self.factorize::<true>(),
            false => self.factorize::<false>(),
        }
    }
}

impl<N: Number> Fronts<'_, N> {
    #[inline(always)]
    fn factorize<const FUSED: bool>(self) -> bool {
        let Numbers {
            panels,
            diagonal,
            stack,
            lanes: sums,
        } = self.own;
        panels.fill(N::ZERO);
        let Matrix { entries, scale, .. } = self.matrix;
        for &(entry, place) in &self.unit.entries {
            panels[place as usize] += N::from_double(scale * entries[entry as usize]);
        }
        if let Some(values) = self.matrix.sums {
            gather::<1>(self.unit, values.view(), sums);
            let (sums, _) = sums.as_chunks_mut::<1>();
            add_left_over(self.units, self.unit, self.below, sums);
        }
        let mut room = Vec::new();
        for node in &self.unit.nodes {
            let shape @ (height, width) = (node.height, node.width);
            let size = height - width;
            let panel = &mut panels[node.panel..][..width * height];
            let (finished, rest) = stack.split_at_mut(node.scratch);
            let update = &mut rest[..size * size];
            update.fill(N::ZERO);
            for child in &self.unit.children[node.children..][..node.child_count] {
                let (stack, unit) = match child.unit {
                    None => (&*finished, self.unit),
                    Some(unit) => {
                        let numbers = &self.below[(unit - self.unit.first) as usize];
                        (&numbers.stack[..], &self.units[unit as usize])
                    }
                };
                let left_over = &stack[child.update..][..child.size * child.size];
                let places = &unit.places[child.places..][..child.size];
                add(left_over, places, panel, update, shape);
            }
            let is_wide = wide::is_wide(shape);
            let own_diagonal = &mut diagonal[node.column..][..width];
            let own_sums = self.matrix.sums.map(|_| Sums {
                of_rows: &mut sums[node.column..][..width],
                diagonal: own_diagonal,
            });
            let is_definite = match is_wide {
                true => wide::eliminate::<N, FUSED>(panel, shape, own_sums),
                false => eliminate::<N, FUSED>(panel, shape, own_sums),
            };
            if !is_definite || self.stage.check().is_err() {
                return false;
            }
            match is_wide {
                true => wide::subtract_square(update, size, panel, width),
                false => subtract_square::<N, FUSED>(update, size, panel, shape),
            }
            if self.matrix.sums.is_none() {
                let diagonal = diagonal[node.column..].iter_mut();
                for (value, own) in diagonal.zip(panel.iter().step_by(height + 1).take(width)) {
                    *value = own.to_double();
                }
            } else {
                let rows = &self.unit.rows[node.rows..][..size];
                let (sums, _) = sums.as_chunks_mut::<1>();
                subtract_below::<N, 1, FUSED>(panel, rows, shape, node.column, sums, &mut room);
            }
            stack.copy_within(node.scratch..node.scratch + size * size, node.update);
        }
        true
    }
}

/// Adds what a supernode leaves over to the front above, which consists of `panel` and `update`.
#[inline(always)]
fn add<N: Number>(
    left_over: &[N],
    places: &[u32],
    panel: &mut [N],
    update: &mut [N],
    (height, width): (usize, usize),
) {
    let size = places.len();
    for (column, &place) in places.iter().enumerate() {
        let place = place as usize;
        let values = &left_over[column * size + column..(column + 1) * size];
        let rows = places[column..].iter().zip(values);
        if place < width {
            let target = &mut panel[place * height..][..height];
            rows.for_each(|(&row, &value)| target[row as usize] += value);
        } else {
            let beneath = height - width;
            let target = &mut update[(place - width) * beneath..][..beneath];
            rows.for_each(|(&row, &value)| target[row as usize - width] += value);
        }
    }
}
