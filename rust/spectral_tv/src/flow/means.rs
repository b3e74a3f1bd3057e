//! The mean of every connected component, which L(w) leaves alone: a step's increment x has
//! Σ m x = Σ m (û − u) there.
//!
//! Long steps lose it to rounding, all the more on components that are small: M is then nothing
//! beside τ L, and in single precision far sooner than in double.

use ndarray::parallel::prelude::*;
use ndarray::{Array2, ArrayView2, Axis};

use crate::flow::time_step::TimeStep;
use crate::mesh::{component_count, components_of};
use crate::operators::Discretization;

/// The components of a mesh.
pub(super) struct Means {
    /// The component of every vertex.
    labels: Vec<u32>,
    count: usize,
}

impl Means {
    /// The components of the mesh of these operators.
    pub fn new(operators: &Discretization) -> Self {
        let gradient = operators.gradient();
        let vertices = operators.masses().len();
        let labels = components_of(vertices, gradient.triangles(), gradient.face_areas());
        Self {
            count: component_count(&labels),
            labels,
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
            // Of each component what is missing, its mass, and its largest increment.
            let mut sums = vec![[0.0_f64; 3]; self.count];
            let (mut of, mut missing, mut mass) = (0, 0.0, 0.0);
            let vertices = self.labels.iter().zip(masses);
            let values = increment.iter().zip(data.iter().zip(&state));
            for ((&label, m), (x, (data, state))) in vertices.zip(values) {
                // Neighbours in memory are mostly of one component.
                if label != of {
                    sums[of as usize][0] += std::mem::take(&mut missing);
                    sums[of as usize][1] += std::mem::take(&mut mass);
                    of = label;
                }
                missing += m * (data - state - x);
                mass += m;
            }
            sums[of as usize][0] += missing;
            sums[of as usize][1] += mass;
            sums.iter_mut().for_each(|sum| sum[0] /= sum[1]);
            for (&label, x) in self.labels.iter().zip(&mut increment) {
                let [shift, _, largest] = &mut sums[label as usize];
                *x += *shift;
                *largest = largest.max(x.abs());
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
