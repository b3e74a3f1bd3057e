//! What holds a mesh while it is posed.

use nalgebra::{Quaternion, Vector3};

use crate::deformation::Constraints;
use crate::error::{ArgumentError, Result};
use crate::mesh::TriangleMesh;
use crate::posing::frames::Frames;
use crate::posing::model::{Goals, Role};
use crate::posing::motion::{Motion, Pair, common_motion};
use crate::posing::state::State;
use crate::posing::waypoints::Groups;

/// Constrained vertices, and which of them turn freely.
#[derive(Debug, Clone)]
pub struct Handles {
    pub(super) constraints: Constraints,
    pub(super) roles: Vec<Role>,
    pub(super) arms: Vec<Vector3<f64>>,
    pub(super) pulled_along: Vec<Option<u32>>,
    /// Of every free body: its entries, and where the mean of them is at rest.
    pub(super) bodies: Vec<Body>,
    frames: Frames,
    groups: Groups,
    rest: Vec<Vector3<f64>>,
    masses: Vec<f64>,
    diagonal: f64,
}

#[derive(Debug, Clone)]
pub(super) struct Body {
    pub vertices: Vec<usize>,
    pub centre: Vector3<f64>,
}

impl Handles {
    /// Constrains `indices`, with weights as [`Constraints::new`] takes them. `bodies` has a number
    /// for each: −1 for one that goes to its target, turned as the faces between such ones are.
    /// Those with the same other number are one rigid body that turns as it likes. Its centre goes
    /// to the mean of their targets. Soft ones are pulled along with it.
    ///
    /// # Errors
    /// As [`Constraints::new`]; if there is not one number per constrained vertex, one is below −1,
    /// or a vertex is in two bodies.
    pub fn new(
        mesh: &TriangleMesh,
        indices: &[i64],
        weights: Option<&[f64]>,
        bodies: Option<&[i64]>,
    ) -> Result<Self> {
        let constraints = Constraints::new(mesh, indices, weights)?;
        let rest: Vec<Vector3<f64>> = mesh.vertices().iter().map(|&p| p.into()).collect();
        let none = vec![-1; indices.len()];
        let numbers = bodies.unwrap_or(&none);
        if numbers.len() != indices.len() {
            let must = format!(
                "must have one number per constrained vertex ({})",
                indices.len()
            );
            return Err(ArgumentError::value("bodies", must, numbers.len()).into());
        }
        let mut known: Vec<i64> = numbers.iter().copied().filter(|&n| n >= 0).collect();
        known.sort_unstable();
        known.dedup();
        let mut roles: Vec<Role> = constraints
            .floating()
            .iter()
            .map(|&floating| if floating { Role::Floating } else { Role::Free })
            .collect();
        let of_entries: Vec<Option<u32>> = numbers
            .iter()
            .map(|number| known.binary_search(number).ok().map(|body| body as u32))
            .collect();
        let mut pulled_along = vec![None; rest.len()];
        let mut of_body = vec![None; rest.len()];
        for (entry, (&vertex, &body)) in constraints.vertices().iter().zip(&of_entries).enumerate()
        {
            let number = numbers[entry];
            if number < -1 {
                let name = format!("bodies[{entry}]");
                return Err(ArgumentError::value(name, "must be −1 or more", number).into());
            }
            let is_exact = constraints.is_exact(entry);
            match (is_exact, body) {
                (true, None) => roles[vertex] = Role::Fixed,
                (true, Some(body)) if roles[vertex] != Role::Fixed => {
                    roles[vertex] = Role::Body(body);
                }
                (false, Some(body)) => pulled_along[vertex] = Some(body),
                _ => {}
            }
            if let Some(body) = body {
                if of_body[vertex].is_some_and(|other| other != body) {
                    return Err(ArgumentError::contradiction(
                        format!("bodies[{entry}]"),
                        &["indices"],
                        format!("vertex {vertex} is in two free bodies"),
                    )
                    .into());
                }
                of_body[vertex] = Some(body);
            }
        }
        let frames = Frames::new(mesh, &roles);
        for (vertex, role) in roles.iter_mut().enumerate() {
            if *role == Role::Fixed && !frames.are_at(vertex) {
                *role = Role::Pinned;
            }
        }
        let of = |body: u32, is_wanted: &dyn Fn(usize) -> bool| -> Vec<usize> {
            let vertices = of_body.iter().enumerate();
            vertices
                .filter(|(vertex, own)| **own == Some(body) && is_wanted(*vertex))
                .map(|(vertex, _)| vertex)
                .collect()
        };
        let bodies: Vec<Body> = (0..known.len() as u32)
            .map(|body| {
                let mut vertices = of(body, &|vertex| roles[vertex] == Role::Body(body));
                if vertices.is_empty() {
                    vertices = of(body, &|_| true);
                }
                let sum: Vector3<f64> = vertices.iter().map(|&vertex| rest[vertex]).sum();
                Body {
                    centre: sum / vertices.len() as f64,
                    vertices,
                }
            })
            .collect();
        let mut arms = vec![Vector3::zeros(); rest.len()];
        for vertex in 0..rest.len() {
            if !matches!(roles[vertex], Role::Body(_)) && roles[vertex] != Role::Free {
                pulled_along[vertex] = None;
            }
            let body = match roles[vertex] {
                Role::Body(body) => {
                    pulled_along[vertex] = None;
                    Some(body)
                }
                _ => pulled_along[vertex],
            };
            if let Some(body) = body {
                arms[vertex] = rest[vertex] - bodies[body as usize].centre;
            }
        }
        Ok(Self {
            masses: mesh.vertex_areas().to_vec(),
            diagonal: diagonal(&rest),
            frames,
            groups: Groups::new(mesh, constraints.vertices(), &of_entries),
            constraints,
            roles,
            arms,
            pulled_along,
            bodies,
            rest,
        })
    }

