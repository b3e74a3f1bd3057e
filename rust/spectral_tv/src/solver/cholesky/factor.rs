//! Numeric factorization: front by front, with units side by side.
//!
//! The method is multifrontal (Duff and Reid 1983, Liu 1992). The front of a supernode is the sum
//! of the matrix's entries in its columns and of the updates from the supernodes below. Its columns
//! are eliminated, and the remaining update goes to the supernode above.

use std::sync::atomic::{AtomicBool, Ordering};

use pulp::{Arch, Simd, WithSimd};

use crate::error::Result;
use crate::memory::zeros;
use crate::monitor::Stage;
use crate::solver::cholesky::front::{eliminate, subtract_square};
use crate::solver::cholesky::tree::upward;
use crate::solver::cholesky::units::Unit;
use crate::solver::cholesky::wide;

/// The numbers of one unit.
#[derive(Debug)]
pub(super) struct Numbers {
    /// The columns of L, supernode by supernode.
    pub panels: Vec<f64>,
    /// Updates in the making; at last that of the root, at the start.
    stack: Vec<f64>,
    /// The functions solved for, in columns and boundary.
    pub lanes: Vec<f64>,
}

impl Numbers {
    /// For a unit.
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub fn new(unit: &Unit, what: &str, advice: &str) -> Result<Self> {
        Ok(Self {
            panels: zeros(unit.panel_length, what, advice)?,
            stack: zeros(unit.stack_length, what, advice)?,
            lanes: Vec::new(),
        })
    }
}

/// Factorizes the matrix of these entries; `false` if it is not positive definite.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(super) fn factorize(
    units: &[Unit],
    numbers: &mut [Numbers],
    entries: &[f64],
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
                entries,
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
struct Fronts<'a> {
    units: &'a [Unit],
    unit: &'a Unit,
    below: &'a [Numbers],
    own: &'a mut Numbers,
    entries: &'a [f64],
    stage: Stage<'a>,
}

impl WithSimd for Fronts<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        match is_fused::<S>() {
            true => self.factorize::<true>(),
            false => self.factorize::<false>(),
        }
    }
}

impl Fronts<'_> {
    #[inline(always)]
    fn factorize<const FUSED: bool>(self) -> bool {
        let Numbers { panels, stack, .. } = self.own;
        panels.fill(0.0);
        for &(entry, place) in &self.unit.entries {
            panels[place as usize] += self.entries[entry as usize];
        }
        for node in &self.unit.nodes {
            let shape @ (height, width) = (node.height, node.width);
            let size = height - width;
            let panel = &mut panels[node.panel..][..width * height];
            let (finished, rest) = stack.split_at_mut(node.scratch);
            let update = &mut rest[..size * size];
            update.fill(0.0);
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
            let is_definite = match is_wide {
                true => wide::eliminate(panel, height, width),
                false => eliminate::<FUSED>(panel, height, width),
            };
            if !is_definite || self.stage.check().is_err() {
                return false;
            }
            match is_wide {
                true => wide::subtract_square(update, size, panel, width),
                false => subtract_square::<FUSED>(update, size, panel, shape),
            }
            stack.copy_within(node.scratch..node.scratch + size * size, node.update);
        }
        true
    }
}

/// Whether a processor multiplies and adds at once: all with wide registers do.
#[inline(always)]
fn is_fused<S: Simd>() -> bool {
    S::F64_LANES > 1
}

/// Adds what a supernode leaves over to the front above, which consists of `panel` and `update`.
#[inline(always)]
fn add(
    left_over: &[f64],
    places: &[u32],
    panel: &mut [f64],
    update: &mut [f64],
    (height, width): (usize, usize),
) {
    let size = places.len();
    for (column, &place) in places.iter().enumerate() {
        let place = place as usize;
        let values = &left_over[column * size + column..(column + 1) * size];
        let rows = places[column..].iter().zip(values);
        if place < width {
            let target = &mut panel[place * height..][..height];
            rows.for_each(|(&row, value)| target[row as usize] += value);
        } else {
            let beneath = height - width;
            let target = &mut update[(place - width) * beneath..][..beneath];
            rows.for_each(|(&row, value)| target[row as usize - width] += value);
        }
    }
}
