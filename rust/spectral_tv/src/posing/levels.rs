//! The fine and the coarse mesh of one problem, and what solves on them.

use nalgebra::Vector3;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::mesh::TriangleMesh;
use crate::monitor::Stage;
use crate::posing::coarse::CoarseSystem;
use crate::posing::decimation::decimate;
use crate::posing::handles::Handles;
use crate::posing::lift::Lift;
use crate::posing::model::{Corners, Goals, Model, Parameters, Role};
use crate::posing::smoother::Smoother;

/// Vertices of the coarse mesh.
const COARSE: usize = 800;

/// Both meshes.
pub(super) struct Levels {
    pub fine: Model,
    pub coarse: Model,
    pub lift: Lift,
    pub system: CoarseSystem,
    pub smoother: Smoother,
}

impl Levels {
    pub fn new(
        mesh: &TriangleMesh,
        handles: &Handles,
        parameters: Parameters,
        stage: Stage,
    ) -> Result<Self> {
        let rest: Vec<Vector3<f64>> = mesh.vertices().iter().map(|&p| p.into()).collect();
        let held = mesh.triangles().iter().zip(mesh.face_areas());
        let held: Vec<[u32; 3]> = held
            .filter(|(corners, area)| {
                **area > 0.0 && handles.roles[corners[0] as usize] != Role::Floating
            })
            .map(|(corners, _)| *corners)
            .collect();
        let label = |role: &Role| match role {
            Role::Free | Role::Floating => 0,
            Role::Pinned | Role::Fixed => 1,
            Role::Body(body) => 2 + body,
        };
        let labels: Vec<u32> = handles.roles.iter().map(label).collect();
        let decimated = decimate(&rest, &held, &labels, COARSE, stage)?;
        let lift = Lift::new(&rest, &decimated);
        let coarse_triangles = decimated.triangles.iter();
        let coarse_mesh = TriangleMesh::new(
            lift.taken(mesh.vertices()),
            &coarse_triangles
                .map(|corners| corners.map(i64::from))
                .collect::<Vec<_>>(),
        )?;
        let coarse = Model {
            operators: Discretization::new_with(&coarse_mesh, stage)?,
            rest: lift.taken(&rest),
            roles: lift.taken(&handles.roles),
            arms: lift.taken(&handles.arms),
            pulled_along: lift.taken(&handles.pulled_along),
            body_count: handles.bodies.len(),
            corners: Corners::new(decimated.vertices.len(), coarse_mesh.triangles(), stage)?,
            parameters: parameters.coarse(),
        };
        let fine = Model {
            operators: Discretization::new_with(mesh, stage)?,
            roles: handles.roles.clone(),
            arms: handles.arms.clone(),
            pulled_along: handles.pulled_along.clone(),
            body_count: handles.bodies.len(),
            corners: Corners::new(rest.len(), mesh.triangles(), stage)?,
            parameters,
            rest,
        };
        Ok(Self {
            system: CoarseSystem::new(&coarse, stage)?,
            smoother: Smoother::new(&fine, stage)?,
            lift,
            coarse,
            fine,
        })
    }

    pub fn set_parameters(&mut self, parameters: Parameters) {
        self.fine.parameters = parameters;
        self.coarse.parameters = parameters.coarse();
    }

    /// The goals of the coarse mesh: a vertex is pulled by the springs of those it stands for.
    pub fn coarse_goals(&self, goals: &Goals) -> Goals {
        let (lift, fine, coarse) = (&self.lift, &self.fine, &self.coarse);
        let pull = |vertex: usize| {
            let spring = goals.springs[vertex];
            let off = goals.positions[vertex] - fine.rest[vertex];
            (spring * off).push(spring)
        };
        let mut positions = lift.taken(&goals.positions);
        let mut springs = vec![0.0; positions.len()];
        for (vertex, pull) in lift.shared(pull).into_iter().enumerate() {
            if coarse.roles[vertex] == Role::Free && pull.w > 0.0 {
                springs[vertex] = pull.w;
                positions[vertex] = coarse.rest[vertex] + pull.xyz() / pull.w;
            }
        }
        Goals {
            positions,
            rotations: lift.taken(&goals.rotations),
            springs,
            centres: goals.centres.clone(),
            still: lift.taken(&goals.still),
        }
    }
}
