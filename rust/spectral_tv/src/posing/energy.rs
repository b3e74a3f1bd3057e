//! The energy of a pose, face by face.

use std::ops::Range;

use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};

use crate::parallel;
use crate::posing::lanes::{LANES, Lanes, Places, Quaternions, Vectors};
use crate::posing::model::{Goals, Model, Parameters, Role};
use crate::posing::state::State;

/// What some faces add to the energy, and what its derivatives need.
pub(super) struct FaceTerms {
    /// The gradients of their hat functions, in their planes.
    pub hats: [[Lanes; 2]; 3],
    /// The corners' rotations from the mean one.
    pub apart: [Quaternions; 3],
    /// R̄ T, two columns.
    pub basis: [Vectors; 2],
    /// ∇x − R̄ T, two columns.
    pub strain: [Vectors; 2],
    /// e² of strain and turning, without ε.
    pub square: Lanes,
    /// How much less the ratio J of areas, in the plane of R̄ T, is than the least that costs
    /// nothing; 0 where it is not less.
    pub lack: Lanes,
    /// The derivatives of J by the two columns of ∇x, and by a turn of R̄.
    pub by_columns: [Vectors; 2],
    pub by_turn: Vectors,
    /// φ′(e)/e.
    pub weight: Lanes,
    /// φ(e) − φ(ε), and what crushing costs.
    pub cost: Lanes,
    /// A; 0 where a face is of no component with a handle, or there is none.
    pub areas: Lanes,
}

/// J below which crushing costs, so that faces do not turn over at the inner side of a joint.
const LEAST_AREA: f64 = 0.4;

impl Model {
    /// What the faces from `first` on are in `state`, as many as there are lanes.
    #[inline(always)]
    pub fn face_terms(&self, first: usize, state: &State) -> FaceTerms {
        let gradient = self.operators.gradient();
        let (triangles, all_hats) = (gradient.triangles(), gradient.later_hats());
        let last = triangles.len() - 1;
        let mut faces = [last; LANES];
        let mut corners = [[0; LANES]; 3];
        let mut areas = Lanes::all(0.0);
        for lane in 0..LANES {
            faces[lane] = last.min(first + lane);
            let triangle = &triangles[faces[lane]];
            for (places, &corner) in corners.iter_mut().zip(triangle) {
                places[lane] = corner as usize;
            }
            if first + lane <= last && self.is_held(triangle) {
                areas.0[lane] = gradient.face_areas()[faces[lane]];
            }
        }
        let mut hats = [[Lanes::all(0.0); 2]; 3];
        let [first_hat, later_hats @ ..] = &mut hats;
        for (corner, hat) in later_hats.iter_mut().enumerate() {
            for (axis, lanes) in hat.iter_mut().enumerate() {
                *lanes = Lanes::of(|lane| all_hats[faces[lane]][corner][axis]);
            }
        }
        for (axis, lanes) in first_hat.iter_mut().enumerate() {
            *lanes = Lanes::all(0.0) - (later_hats[0][axis] + later_hats[1][axis]);
        }
        let a = Quaternions::of(&state.rotations, &corners[0]);
        let b = Quaternions::of(&state.rotations, &corners[1]).aligned(a);
        let c = Quaternions::of(&state.rotations, &corners[2]).aligned(a);
        let mean = (a + b + c).normalized();
        let apart = [a.from(mean), b.from(mean), c.from(mean)];
        let tangents = columns(&self.rest, &corners, &hats);
        let basis = [mean.rotated(tangents[0]), mean.rotated(tangents[1])];
        let deformed = columns(&state.positions, &corners, &hats);
        let strain = [deformed[0] - basis[0], deformed[1] - basis[1]];
        let normal = basis[0].cross(basis[1]);
        let area = deformed[0].cross(deformed[1]);
        // A degenerate face has little area at rest.
        let lack = normal.norm_squared() * LEAST_AREA - normal.dot(area);
        let parameters = &self.parameters;
        let lack = match parameters.crushing > 0.0 {
            true => lack.map(|lack| if lack > 0.0 { lack } else { 0.0 }),
            false => Lanes::all(0.0),
        };
        let square = strain[0].norm_squared()
            + strain[1].norm_squared()
            + turning(&apart, &hats) * parameters.stiffness;
        let e = (square + parameters.unstrained).sqrt();
        FaceTerms {
            hats,
            apart,
            basis,
            strain,
            square,
            lack,
            by_columns: [deformed[1].cross(normal), normal.cross(deformed[0])],
            by_turn: normal.cross(area),
            weight: e.recip() + parameters.softness,
            // Of differences, so that digits are left near rest.
            cost: square / (e + parameters.unstrained.sqrt())
                + (square * parameters.softness + lack * lack * parameters.crushing) * 0.5,
            areas,
        }
    }

