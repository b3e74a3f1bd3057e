//! The mean of every connected component. L(w) does not change it, so the increment x of a step has
//! Σ m x = Σ m (û − u) on each component.
//!
//! Long steps lose the mean to rounding, most of all on small components: there M is negligible
//! beside τ L. In single precision that happens far sooner than in double.

use std::ops::Range;

use ndarray::{Array2, ArrayView2};
use rayon::prelude::*;

use crate::discretization::Discretization;
use crate::flow::time_step::TimeStep;
use crate::mesh::{component_count, components_of};
use crate::parallel;

const CONTIGUOUS: &str = "channels are contiguous";

/// The components of a mesh.
pub(super) struct Means {
    /// Vertices that stand together in memory, few enough for one thread, and their component.
    runs: Vec<(Range<usize>, usize)>,
    count: usize,
}

impl Means {
    /// The components of the mesh of these operators.
    pub fn new(operators: &Discretization) -> Self {
        let gradient = operators.gradient();
        let vertices = operators.masses().len();
        let labels = components_of(vertices, gradient.triangles(), gradient.face_areas());
        let mut end = 0;
        let run = |of: &[u32]| {
            let start = end;
            end += of.len();
            let component = of[0] as usize;
            parallel::split(start..end).map(move |run| (run, component))
        };
        Self {
            count: component_count(&labels),
            runs: labels.chunk_by(|a, b| a == b).flat_map(run).collect(),
        }
    }

    /// Whether the mesh is of one piece.
    pub fn is_of_one_component(&self) -> bool {
        self.count == 1
    }

    /// Shifts every component of `increment` (C, V), which starts at the state u, so that it has
    /// the mean that `step` gives it with these `masses`. Returns the largest shift, relative to
    /// the largest increment of the component.
    pub fn restore(
        &self,
        increment: &mut Array2<f64>,
        step: &TimeStep,
        masses: &[f64],
        state: ArrayView2<f64>,
    ) -> f64 {
        let known = step.data.rows().into_iter().zip(state.rows());
        let channels = increment.rows_mut().into_iter().zip(known);
        let shifts = channels.map(|(increment, (data, state))| {
            let increment = increment.into_slice().expect(CONTIGUOUS);
            let known = [data, state].map(|values| values.to_slice().expect(CONTIGUOUS));
            self.restore_channel(increment, known, masses)
        });
        largest_or_nan(shifts)
    }

    fn restore_channel(
        &self,
        increment: &mut [f64],
        [data, state]: [&[f64]; 2],
        masses: &[f64],
    ) -> f64 {
        let missing = self.runs.par_iter().map(|(run, _)| {
            let known = data[run.clone()].iter().zip(&state[run.clone()]);
            let own = masses[run.clone()].iter().zip(&increment[run.clone()]);
            known
                .zip(own)
                .fold([0.0; 2], |sums, ((data, state), (mass, x))| {
                    [sums[0] + mass * (data - state - x), sums[1] + mass]
                })
        });
        let missing: Vec<_> = missing.collect();
        // Of each component what is missing, and its mass.
        let mut sums = vec![[0.0_f64; 2]; self.count];
        for ((_, component), missing) in self.runs.iter().zip(missing) {
            sums[*component][0] += missing[0];
            sums[*component][1] += missing[1];
        }
        let shifts: Vec<f64> = sums.iter().map(|[missing, mass]| missing / mass).collect();
        let mut rest = increment;
        let parts = self.runs.iter().map(|(run, _)| {
            let (part, others) = std::mem::take(&mut rest).split_at_mut(run.len());
            rest = others;
            part
        });
        let parts: Vec<_> = parts.collect();
        let sizes = parts.into_par_iter().zip(&self.runs).map(|(part, run)| {
            let shift = shifts[run.1];
            part.iter_mut().fold(0.0_f64, |max, x| {
                *x += shift;
                max.max(x.abs())
            })
        });
        let sizes: Vec<f64> = sizes.collect();
        let mut largest = vec![0.0_f64; self.count];
        for ((_, component), size) in self.runs.iter().zip(sizes) {
            largest[*component] = largest[*component].max(size);
        }
        let relative = |(shift, largest): (&f64, &f64)| match *shift == 0.0 {
            true => 0.0,
            false => shift.abs() / largest,
        };
        largest_or_nan(shifts.iter().zip(&largest).map(relative))
    }
}

/// The largest of some values of 0 or more; NaN if one is.
fn largest_or_nan(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |max, value| match value > max || value.is_nan() {
        true => value,
        false => max,
    })
}
