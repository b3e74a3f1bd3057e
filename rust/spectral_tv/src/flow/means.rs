//! The mean of every connected component, which L(w) leaves alone: a step's increment x has
//! Σ m x = Σ m (û − u) there.
//!
//! Long steps lose it to rounding, all the more on components that are small: M is then nothing
//! beside τ L, and in single precision far sooner than in double.

use std::ops::Range;

use ndarray::parallel::prelude::*;
use ndarray::{Array2, ArrayView1, ArrayView2, Axis, Slice, Zip};

use crate::flow::time_step::TimeStep;
use crate::mesh::{component_count, components_of};
use crate::operators::Discretization;

/// The components of a mesh.
pub(super) struct Means {
    /// Vertices that stand together in memory, and their component.
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
            (start..end, of[0] as usize)
        };
        Self {
            count: component_count(&labels),
            runs: labels.chunk_by(|a, b| a == b).map(run).collect(),
        }
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
        let rows = increment.axis_iter_mut(Axis(0)).into_par_iter();
        let rows = rows.zip(step.data.axis_iter(Axis(0)).into_par_iter());
        let rows = rows.zip(state.axis_iter(Axis(0)).into_par_iter());
        let shifts = rows.map(|((mut increment, data), state)| {
            let part = |run: &Range<usize>| Slice::from(run.clone());
            // Of each component what is missing, its mass, and its largest increment.
            let mut sums = vec![[0.0_f64; 3]; self.count];
            let off = Zip::from(&increment)
                .and(data)
                .and(state)
                .map_collect(|x, data, state| data - state - x);
            for (run, component) in &self.runs {
                let masses = ArrayView1::from(&masses[run.clone()]);
                sums[*component][0] += off.slice_axis(Axis(0), part(run)).dot(&masses);
                sums[*component][1] += masses.sum();
            }
            sums.iter_mut().for_each(|sum| sum[0] /= sum[1]);
            for (run, component) in &self.runs {
                let [shift, _, largest] = &mut sums[*component];
                let mut increment = increment.slice_axis_mut(Axis(0), part(run));
                increment += *shift;
                let size = increment.fold(0.0_f64, |max, x| max.max(x.abs()));
                *largest = largest.max(size);
            }
            let relative = |[shift, _, largest]: &[f64; 3]| match *shift == 0.0 {
                true => 0.0,
                false => shift.abs() / largest,
            };
            sums.iter().map(relative).fold(0.0, f64::max)
        });
        shifts.collect::<Vec<f64>>().into_iter().fold(0.0, f64::max)
    }
}
