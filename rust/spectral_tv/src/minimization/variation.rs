//! Ψ, the weighting of a gradient of size n = |∇u|.

use std::ops::RangeInclusive;

use crate::parallel;

/// Values of ε that can be squared; gradients that can not are refused before.
const PLAIN: RangeInclusive<f64> = 1e-145..=1e145;

/// Total variation, smoothed where the gradient vanishes and, if asked, held back where it is
/// steep: Ψ′(n) = n/√(n² + ε²), which is about 1, up to n = g and n/g beyond.
///
/// Owen 2007, "A robust hybrid of lasso and ridge regression" calls it, for ε = 0, the reversed
/// Huber function: pieces stay constant as with TV, but what changes between them does so no more
/// steeply than about g, where TV would jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variation {
    /// ε ≥ 0, in the unit of the gradient.
    pub epsilon: f64,
    /// g; infinite for TV.
    pub steepest: f64,
}

impl Variation {
    /// TV smoothed by `epsilon`.
    pub fn smoothed(epsilon: f64) -> Self {
        Self {
            epsilon,
            steepest: f64::INFINITY,
        }
    }

    /// w = Ψ′(n)/n of every face.
    pub fn weights(&self, gradient_norms: &[f64]) -> Vec<f64> {
        parallel::changed(gradient_norms, |norms| self.weigh(norms))
    }

    /// Replaces n of some faces by w.
    pub fn weigh(&self, gradient_norms: &mut [f64]) {
        // Copies, so that they stay in registers.
        let Self { epsilon, steepest } = *self;
        let weight = |smoothed: f64| smoothed.min(steepest).recip();
        if PLAIN.contains(&epsilon) {
            let square = epsilon * epsilon;
            for norm in gradient_norms {
                *norm = weight((*norm * *norm + square).sqrt());
            }
        } else {
            for norm in gradient_norms {
                *norm = weight(self.smoothed_norm(*norm));
            }
        }
    }

    /// √(n² + ε²), as `hypot`, which is slower and in nothing better here.
    #[inline]
    fn smoothed_norm(&self, norm: f64) -> f64 {
        let (short, long) = match norm < self.epsilon {
            true => (norm, self.epsilon),
            false => (self.epsilon, norm),
        };
        match long == 0.0 {
            true => 0.0,
            false => long * (1.0 + (short / long).powi(2)).sqrt(),
        }
    }

    /// The weight of steep gradients, 1/g, on which w no longer depends.
    pub fn least_weight(&self) -> f64 {
        self.steepest.recip()
    }

    /// Ψ(n).
    pub fn value(&self, norm: f64) -> f64 {
        let smoothed = self.smoothed_norm(norm);
        match smoothed <= self.steepest {
            true => smoothed,
            false => 0.5 * norm * norm / self.steepest + self.offset(),
        }
    }

    /// −Ψ*(|z|), Ψ* the convex conjugate; for TV, |z| counts as 1 where it is more.
    pub fn negative_conjugate(&self, dual_norm: f64) -> f64 {
        let square = dual_norm * dual_norm;
        let turn = 1.0 - (self.epsilon / self.steepest).powi(2);
        match square <= turn || self.steepest.is_infinite() {
            true => self.epsilon * (1.0 - square).max(0.0).sqrt(),
            false => self.offset() - 0.5 * self.steepest * square,
        }
    }

    /// What makes Ψ continuous at g.
    fn offset(&self) -> f64 {
        0.5 * (self.steepest + self.epsilon * self.epsilon / self.steepest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_conjugate_is_the_greatest_distance_from_a_line() {
        for steepest in [f64::INFINITY, 2.0] {
            let variation = Variation {
                epsilon: 0.1,
                steepest,
            };
            for slope in [0.0, 0.3, 0.9, 0.99] {
                let least = (0..400_000)
                    .map(|i| 1e-4 * f64::from(i))
                    .map(|n| variation.value(n) - slope * n)
                    .fold(f64::INFINITY, f64::min);
                assert!((variation.negative_conjugate(slope) - least).abs() < 1e-6);
            }
        }
        let limited = Variation {
            epsilon: 0.1,
            steepest: 2.0,
        };
        let least = (0..100_000)
            .map(|i| 1e-4 * f64::from(i))
            .map(|n| limited.value(n) - 1.5 * n)
            .fold(f64::INFINITY, f64::min);
        assert!((limited.negative_conjugate(1.5) - least).abs() < 1e-6);
    }

    #[test]
    fn weights_are_the_derivative() {
        let variation = Variation {
            epsilon: 0.2,
            steepest: 1.5,
        };
        for norm in [0.05, 0.5, 1.0, 1.4, 2.0, 5.0] {
            let slope = (variation.value(norm + 1e-6) - variation.value(norm - 1e-6)) / 2e-6;
            assert!((variation.weights(&[norm])[0] * norm - slope).abs() < 1e-8);
        }
    }
}
