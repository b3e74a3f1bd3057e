//! The convex problem of one deformation, and the certificate of a solution.

use ndarray::Array2;

use crate::deformation::constraints::Targets;
use crate::discretization::Discretization;
use crate::mesh::TriangleMesh;
use crate::minimization::{Energy, TangentField, Variation, clipping_factors};
use crate::monitor::Stage;
use crate::operators::Mass;

/// An energy below this, relative to the displacements times the size, is rounding.
const UNSTRETCHED: f64 = 1e-9;

/// min Σ A Ψ(|∇d|) + ½ Σ κ |d − c|² over the displacements d that are given at fixed vertices,
/// (C, V) in the coordinates of the targets.
#[derive(Clone, Copy)]
pub(super) struct Problem<'a> {
    pub operators: &'a Discretization,
    pub targets: &'a Targets,
    pub fixed: &'a [bool],
    /// Ψ.
    pub variation: Variation,
}

/// What an algorithm for comparison is given.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    /// The mesh at rest.
    pub mesh: &'a TriangleMesh,
    /// The constraints.
    pub problem: Problem<'a>,
    /// The movement of a vertex at which an iteration ends, relative to the spread of the
    /// displacements asked for.
    pub tolerance: f64,
    /// What is told of the progress.
    pub stage: Stage<'a>,
}

impl<'a> Problem<'a> {
    /// The energy with the given face weights in place of those of Ψ.
    pub fn energy(&self, weights: &'a dyn Fn(&[f64]) -> Vec<f64>) -> Energy<'a> {
        Energy {
            operators: self.operators,
            weights,
            least_weight: self.variation.least_weight(),
            mass: Mass::lumped(&self.targets.springs),
            data: &self.targets.displacements,
            tau: 1.0,
            fixed: self.fixed,
        }
    }

    /// Sets `state` (C, V) at fixed vertices to what is asked for.
    pub fn place_fixed(&self, state: &mut Array2<f64>) {
        for (axis, mut row) in state.rows_mut().into_iter().enumerate() {
            for (vertex, value) in row.iter_mut().enumerate() {
                if self.fixed[vertex] {
                    *value = self.targets.displacements[[axis, vertex]];
                }
            }
        }
    }

    /// The value of the energy at a `state` (C, V) that meets the constraints, length².
    pub fn value(&self, state: &Array2<f64>) -> f64 {
        let gradient = self.operators.gradient();
        let norms = gradient.norms(&state.view().into());
        let areas = gradient.face_areas().iter();
        let variation: f64 = areas
            .zip(norms)
            .map(|(a, n)| a * self.variation.value(n))
            .sum();
        let mut penalty = 0.0;
        for (row, asked) in state
            .rows()
            .into_iter()
            .zip(self.targets.displacements.rows())
        {
            for ((value, asked), spring) in row.iter().zip(asked).zip(&self.targets.springs) {
                penalty += 0.5 * spring * (value - asked).powi(2);
            }
        }
        variation + penalty
    }

    /// How far the energy of `state` can be above the least, relative to it, by the bound that
    /// `field` gives, or by that it is not negative; 0 where nothing is stretched.
    pub fn gap(&self, state: &Array2<f64>, field: &TangentField) -> f64 {
        let value = self.value(state);
        let scale = self.targets.radius * self.operators.area().sqrt();
        match value <= UNSTRETCHED * scale {
            true => 0.0,
            false => ((value - self.lower_bound(state, field)) / value).clamp(0.0, 1.0),
        }
    }

    /// A lower bound of the energy of all displacements that meet the constraints, from a dual
    /// `field`, which is clipped face by face to |z| ≤ 1 for TV.
    ///
    /// A minimiser lies in the convex hull of the displacements asked for, as projecting onto
    /// that raises no term; so a field whose divergence does not vanish at a free vertex costs
    /// no more than that divergence times the radius of a ball around the hull. Obtuse triangles
    /// let minimisers out of the hull, and `state` with them: the ball then holds it too.
    fn lower_bound(&self, state: &Array2<f64>, field: &TangentField) -> f64 {
        let radius = self.targets.radius.max(self.reach(state));
        let gradient = self.operators.gradient();
        let clip = match self.variation.steepest.is_infinite() {
            true => clipping_factors(field),
            false => vec![1.0; gradient.face_areas().len()],
        };
        let forces: Vec<_> = field
            .iter()
            .map(|channel| gradient.adjoint(|face| channel[face].map(|x| clip[face] * x)))
            .collect();
        let mut bound = self.conjugate(field);
        for (vertex, &fixed) in self.fixed.iter().enumerate() {
            let square: f64 = forces.iter().map(|force| force[vertex].powi(2)).sum();
            let towards = |point: &dyn Fn(usize) -> f64| -> f64 {
                let along = forces.iter().enumerate();
                along.map(|(axis, force)| force[vertex] * point(axis)).sum()
            };
            let asked = |axis: usize| self.targets.displacements[[axis, vertex]];
            let spring = self.targets.springs[vertex];
            bound += if fixed {
                towards(&asked)
            } else if spring > 0.0 {
                towards(&asked) - 0.5 * square / spring
            } else {
                towards(&|axis| self.targets.centre[axis]) - radius * square.sqrt()
            };
        }
        bound
    }

    /// How far free vertices get from the centre of the displacements asked for.
    fn reach(&self, state: &Array2<f64>) -> f64 {
        let free = (0..self.fixed.len()).filter(|&vertex| !self.fixed[vertex]);
        let square = |vertex: usize| -> f64 {
            let off = |axis: usize| state[[axis, vertex]] - self.targets.centre[axis];
            (0..state.nrows()).map(|axis| off(axis).powi(2)).sum()
        };
        free.map(square).fold(0.0, f64::max).sqrt()
    }

    /// −Σ A Ψ*(|z|).
    fn conjugate(&self, field: &TangentField) -> f64 {
        let areas = self.operators.gradient().face_areas().iter();
        let conjugates = areas.enumerate().map(|(face, area)| {
            let square: f64 = field.iter().flat_map(|z| z[face]).map(|x| x * x).sum();
            area * self.variation.negative_conjugate(square.sqrt())
        });
        conjugates.sum()
    }
}