    /// Whether each vertex is in a connected component without constraints: it goes with the
    /// surface nearest to it.
    pub fn floating(&self) -> &[bool] {
        self.constraints.floating()
    }

    /// The diagonal of the bounding box, D.
    pub(super) fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// What is given before anything moves.
    pub(super) fn at_rest(&self) -> (State, Goals) {
        let state = State::at_rest(&self.rest, self.bodies.len());
        let goals = Goals {
            positions: self.rest.clone(),
            rotations: vec![Quaternion::identity(); self.rest.len()],
            still: self.rest.clone(),
            springs: vec![0.0; self.rest.len()],
            centres: self.bodies.iter().map(|body| body.centre).collect(),
        };
        (state, goals)
    }

    /// Where target `positions` take what is held, and the motion that most of it has in common.
    pub(super) fn goals(&self, positions: &[[f64; 3]]) -> Result<(Goals, Motion)> {
        let targets = self.constraints.targets(positions)?;
        let moved = |vertex: usize| {
            Vector3::from_fn(|axis, _| targets.displacements[[axis, vertex]]) + self.rest[vertex]
        };
        let positions: Vec<Vector3<f64>> = (0..self.rest.len()).map(moved).collect();
        let centres: Vec<Vector3<f64>> = self
            .bodies
            .iter()
            .map(|body| {
                let sum: Vector3<f64> = body.vertices.iter().map(|&v| positions[v]).sum();
                sum / body.vertices.len() as f64
            })
            .collect();
        let motion = self.common_motion(&positions, &centres);
        let goals = Goals {
            still: self.rest.iter().map(|p| motion.applied(p)).collect(),
            rotations: self.frames.rotations(&positions),
            positions,
            springs: targets.springs,
            centres,
        };
        Ok((goals, motion))
    }

    /// Places on the way to target `positions`, from those that the handles were taken to last or
    /// from rest, if they turn far against the `common` motion.
    pub(super) fn waypoints(
        &self,
        last: Option<&[[f64; 3]]>,
        positions: &[[f64; 3]],
        common: &Motion,
    ) -> Vec<Vec<[f64; 3]>> {
        let rest = || {
            let vertices = self.constraints.vertices().iter();
            vertices.map(|&vertex| self.rest[vertex].into()).collect()
        };
        let last = last.map_or_else(rest, <[_]>::to_vec);
        let diagonal = self.diagonal;
        self.groups.waypoints(&last, positions, common, diagonal)
    }

    /// The rigid motion of the least Σ m |M p − t| over what is held, which is that of the greater
    /// part if it moves rigidly.
    fn common_motion(&self, positions: &[Vector3<f64>], centres: &[Vector3<f64>]) -> Motion {
        let mut points: Vec<Pair> = Vec::new();
        let mut body_masses = vec![0.0; self.bodies.len()];
        for (vertex, role) in self.roles.iter().enumerate() {
            match *role {
                Role::Pinned | Role::Fixed => {
                    points.push((self.masses[vertex], self.rest[vertex], positions[vertex]));
                }
                Role::Body(body) => body_masses[body as usize] += self.masses[vertex],
                _ => {}
            }
        }
        for ((body, mass), centre) in self.bodies.iter().zip(body_masses).zip(centres) {
            points.push((mass, body.centre, *centre));
        }
        common_motion(&points, self.diagonal)
    }
}

fn bounds(points: &[Vector3<f64>]) -> (Vector3<f64>, Vector3<f64>) {
    let first = points.first().copied().unwrap_or_default();
    points.iter().fold((first, first), |(least, most), point| {
        (least.inf(point), most.sup(point))
    })
}

/// The diagonal of the bounding box of points.
pub(super) fn diagonal(points: &[Vector3<f64>]) -> f64 {
    let (least, most) = bounds(points);
    (most - least).norm()
}
