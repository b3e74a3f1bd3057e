//! The energy of a pose, face by face.

use nalgebra::{Quaternion, Vector3};

use crate::operators::FaceVector;
use crate::parallel;
use crate::posing::model::{Goals, Model, Parameters, Role};
use crate::posing::state::{State, aligned, normalized, rotated};

/// What a face adds to the energy, and what its derivatives need.
pub(super) struct FaceTerm {
    /// The corners' rotations from the mean one, as quaternions.
    pub apart: [Quaternion<f64>; 3],
    /// R̄ T, two columns.
    pub basis: [Vector3<f64>; 2],
    /// ∇x − R̄ T, two columns.
    pub strain: [Vector3<f64>; 2],
    /// e² of strain and turning, without ε.
    pub square: f64,
    /// How the area changes, where it is crushed.
    pub crushed: Option<Crushed>,
}

/// A face that is about to turn over.
#[derive(Debug, Clone)]
pub(super) struct Crushed {
    /// How much less the ratio J of areas, in the plane of R̄ T, is than the least that costs
    /// nothing.
    pub lack: f64,
    /// The derivative of the cost by lack², relative to that of φ(e) by e².
    pub firmness: f64,
    /// The derivatives of J by the two columns of ∇x, and by a turn of R̄.
    pub by_columns: [Vector3<f64>; 2],
    pub by_turn: Vector3<f64>,
}

/// J below which crushing costs, so that faces do not turn over at the inner side of a joint.
const LEAST_AREA: f64 = 0.4;

impl Model {
    /// What face `face` is in `state`.
    #[inline]
    pub fn face_term(&self, face: usize, state: &State) -> FaceTerm {
        let gradient = self.operators.gradient();
        let corners = gradient.triangles()[face].map(|corner| corner as usize);
        let hats = &gradient.hats()[face];
        let first = state.rotations[corners[0]];
        let rotations = corners.map(|corner| aligned(state.rotations[corner], &first));
        let mean = normalized(rotations[0] + rotations[1] + rotations[2]);
        let apart = rotations.map(|rotation| rotation * mean.conjugate());
        let edge = |from: &[Vector3<f64>], corner: usize| from[corners[corner]] - from[corners[0]];
        let columns =
            |[j, k]: [Vector3<f64>; 2]| [0, 1].map(|axis| hats[1][axis] * j + hats[2][axis] * k);
        let tangents = columns([1, 2].map(|corner| edge(&self.rest, corner)));
        let basis = tangents.map(|tangent| rotated(&mean, &tangent));
        let deformed = columns([1, 2].map(|corner| edge(&state.positions, corner)));
        let strain = [0, 1].map(|axis| deformed[axis] - basis[axis]);
        let normal = basis[0].cross(&basis[1]);
        let area = deformed[0].cross(&deformed[1]);
        // A degenerate face has little area at rest.
        let lack = LEAST_AREA * normal.norm_squared() - normal.dot(&area);
        let square = strain[0].norm_squared()
            + strain[1].norm_squared()
            + self.parameters.stiffness * turning(&apart, hats);
        let crushing = self.parameters.crushing;
        let crushed = (lack > 0.0 && crushing > 0.0).then(|| Crushed {
            lack,
            firmness: crushing / self.parameters.weight(square),
            by_columns: [deformed[1].cross(&normal), normal.cross(&deformed[0])],
            by_turn: normal.cross(&area),
        });
        FaceTerm {
            crushed,
            apart,
            basis,
            strain,
            square,
        }
    }

    /// E of a state that meets the goals, above what ε alone gives, length².
    pub fn value(&self, state: &State, goals: &Goals) -> f64 {
        let areas = self.operators.gradient().face_areas();
        let triangles = self.operators.gradient().triangles();
        let faces = parallel::sum(areas.len(), |range| {
            range
                .filter(|&face| self.is_held(&triangles[face]))
                .map(|face| areas[face] * self.parameters.cost(&self.face_term(face, state)))
                .sum()
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
    /// φ(e) − φ(ε), and what crushing costs.
    #[inline]
    pub fn cost(&self, term: &FaceTerm) -> f64 {
        let square = term.square;
        let e = (square + self.unstrained).sqrt();
        let lack = term.crushed.as_ref().map_or(0.0, |crushed| crushed.lack);
        // Of differences, so that digits are left near rest.
        square / (e + self.unstrained.sqrt())
            + 0.5 * (self.softness * square + self.crushing * lack * lack)
    }

    /// φ′(e)/e.
    #[inline]
    pub fn weight(&self, square: f64) -> f64 {
        (square + self.unstrained).sqrt().recip() + self.softness
    }

    /// √(|x − p|² + (0.01 D)²) − 0.01 D.
    #[inline]
    fn moved(&self, square: f64) -> f64 {
        square / ((square + self.unmoved).sqrt() + self.unmoved.sqrt())
    }
}

/// |∇R|², the squared angle by length: 4 |∇q|² of unit quaternions q.
#[inline]
fn turning(apart: &[Quaternion<f64>; 3], hats: &[FaceVector; 3]) -> f64 {
    let (j, k) = ((apart[1] - apart[0]).coords, (apart[2] - apart[0]).coords);
    let along = |axis: usize| (hats[1][axis] * j + hats[2][axis] * k).norm_squared();
    4.0 * (along(0) + along(1))
}
