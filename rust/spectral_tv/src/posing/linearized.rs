//! The energy near a state: its gradient, and the reweighted Gauss–Newton matrix.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::posing::field::Field;
use crate::posing::model::{Goals, Model};
use crate::posing::numbers::{Corner, FaceModel, Numbers, gathered};
use crate::posing::state::{State, rotated};

/// A quadratic model of the energy. Motions are δx and rotation vectors ω.
pub(super) struct Linearized<'a> {
    pub model: &'a Model,
    pub state: &'a State,
    springs: &'a [f64],
    pub numbers: Numbers,
}

impl<'a> Linearized<'a> {
    pub fn new(model: &'a Model, state: &'a State, goals: &'a Goals) -> Self {
        Self::of(Numbers::new(model, state, goals), model, state, goals)
    }

    /// The one that `numbers` were computed of.
    pub fn of(numbers: Numbers, model: &'a Model, state: &'a State, goals: &'a Goals) -> Self {
        Self {
            model,
            state,
            springs: &goals.springs,
            numbers,
        }
    }

    /// The matrix times a `field` of what moves freely.
    pub fn apply(&self, field: &Field) -> Field {
        let model = self.model;
        let mut moved = field.clone();
        model.expand(self.state, &mut moved);
        let gradient = model.operators.gradient();
        let triangles = gradient.triangles();
        let of_face = |face: usize| {
            let FaceModel {
                weight,
                basis,
                crushed,
            } = self.numbers.face(face);
            let corners = triangles[face].map(|corner| corner as usize);
            let hats = gradient.hats(face);
            let turn =
                (moved.turns[corners[0]] + moved.turns[corners[1]] + moved.turns[corners[2]]) / 3.0;
            let along = |values: &[Vector3<f64>], axis: usize| {
                (0..3)
                    .map(|i| hats[i][axis] * values[corners[i]])
                    .sum::<Vector3<f64>>()
            };
            let columns = [0, 1].map(|axis| along(&moved.moves, axis));
            let mut strain = [0, 1].map(|axis| columns[axis] - turn.cross(&basis[axis]));
            let turning = [0, 1].map(|axis| model.parameters.stiffness * along(&moved.turns, axis));
            let mut torque = -(basis[0].cross(&strain[0]) + basis[1].cross(&strain[1])) / 3.0;
            if let Some(crushed) = &crushed {
                let by_columns = &crushed.by_columns;
                let change = crushed.firmness
                    * (by_columns[0].dot(&columns[0])
                        + by_columns[1].dot(&columns[1])
                        + crushed.by_turn.dot(&turn));
                for (strain, derivative) in strain.iter_mut().zip(by_columns) {
                    *strain += change * derivative;
                }
                torque += change * crushed.by_turn / 3.0;
            }
            [0, 1, 2].map(|i| {
                let force = hats[i][0] * strain[0] + hats[i][1] * strain[1];
                let turn = hats[i][0] * turning[0] + hats[i][1] * turning[1] + torque;
                [weight * force, weight * turn]
            })
        };
        let shares: Vec<[Corner; 3]> = (0..triangles.len())
            .into_par_iter()
            .with_min_len(1 << 11)
            .map(of_face)
            .collect();
        let mut product = gathered(model, &shares);
        for vertex in 0..product.moves.len() {
            let own = moved.moves[vertex];
            product.moves[vertex] += self.numbers.still[vertex] * own;
            let spring = self.springs[vertex];
            if spring > 0.0 {
                let off = match model.pulled_along[vertex] {
                    Some(body) => {
                        let arm = rotated(&self.state.bodies[body as usize], &model.arms[vertex]);
                        let off = own - field.bodies[body as usize].cross(&arm);
                        product.bodies[body as usize] -= arm.cross(&(spring * off));
                        off
                    }
                    None => own,
                };
                product.moves[vertex] += spring * off;
            }
        }
        model.reduce(self.state, &mut product);
        product
    }

    /// By how much the block of movements of a face is larger than its weight, at most.
    pub fn crushing(&self, face: usize) -> f64 {
        match self.numbers.crushed(face) {
            Some(crushed) => {
                let squares = crushed.by_columns.iter().map(Vector3::norm_squared);
                1.0 + crushed.firmness * squares.sum::<f64>()
            }
            None => 1.0,
        }
    }

    /// What stands on the diagonal of δx beside the faces' shares.
    pub fn diagonal(&self, vertex: usize) -> f64 {
        self.numbers.still[vertex] + self.springs[vertex]
    }

    /// The spring at a vertex, and the body it pulls along with.
    pub fn spring(&self, vertex: usize) -> (f64, Option<u32>) {
        (self.springs[vertex], self.model.pulled_along[vertex])
    }
}