    /// E of a state that meets the goals, above what ε alone gives, length².
    pub fn value(&self, state: &State, goals: &Goals) -> f64 {
        let blocks = self.operators.gradient().face_areas().len().div_ceil(LANES);
        let processor = Arch::new();
        let faces = parallel::sum(blocks, |range| {
            processor.dispatch(Costs {
                model: self,
                state,
                blocks: range,
            })
        });
        faces + self.value_at_vertices(state, goals)
    }

    /// What stillness and springs cost, length².
    pub fn value_at_vertices(&self, state: &State, goals: &Goals) -> f64 {
        let masses = self.operators.masses();
        let of_vertex = |vertex: usize| {
            let moved = state.positions[vertex] - goals.still[vertex];
            let still = self.parameters.stillness
                * masses[vertex]
                * self.parameters.moved(moved.norm_squared());
            let spring = match goals.springs[vertex] > 0.0 {
                true => {
                    let off = state.positions[vertex] - self.pulled_to(vertex, goals, state);
                    0.5 * goals.springs[vertex] * off.norm_squared()
                }
                false => 0.0,
            };
            still + spring
        };
        parallel::sum(masses.len(), |range| {
            range
                .filter(|&vertex| self.roles[vertex] != Role::Floating)
                .map(of_vertex)
                .sum()
        })
    }

    /// Whether a face is of a component with a handle.
    pub fn is_held(&self, corners: &[u32; 3]) -> bool {
        self.roles[corners[0] as usize] != Role::Floating
    }
}

impl Parameters {
    /// √(|x − p|² + (0.01 D)²) − 0.01 D.
    #[inline]
    fn moved(&self, square: f64) -> f64 {
        square / ((square + self.unmoved).sqrt() + self.unmoved.sqrt())
    }
}

/// The costs of some blocks of faces.
struct Costs<'a> {
    model: &'a Model,
    state: &'a State,
    blocks: Range<usize>,
}

impl WithSimd for Costs<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _processor: S) -> f64 {
        let mut sum = Lanes::all(0.0);
        for block in self.blocks {
            let terms = self.model.face_terms(block * LANES, self.state);
            sum = sum + terms.areas * terms.cost;
        }
        sum.sum()
    }
}

/// The gradients of `values` at the corners of faces, two columns.
#[inline(always)]
fn columns(values: &[Vector3<f64>], corners: &[Places; 3], hats: &[[Lanes; 2]; 3]) -> [Vectors; 2] {
    let origin = Vectors::of(values, &corners[0]);
    let j = Vectors::of(values, &corners[1]) - origin;
    let k = Vectors::of(values, &corners[2]) - origin;
    [
        j * hats[1][0] + k * hats[2][0],
        j * hats[1][1] + k * hats[2][1],
    ]
}

/// |∇R|², the squared angle by length: 4 |∇q|² of unit quaternions q.
#[inline(always)]
fn turning(apart: &[Quaternions; 3], hats: &[[Lanes; 2]; 3]) -> Lanes {
    let (j, k) = (apart[1] - apart[0], apart[2] - apart[0]);
    let first = j * hats[1][0] + k * hats[2][0];
    let second = j * hats[1][1] + k * hats[2][1];
    (first.dot(first) + second.dot(second)) * 4.0
}
