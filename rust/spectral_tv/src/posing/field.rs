//! Small motions of all vertices: a tangent vector of the space of poses, or a gradient.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::parallel;

/// A movement and a turn of every vertex, and a turn of every free body.
#[derive(Debug, Clone)]
pub(super) struct Field {
    pub moves: Vec<Vector3<f64>>,
    pub turns: Vec<Vector3<f64>>,
    pub bodies: Vec<Vector3<f64>>,
}

impl Field {
    pub fn zeros(vertices: usize, bodies: usize) -> Self {
        Self {
            moves: vec![Vector3::zeros(); vertices],
            turns: vec![Vector3::zeros(); vertices],
            bodies: vec![Vector3::zeros(); bodies],
        }
    }

    pub fn dot(&self, other: &Self) -> f64 {
        let bodies = self.bodies.iter().zip(&other.bodies);
        parallel::sum(self.moves.len(), |range| {
            let one = self.moves[range.clone()].iter();
            let moves: f64 = one
                .zip(&other.moves[range.clone()])
                .map(|(a, b)| a.dot(b))
                .sum();
            let one = self.turns[range.clone()].iter();
            let turns: f64 = one.zip(&other.turns[range]).map(|(a, b)| a.dot(b)).sum();
            moves + turns
        }) + bodies.map(|(a, b)| a.dot(b)).sum::<f64>()
    }

    /// Adds `scale` times `other`.
    pub fn add(&mut self, scale: f64, other: &Self) {
        self.combine(other, |a, b| *a += scale * b);
    }

    /// Takes `other` plus `scale` times itself.
    pub fn scale_and_add(&mut self, scale: f64, other: &Self) {
        self.combine(other, |a, b| *a = scale * *a + b);
    }

    /// The opposite one.
    pub fn reversed(mut self) -> Self {
        for vectors in [&mut self.moves, &mut self.turns, &mut self.bodies] {
            parallel::for_each(vectors.par_iter_mut(), |vector| *vector = -*vector);
        }
        self
    }

    fn combine(
        &mut self,
        other: &Self,
        with: impl Fn(&mut Vector3<f64>, &Vector3<f64>) + Sync + Send,
    ) {
        for (to, from) in [
            (&mut self.moves, &other.moves),
            (&mut self.turns, &other.turns),
            (&mut self.bodies, &other.bodies),
        ] {
            parallel::for_each(to.par_iter_mut().zip(from), |(a, b)| with(a, b));
        }
    }
}
