//! The energy of a law along a line of states.

use crate::flow::law::Law;
use crate::operators::{Gradient, SideBySide};
use crate::parallel;

/// Faces that are looked at together: their numbers stay in the fastest cache.
const BLOCK: usize = 256;

/// Gradients of u + α δ, by what they are made of on every face.
pub(super) struct Line<'a> {
    law: &'a dyn Law,
    areas: &'a [f64],
    /// |∇u|.
    norms: Vec<f64>,
    /// ⟨∇u, ∇δ⟩ and |∇δ|².
    products: Vec<[f64; 2]>,
}

impl<'a> Line<'a> {
    /// The line from `state` u, where |∇u| is `norms`, along `direction` δ.
    pub fn new(
        law: &'a dyn Law,
        gradient: &'a Gradient,
        norms: Vec<f64>,
        state: &SideBySide,
        direction: &SideBySide,
    ) -> Self {
        let products = gradient.products(state, direction);
        Self::of_products(law, gradient.face_areas(), norms, products)
    }

    /// The line whose ⟨∇u, ∇δ⟩ and |∇δ|² are known.
    pub fn of_products(
        law: &'a dyn Law,
        areas: &'a [f64],
        norms: Vec<f64>,
        products: Vec<[f64; 2]>,
    ) -> Self {
        Self {
            law,
            areas,
            norms,
            products,
        }
    }

    /// [`Self::slope`] for α = 0, given the `weights` there.
    pub fn slope_at_start(&self, weights: &[f64]) -> f64 {
        parallel::sum(weights.len(), |faces| {
            let sizes = self.areas[faces.clone()]
                .iter()
                .zip(&weights[faces.clone()]);
            let faces = sizes.zip(&self.products[faces]);
            faces
                .map(|((area, weight), [along, _])| area * weight * along)
                .sum()
        })
    }

    /// The part of [`Self::slope`] that some faces have.
    fn slope_in(&self, areas: &[f64], norms: &[f64], products: &[[f64; 2]], alpha: f64) -> f64 {
        let mut values = [0.0; BLOCK];
        let values = &mut values[..areas.len()];
        for ((value, norm), [along, squared]) in values.iter_mut().zip(norms).zip(products) {
            let change = alpha * (2.0 * along + alpha * squared);
            *value = (norm * norm + change).max(0.0).sqrt();
        }
        self.law.weigh(values);
        for ((value, area), [along, squared]) in values.iter_mut().zip(areas).zip(products) {
            *value *= area * (along + alpha * squared);
        }
        values.iter().sum()
    }

    /// d/dα Σ_f A Ψ(|∇(u + α δ)|), Ψ′(n) = n w(n).
    pub fn slope(&self, alpha: f64) -> f64 {
        parallel::sum(self.areas.len(), |faces| {
            let areas = self.areas[faces.clone()].chunks(BLOCK);
            let norms = self.norms[faces.clone()].chunks(BLOCK);
            let products = self.products[faces].chunks(BLOCK);
            let blocks = areas.zip(norms).zip(products);
            blocks
                .map(|((areas, norms), products)| self.slope_in(areas, norms, products, alpha))
                .sum()
        })
    }
}
