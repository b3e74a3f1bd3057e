//! What does not change while a mesh is posed: its operators, its rest, and what holds it.

use nalgebra::{Quaternion, Vector3};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::monitor::Stage;
use crate::operators::grouped;
use crate::parallel;
use crate::posing::field::Field;
use crate::posing::settings::Settings;
use crate::posing::state::{State, rotated, turned};

/// ε, a strain that is not told from none.
const EPSILON: f64 = 0.01;
/// A movement, relative to the diagonal, that is not told from none.
const UNMOVED: f64 = 0.01;

/// What may move at a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// All.
    Free,
    /// Its rotation; its position is given.
    Pinned,
    /// Nothing, as its position and rotation are given.
    Fixed,
    /// It goes with a free body, whose centre is given.
    Body(u32),
    /// Nothing, as no handle is in its component.
    Floating,
}

/// A mesh, fine or coarse.
pub(super) struct Model {
    pub operators: Discretization,
    /// p, V.
    pub rest: Vec<Vector3<f64>>,
    pub roles: Vec<Role>,
    /// From the centre at rest of the free body that a vertex is of, or is pulled towards.
    pub arms: Vec<Vector3<f64>>,
    /// The free body that a soft vertex is pulled along with.
    pub pulled_along: Vec<Option<u32>>,
    pub body_count: usize,
    /// Faces × 3 + corners around each vertex, and where each vertex's begin.
    pub corners: Corners,
    pub parameters: Parameters,
}

/// The parameters of the energy as numbers with units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parameters {
    /// ℓ², length².
    pub stiffness: f64,
    /// s.
    pub softness: f64,
    /// ρ/D, 1/length.
    pub stillness: f64,
    /// (0.01 D)², length².
    pub unmoved: f64,
    /// ε².
    pub unstrained: f64,
    /// What crushing costs, as s is what strain costs. Nothing on a coarse mesh, whose faces turn
    /// over where a fine one folds.
    pub crushing: f64,
}

/// That of the fine mesh, relative to s.
const CRUSHING: f64 = 40.0;

impl Parameters {
    pub fn new(settings: &Settings, diagonal: f64) -> Self {
        Self {
            stiffness: (settings.stiffness * diagonal).powi(2),
            softness: settings.joint_softness,
            stillness: settings.stillness / diagonal,
            unmoved: (UNMOVED * diagonal).powi(2),
            unstrained: EPSILON * EPSILON,
            crushing: CRUSHING * settings.joint_softness,
        }
    }
}

impl Parameters {
    /// The same for a coarse mesh.
    pub fn coarse(self) -> Self {
        Self {
            crushing: 0.0,
            ..self
        }
    }
}

/// Where handles are taken.
#[derive(Debug, Clone)]
pub(super) struct Goals {
    /// Of fixed and pinned vertices, and of soft ones that no body pulls along, V.
    pub positions: Vec<Vector3<f64>>,
    /// Of fixed vertices, as unit quaternions, V.
    pub rotations: Vec<Quaternion<f64>>,
    /// κ of ½ Σ κ |x − t|², 0 where there is no spring, V.
    pub springs: Vec<f64>,
    /// Of the free bodies.
    pub centres: Vec<Vector3<f64>>,
    /// Where each vertex would be if it moved with most of what is held: p of stillness, V.
    pub still: Vec<Vector3<f64>>,
}

impl Model {
    /// Where a spring pulls a vertex.
    pub fn pulled_to(&self, vertex: usize, goals: &Goals, state: &State) -> Vector3<f64> {
        match self.pulled_along[vertex] {
            Some(body) => {
                let body = body as usize;
                goals.centres[body] + rotated(&state.bodies[body], &self.arms[vertex])
            }
            None => goals.positions[vertex],
        }
    }

    /// Puts what handles prescribe into a state.
    pub fn place(&self, goals: &Goals, state: &mut State) {
        for (vertex, role) in self.roles.iter().enumerate() {
            match *role {
                Role::Pinned => state.positions[vertex] = goals.positions[vertex],
                Role::Fixed => {
                    state.positions[vertex] = goals.positions[vertex];
                    state.rotations[vertex] = goals.rotations[vertex];
                }
                Role::Body(body) => {
                    let rotation = state.bodies[body as usize];
                    let arm = rotated(&rotation, &self.arms[vertex]);
                    state.positions[vertex] = goals.centres[body as usize] + arm;
                    state.rotations[vertex] = rotation;
                }
                Role::Free | Role::Floating => {}
            }
        }
    }

    /// The state that a field times `length` leads to.
    pub fn moved(&self, state: &State, field: &Field, length: f64, goals: &Goals) -> State {
        let further = |rotation: &Quaternion<f64>, turn: &Vector3<f64>| {
            turned(rotation, &(length * turn)).normalize()
        };
        let vertices = parallel::values(state.positions.len(), |vertex| {
            (
                state.positions[vertex] + length * field.moves[vertex],
                further(&state.rotations[vertex], &field.turns[vertex]),
            )
        });
        let (positions, rotations) = vertices.into_iter().unzip();
        let bodies = state.bodies.iter().zip(&field.bodies);
        let mut next = State {
            positions,
            rotations,
            bodies: bodies.map(|(body, turn)| further(body, turn)).collect(),
        };
        self.place(goals, &mut next);
        next
    }

    /// The arm of a vertex of a body as it is turned now.
    fn arm(&self, vertex: usize, body: u32, state: &State) -> Vector3<f64> {
        rotated(&state.bodies[body as usize], &self.arms[vertex])
    }

    /// Keeps of a gradient by all vertices what is by those that move freely, and by the bodies.
    pub fn reduce(&self, state: &State, field: &mut Field) {
        for (vertex, role) in self.roles.iter().enumerate() {
            if let Role::Body(body) = *role {
                let arm = self.arm(vertex, body, state);
                let torque = field.turns[vertex] + arm.cross(&field.moves[vertex]);
                field.bodies[body as usize] += torque;
            }
        }
        self.mask(field);
    }

    /// Takes out of a field what vertices do not do by themselves.
    pub fn mask(&self, field: &mut Field) {
        for (vertex, role) in self.roles.iter().enumerate() {
            match role {
                Role::Free => {}
                Role::Pinned => field.moves[vertex] = Vector3::zeros(),
                Role::Fixed | Role::Body(_) | Role::Floating => {
                    field.moves[vertex] = Vector3::zeros();
                    field.turns[vertex] = Vector3::zeros();
                }
            }
        }
    }

    /// Has the vertices of bodies move as these do.
    pub fn expand(&self, state: &State, field: &mut Field) {
        for (vertex, role) in self.roles.iter().enumerate() {
            if let Role::Body(body) = *role {
                let turn = field.bodies[body as usize];
                field.turns[vertex] = turn;
                field.moves[vertex] = turn.cross(&self.arm(vertex, body, state));
            }
        }
    }
}

/// The corners of faces around every vertex.
pub(super) struct Corners {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Corners {
    /// Those of `triangles` between so many vertices.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(vertex_count: usize, triangles: &[[u32; 3]], stage: Stage) -> Result<Self> {
        let (starts, corners) = grouped(triangles.as_flattened(), vertex_count, stage)?;
        Ok(Self { starts, corners })
    }

    /// Face and corner of each, in the order of faces.
    pub fn around(&self, vertex: usize) -> impl Iterator<Item = (usize, usize)> {
        let range = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
        let corners = self.corners[range].iter();
        corners.map(|&corner| (corner as usize / 3, corner as usize % 3))
    }
}
