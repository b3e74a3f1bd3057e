//! The energy near a state: its gradient, and the reweighted Gauss–Newton matrix.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::parallel;
use crate::posing::energy::Crushed;
use crate::posing::field::Field;
use crate::posing::model::{Goals, Model, Role};
use crate::posing::state::{State, rotated};

/// A quadratic model of the energy. Motions are δx and rotation vectors ω.
pub(super) struct Linearized<'a> {
    pub model: &'a Model,
    pub state: &'a State,
    springs: &'a [f64],
    pub numbers: Numbers,
}

/// What is computed of it. It can be kept for as long as the state, the goals and the parameters
/// stay.
pub(super) struct Numbers {
    /// E, as [`Model::value`] gives it.
    pub value: f64,
    /// The gradient by what moves freely.
    pub gradient: Field,
    /// Of every face; 0 where it is floating.
    pub faces: Vec<FaceModel>,
    /// Of every vertex: what stillness adds to the diagonal of δx.
    still: Vec<f64>,
}

/// A face's share of the matrix.
#[derive(Clone)]
pub(super) struct FaceModel {
    /// A φ′(e)/e, length².
    pub weight: f64,
    /// R̄ T, two columns.
    pub basis: [Vector3<f64>; 2],
    /// Where the face is crushed.
    pub crushed: Option<Box<Crushed>>,
    /// A φ(e), length².
    cost: f64,
}

type Corner = [Vector3<f64>; 2];

impl Numbers {
    pub fn new(model: &Model, state: &State, goals: &Goals) -> Self {
        let gradient = model.operators.gradient();
        let (triangles, hats) = (gradient.triangles(), gradient.hats());
        let areas = gradient.face_areas();
        let of_face = |face: usize| {
            if !model.is_held(&triangles[face]) {
                let none = FaceModel {
                    weight: 0.0,
                    basis: [Vector3::zeros(); 2],
                    crushed: None,
                    cost: 0.0,
                };
                return (none, [[Vector3::zeros(); 2]; 3]);
            }
            let term = model.face_term(face, state);
            let weight = areas[face] * model.parameters.weight(term.square);
            // −⟨∇x − R̄ T, [θ] R̄ T⟩ = θ · torque, θ the turn of the mean rotation.
            let mut torque = -(0..2)
                .map(|axis| term.basis[axis].cross(&term.strain[axis]))
                .sum::<Vector3<f64>>();
            let mut stress = term.strain;
            if let Some(crushed) = &term.crushed {
                let push = -crushed.firmness * crushed.lack;
                for (stress, derivative) in stress.iter_mut().zip(&crushed.by_columns) {
                    *stress += push * derivative;
                }
                torque += push * crushed.by_turn;
            }
            let upright: f64 = term.apart.iter().map(|q| q.w).sum();
            let hats = &hats[face];
            let corner = |i: usize| {
                let force = hats[i][0] * stress[0] + hats[i][1] * stress[1];
                let (w, v) = (term.apart[i].w, term.apart[i].imag());
                let mut turn = (w * torque + v.cross(&torque)) / upright;
                for j in (0..3).filter(|&j| j != i) {
                    let product = hats[i][0] * hats[j][0] + hats[i][1] * hats[j][1];
                    let (other_w, other) = (term.apart[j].w, term.apart[j].imag());
                    let between = w * other - other_w * v + v.cross(&other);
                    turn += 2.0 * model.parameters.stiffness * product * between;
                }
                [weight * force, weight * turn]
            };
            let face = FaceModel {
                weight,
                cost: areas[face] * model.parameters.cost(&term),
                basis: term.basis,
                crushed: term.crushed.map(Box::new),
            };
            (face, [corner(0), corner(1), corner(2)])
        };
        let (mut faces, mut shares) = (Vec::new(), Vec::new());
        (0..triangles.len())
            .into_par_iter()
            .with_min_len(1 << 11)
            .map(of_face)
            .unzip_into_vecs(&mut faces, &mut shares);
        let value = parallel::sum(faces.len(), |range| {
            faces[range].iter().map(|face| face.cost).sum()
        }) + model.value_at_vertices(state, goals);
        let mut field = gathered(model, &shares);
        let masses = model.operators.masses();
        let parameters = &model.parameters;
        let still = parallel::values(masses.len(), |vertex| {
            let moved = state.positions[vertex] - goals.still[vertex];
            parameters.stillness * masses[vertex]
                / (moved.norm_squared() + parameters.unmoved).sqrt()
        });
        for (vertex, &spring) in goals.springs.iter().enumerate() {
            let moved = state.positions[vertex] - goals.still[vertex];
            field.moves[vertex] += still[vertex] * moved;
            if spring > 0.0 {
                let goal = model.pulled_to(vertex, goals, state);
                let pull = spring * (state.positions[vertex] - goal);
                field.moves[vertex] += pull;
                if let Some(body) = model.pulled_along[vertex] {
                    let arm = goal - goals.centres[body as usize];
                    field.bodies[body as usize] -= arm.cross(&pull);
                }
            }
        }
        model.reduce(state, &mut field);
        Self {
            value,
            gradient: field,
            faces,
            still,
        }
    }
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
        let (triangles, hats) = (gradient.triangles(), gradient.hats());
        let of_face = |face: usize| {
            let FaceModel {
                weight,
                basis,
                crushed,
                ..
            } = &self.numbers.faces[face];
            let corners = triangles[face].map(|corner| corner as usize);
            let hats = &hats[face];
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
            if let Some(crushed) = crushed {
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
                [*weight * force, *weight * turn]
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
        match &self.numbers.faces[face].crushed {
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

/// The sums at every vertex of what its corners have.
fn gathered(model: &Model, shares: &[[Corner; 3]]) -> Field {
    let sum = |vertex: usize| {
        let mut sum = [Vector3::zeros(); 2];
        if model.roles[vertex] != Role::Floating {
            for (face, corner) in model.corners.around(vertex) {
                let [force, turn] = shares[face][corner];
                sum[0] += force;
                sum[1] += turn;
            }
        }
        sum
    };
    let sums = parallel::values(model.rest.len(), sum);
    let (moves, turns) = sums.into_iter().map(|[force, turn]| (force, turn)).unzip();
    Field {
        moves,
        turns,
        bodies: vec![Vector3::zeros(); model.body_count],
    }
}
