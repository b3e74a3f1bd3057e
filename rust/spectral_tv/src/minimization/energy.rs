//! E(u) = ½‖u − û‖²_M + τ Σ_f A_f Ψ(|∇u|), Ψ′(n) = n w(n): the energy that an implicit step of a
//! flow minimises, and a deformation too.

use ndarray::{Array2, ArrayView2};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::minimization::fields::{TangentField, inner_products, scaled};
use crate::minimization::line_search::least_along;
use crate::monitor::Stage;
use crate::operators::{FaceVector, Mass, inner_product};

/// A convex energy of functions on a mesh, provided that n w(n) grows with n.
#[derive(Clone, Copy)]
pub struct Energy<'a> {
    /// The operators of the mesh.
    pub operators: &'a Discretization,
    /// w of every face, from n = |∇u| there.
    pub weights: &'a dyn Fn(&[f64]) -> Vec<f64>,
    /// The w of steep gradients, on which it no longer depends; 0 if it always does, as 1/|∇u|.
    pub least_weight: f64,
    /// M: how strongly each unknown is drawn to its data; 0 lets it go where it will.
    pub mass: Mass<'a>,
    /// û (C, V).
    pub data: &'a Array2<f64>,
    /// τ.
    pub tau: f64,
    /// Vertices whose value is given; empty if there are none, else V.
    pub fixed: &'a [bool],
}

/// ∇u on every face, channel by channel, and the weights there.
pub struct Slope {
    /// ∇u.
    pub gradients: TangentField,
    /// w(|∇u|).
    pub weights: Vec<f64>,
}

impl Slope {
    /// w ∇u.
    pub fn fluxes(mut self) -> TangentField {
        for channel in &mut self.gradients {
            for (vector, weight) in channel.iter_mut().zip(&self.weights) {
                *vector = scaled(*weight, *vector);
            }
        }
        self.gradients
    }
}

impl Energy<'_> {
    /// The gradients of `state` (C, V).
    pub fn slope(&self, state: ArrayView2<f64>) -> Slope {
        let gradients = self.gradients(state);
        let mut norms = inner_products(&gradients, &gradients);
        norms.iter_mut().for_each(|square| *square = square.sqrt());
        let weights = (self.weights)(&norms);
        Slope { gradients, weights }
    }

    /// −E′(u) = −(M(u − û) + τ Gᵀ A w ∇u), (C, V); 0 at fixed vertices.
    pub fn descent(&self, state: ArrayView2<f64>, slope: &Slope) -> Array2<f64> {
        self.descent_along(state, |channel, face| {
            scaled(slope.weights[face], slope.gradients[channel][face])
        })
    }

    /// −(M(u − û) + τ Gᵀ A z) for a dual `field` z, (C, V); 0 at fixed vertices.
    pub fn descent_of(&self, state: ArrayView2<f64>, field: &TangentField) -> Array2<f64> {
        self.descent_along(state, |channel, face| field[channel][face])
    }

    fn descent_along(
        &self,
        state: ArrayView2<f64>,
        field: impl Fn(usize, usize) -> FaceVector,
    ) -> Array2<f64> {
        let mut descent = self.data - &state;
        for (channel, mut row) in descent.rows_mut().into_iter().enumerate() {
            let flux = self
                .operators
                .gradient()
                .adjoint(|face| field(channel, face));
            self.mass.apply(row.view_mut());
            for (value, flux) in row.iter_mut().zip(flux) {
                *value -= self.tau * flux;
            }
        }
        self.clear_fixed(&mut descent);
        descent
    }

    /// The α in [0, 2] that minimises E(u + α δ). `descent` is −E′(u).
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn line_search(
        &self,
        slope: &Slope,
        direction: &Array2<f64>,
        descent: &Array2<f64>,
        stage: Stage,
    ) -> Result<f64> {
        let start = -inner_product(descent.view(), direction.view());
        let restricted = self.restricted(slope, direction, start, stage)?;
        // Where the slope is 0 the search ends.
        let length = least_along(start, |alpha| match stage.check() {
            Ok(()) => restricted(alpha),
            Err(_) => 0.0,
        });
        stage.check()?;
        Ok(length)
    }

    /// The function α ↦ d/dα E(u + α δ), from per-face products alone; `start` is its value
    /// at 0.
    fn restricted(
        &self,
        slope: &Slope,
        direction: &Array2<f64>,
        start: f64,
        stage: Stage,
    ) -> Result<impl Fn(f64) -> f64 + '_> {
        let changes = stage.pass(|| self.gradients(direction.view()))?;
        let squares = stage.pass(|| inner_products(&slope.gradients, &slope.gradients))?;
        let along = stage.pass(|| inner_products(&slope.gradients, &changes))?;
        let squared = stage.pass(|| inner_products(&changes, &changes))?;
        let quadratic = self.mass.squared_norm(direction.view());
        let areas = self.operators.gradient().face_areas();
        let variation = move |alpha: f64| -> f64 {
            let norms: Vec<f64> = (0..areas.len())
                .map(|f| squares[f] + alpha * (2.0 * along[f] + alpha * squared[f]))
                .map(|square| square.max(0.0).sqrt())
                .collect();
            let weights = (self.weights)(&norms);
            (0..areas.len())
                .map(|f| areas[f] * weights[f] * (along[f] + alpha * squared[f]))
                .sum()
        };
        let linear = start - self.tau * variation(0.0);
        Ok(move |alpha| linear + alpha * quadratic + self.tau * variation(alpha))
    }

    /// Whether a face of weight w is steep.
    pub(super) fn is_steep(&self, weight: f64) -> bool {
        weight <= self.least_weight * (1.0 + f64::EPSILON)
    }

    /// −w′(n)/(n w²) for w = 1/√(n² + ε²), 0 on steep faces.
    pub(super) fn bend(&self, weight: f64) -> f64 {
        if self.is_steep(weight) { 0.0 } else { weight }
    }

    /// Sets `values` (C, V) to 0 at fixed vertices.
    pub(super) fn clear_fixed(&self, values: &mut Array2<f64>) {
        if self.fixed.is_empty() {
            return;
        }
        for mut row in values.rows_mut() {
            for (value, &fixed) in row.iter_mut().zip(self.fixed) {
                if fixed {
                    *value = 0.0;
                }
            }
        }
    }

    /// The gradients of `values` (C, V), channel by channel.
    pub(super) fn gradients(&self, values: ArrayView2<f64>) -> TangentField {
        let gradient = self.operators.gradient();
        values
            .rows()
            .into_iter()
            .map(|u| gradient.apply(u))
            .collect()
    }
}
