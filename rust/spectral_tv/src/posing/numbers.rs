//! What a quadratic model of the energy near a state is computed of.

use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::parallel;
use crate::posing::field::Field;
use crate::posing::lanes::{LANES, Lanes, Vectors};
use crate::posing::model::{Goals, Model, Role};
use crate::posing::state::State;

/// The numbers of a quadratic model. They can be kept for as long as the state, the goals and the
/// parameters stay.
pub(super) struct Numbers {
    /// E, as [`Model::value`] gives it.
    pub value: f64,
    /// The gradient by what moves freely.
    pub gradient: Field,
    /// Of all faces, as many in each as there are lanes.
    faces: Vec<FaceModels>,
    /// Of every vertex: what stillness adds to the diagonal of δx.
    pub still: Vec<f64>,
}

/// What some faces add to the matrix.
struct FaceModels {
    /// A φ′(e)/e, length²; 0 where a face is floating.
    weights: Lanes,
    /// R̄ T, two columns.
    basis: [Vectors; 2],
    /// Where a face is crushed.
    crushed: Option<Box<CrushedFaces>>,
    /// A φ(e), length².
    costs: Lanes,
}

struct CrushedFaces {
    /// 0 where a face is not crushed.
    firmness: Lanes,
    by_columns: [Vectors; 2],
    by_turn: Vectors,
}

/// A face's share of the matrix.
pub(super) struct FaceModel {
    /// A φ′(e)/e, length²; 0 where it is floating.
    pub weight: f64,
    /// R̄ T, two columns.
    pub basis: [Vector3<f64>; 2],
    /// Where it is crushed.
    pub crushed: Option<Crushed>,
}

/// How a face that is about to turn over resists.
pub(super) struct Crushed {
    /// The derivative of the cost by lack², relative to that of φ(e) by e².
    pub firmness: f64,
    /// The derivatives of J by the two columns of ∇x, and by a turn of R̄.
    pub by_columns: [Vector3<f64>; 2],
    pub by_turn: Vector3<f64>,
}

/// What a corner is pushed and turned by.
pub(super) type Corner = [Vector3<f64>; 2];

impl Numbers {
    pub fn new(model: &Model, state: &State, goals: &Goals) -> Self {
        let blocks = model
            .operators
            .gradient()
            .face_areas()
            .len()
            .div_ceil(LANES);
        let processor = Arch::new();
        let (mut faces, mut shares) = (Vec::new(), Vec::new());
        (0..blocks)
            .into_par_iter()
            .with_min_len(1 << 9)
            .map(|block| {
                let first = block * LANES;
                processor.dispatch(Faces {
                    model,
                    state,
                    first,
                })
            })
            .unzip_into_vecs(&mut faces, &mut shares);
        let value = parallel::sum(faces.len(), |range| {
            let faces = faces[range].iter();
            faces.map(|faces| faces.costs.sum()).sum()
        }) + model.value_at_vertices(state, goals);
        let mut field = gathered(model, shares.as_flattened());
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

    /// A φ′(e)/e of a face, length²; 0 where it is floating.
    pub fn weight(&self, face: usize) -> f64 {
        self.faces[face / LANES].weights.0[face % LANES]
    }

    /// Of a face.
    pub fn face(&self, face: usize) -> FaceModel {
        let (faces, lane) = (&self.faces[face / LANES], face % LANES);
        FaceModel {
            weight: faces.weights.0[lane],
            basis: [faces.basis[0].lane(lane), faces.basis[1].lane(lane)],
            crushed: self.crushed(face),
        }
    }

    /// Of a face that is crushed.
    pub fn crushed(&self, face: usize) -> Option<Crushed> {
        let lane = face % LANES;
        let faces = self.faces[face / LANES].crushed.as_deref()?;
        let [first, second] = &faces.by_columns;
        (faces.firmness.0[lane] > 0.0).then(|| Crushed {
            firmness: faces.firmness.0[lane],
            by_columns: [first.lane(lane), second.lane(lane)],
            by_turn: faces.by_turn.lane(lane),
        })
    }
}

/// The faces from `first` on.
struct Faces<'a> {
    model: &'a Model,
    state: &'a State,
    first: usize,
}

impl WithSimd for Faces<'_> {
    type Output = (FaceModels, [[Corner; 3]; LANES]);

    /// What they add to the matrix, and to the gradient at their corners.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _processor: S) -> Self::Output {
        let Self {
            model,
            state,
            first,
        } = self;
        let terms = model.face_terms(first, state);
        let (hats, apart, basis) = (&terms.hats, &terms.apart, &terms.basis);
        let weights = terms.areas * terms.weight;
        // What crushing pushes, relative to φ′(e)/e.
        let push = terms.lack / terms.weight * -model.parameters.crushing;
        let stress = [
            terms.strain[0] + terms.by_columns[0] * push,
            terms.strain[1] + terms.by_columns[1] * push,
        ];
        // −⟨∇x − R̄ T, [θ] R̄ T⟩ = θ · torque, θ the turn of the mean rotation.
        let torque = terms.strain[0].cross(basis[0]) + terms.strain[1].cross(basis[1]);
        let torque = torque + terms.by_turn * push;
        let upright = (apart[0].w + apart[1].w + apart[2].w).recip();
        let stiffness = 2.0 * model.parameters.stiffness;
        let mut turns = [torque; 3];
        let mut forces = [torque; 3];
        for i in 0..3 {
            let (w, v) = (apart[i].w, apart[i].v);
            turns[i] = (torque * w + v.cross(torque)) * upright;
            forces[i] = stress[0] * (hats[i][0] * weights) + stress[1] * (hats[i][1] * weights);
        }
        for i in 0..3 {
            let j = (i + 1) % 3;
            let product = hats[i][0] * hats[j][0] + hats[i][1] * hats[j][1];
            let (one, other) = (apart[i], apart[j]);
            let between = other.v * one.w - one.v * other.w + one.v.cross(other.v);
            let between = between * (product * stiffness);
            turns[i] = turns[i] + between;
            turns[j] = turns[j] - between;
        }
        for turn in &mut turns {
            *turn = *turn * weights;
        }
        let mut shares = [[[Vector3::zeros(); 2]; 3]; LANES];
        for (lane, shares) in shares.iter_mut().enumerate() {
            for (corner, share) in shares.iter_mut().enumerate() {
                *share = [forces[corner].lane(lane), turns[corner].lane(lane)];
            }
        }
        let is_crushed = terms
            .lack
            .0
            .iter()
            .zip(weights.0)
            .any(|(&lack, weight)| lack > 0.0 && weight > 0.0);
        let firmness = Lanes::of(|lane| match terms.lack.0[lane] > 0.0 {
            true => model.parameters.crushing / terms.weight.0[lane],
            false => 0.0,
        });
        let faces = FaceModels {
            weights,
            basis: terms.basis,
            crushed: is_crushed.then(|| {
                Box::new(CrushedFaces {
                    firmness,
                    by_columns: terms.by_columns,
                    by_turn: terms.by_turn,
                })
            }),
            costs: terms.areas * terms.cost,
        };
        (faces, shares)
    }
}

/// The sums at every vertex of what its corners have.
pub(super) fn gathered(model: &Model, shares: &[[Corner; 3]]) -> Field {
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
