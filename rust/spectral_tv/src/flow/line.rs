//! The law's energy along a line of states.

use rayon::prelude::*;

use crate::flow::law::Law;

/// Faces that one thread works on at a time.
const CHUNK: usize = 1 << 13;

/// Gradients of u + α δ, by what they are made of on every face.
pub(super) struct Line<'a> {
    pub law: &'a dyn Law,
    pub areas: &'a [f64],
    /// |∇u|.
    pub norms: Vec<f64>,
    /// ⟨∇u, ∇δ⟩.
    pub along: Vec<f64>,
    /// |∇δ|².
    pub squared: Vec<f64>,
}

impl Line<'_> {
    /// [`Self::slope`] for α = 0, given the `weights` there.
    pub fn slope_at_start(&self, weights: &[f64]) -> f64 {
        let parts = weights
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, weights)| {
                let faces = (chunk * CHUNK..).zip(weights);
                let terms = faces.map(|(f, weight)| self.areas[f] * weight * self.along[f]);
                terms.sum::<f64>()
            });
        parts.collect::<Vec<_>>().iter().sum()
    }

    /// d/dα Σ_f A Ψ(|∇(u + α δ)|), Ψ′(n) = n w(n).
    pub fn slope(&self, alpha: f64) -> f64 {
        let starts = (0..self.areas.len()).into_par_iter().step_by(CHUNK);
        let parts = starts.map(|start| {
            let faces = start..(start + CHUNK).min(self.areas.len());
            let norm = |f: usize| {
                let change = alpha * (2.0 * self.along[f] + alpha * self.squared[f]);
                (self.norms[f] * self.norms[f] + change).max(0.0).sqrt()
            };
            let norms: Vec<f64> = faces.clone().map(norm).collect();
            let weights = self.law.weights(&norms);
            let terms = faces.zip(weights).map(|(f, weight)| {
                self.areas[f] * weight * (self.along[f] + alpha * self.squared[f])
            });
            terms.sum::<f64>()
        });
        parts.collect::<Vec<_>>().iter().sum()
    }
}
