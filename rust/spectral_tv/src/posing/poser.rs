//! A mesh that is posed again and again.

use nalgebra::{UnitQuaternion, Vector3};
use ndarray::Array2;

use crate::deformation::require;
use crate::discretization::Discretization;
use crate::error::Result;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::minimization::check_tolerance;
use crate::monitor::{Monitor, Stage};
use crate::parallel;
use crate::posing::coarse::CoarseSystem;
use crate::posing::decimation::decimate;
use crate::posing::field::Field;
use crate::posing::handles::{Handles, Motion};
use crate::posing::lift::Lift;
use crate::posing::linearized::Linearized;
use crate::posing::model::{Corners, Goals, Model, Parameters, Role};
use crate::posing::outcome::Pose;
use crate::posing::settings::Settings;
use crate::posing::smoother::Smoother;
use crate::posing::state::{Snapshot, State, quaternions, rotated};

/// Vertices of the coarse mesh.
const COARSE: usize = 800;
/// Gauss–Newton steps of the coarse mesh while a handle is dragged.
const DRAG_STEPS: usize = 2;
/// The largest turn of a step, radians.
const LARGEST_TURN: f64 = 0.7;
/// The part of the decrease that the slope promises which is enough for a step.
const ENOUGH: f64 = 1e-4;
const HALVINGS: usize = 12;
/// A movement, relative to the diagonal, after which conjugate gradients take over.
const NEAR: f64 = 2e-3;
const MOST_UPDATES: usize = 40;
const MOST_NEWTON: usize = 200;
const MOST_INNER: usize = 60;
const INNER_TOLERANCE: f64 = 0.1;
/// Progress is shown as nearing the end by this factor an iteration.
const PROGRESS: f64 = 0.87;

/// A mesh, its handles, and its last pose, from which the next one starts.
pub struct Poser {
    handles: Handles,
    fine: Model,
    coarse: Model,
    lift: Lift,
    system: CoarseSystem,
    smoother: Smoother,
    settings: Settings,
    state: State,
    /// The targets of the last step, and what follows from them; `None` at rest.
    targets: Option<Vec<[f64; 3]>>,
    goals: Goals,
    motion: Motion,
}

impl Poser {
    /// Prepares `mesh` for posing.
    ///
    /// # Errors
    /// If a parameter is negative or not finite, or memory does not suffice.
    pub fn new(mesh: &TriangleMesh, handles: Handles, settings: Settings) -> Result<Self> {
        Self::new_with(mesh, handles, settings, Monitor::new().whole())
    }

    /// [`Self::new`], watched: `stage` cancels it.
    ///
    /// # Errors
    /// As [`Self::new`], or [`crate::Error::Cancelled`].
    pub fn new_with(
        mesh: &TriangleMesh,
        handles: Handles,
        settings: Settings,
        stage: Stage,
    ) -> Result<Self> {
        settings.check()?;
        require(needs::deformation(needs::Size::of(mesh)), mesh, stage)?;
        let parameters = Parameters::new(&settings, handles.diagonal());
        let rest: Vec<Vector3<f64>> = mesh.vertices().iter().map(|&p| p.into()).collect();
        let held: Vec<[u32; 3]> = mesh
            .triangles()
            .iter()
            .copied()
            .zip(mesh.face_areas())
            .filter(|(corners, area)| {
                **area > 0.0 && handles.roles[corners[0] as usize] != Role::Floating
            })
            .map(|(corners, _)| corners)
            .collect();
        let labels: Vec<u32> = handles
            .roles
            .iter()
            .map(|role| match role {
                Role::Free | Role::Floating => 0,
                Role::Fixed => 1,
                Role::Body(body) => 2 + body,
            })
            .collect();
        let decimated = decimate(&rest, &held, &labels, COARSE, stage)?;
        let lift = Lift::new(&rest, &decimated);
        let coarse_mesh = TriangleMesh::new(
            decimated
                .vertices
                .iter()
                .map(|&vertex| mesh.vertices()[vertex as usize])
                .collect(),
            &decimated
                .triangles
                .iter()
                .map(|corners| corners.map(i64::from))
                .collect::<Vec<_>>(),
        )?;
        let take = |vertex: &u32| *vertex as usize;
        let coarse = Model {
            operators: Discretization::new_with(&coarse_mesh, stage)?,
            rest: decimated.vertices.iter().map(|v| rest[take(v)]).collect(),
            roles: decimated
                .vertices
                .iter()
                .map(|v| handles.roles[take(v)])
                .collect(),
            arms: decimated
                .vertices
                .iter()
                .map(|v| handles.arms[take(v)])
                .collect(),
            pulled_along: decimated
                .vertices
                .iter()
                .map(|v| handles.pulled_along[take(v)])
                .collect(),
            body_count: handles.bodies.len(),
            corners: Corners::new(decimated.vertices.len(), coarse_mesh.triangles()),
            parameters,
        };
        let fine = Model {
            operators: Discretization::new_with(mesh, stage)?,
            roles: handles.roles.clone(),
            arms: handles.arms.clone(),
            pulled_along: handles.pulled_along.clone(),
            body_count: handles.bodies.len(),
            corners: Corners::new(rest.len(), mesh.triangles()),
            parameters,
            rest,
        };
        let state = State::at_rest(&fine.rest, handles.bodies.len());
        let goals = Goals {
            positions: fine.rest.clone(),
            still: fine.rest.clone(),
            springs: vec![0.0; fine.rest.len()],
            centres: handles.bodies.iter().map(|body| body.centre).collect(),
        };
        Ok(Self {
            system: CoarseSystem::new(&coarse, stage)?,
            smoother: Smoother::new(&fine, stage)?,
            motion: Motion::none(),
            targets: None,
            settings,
            goals,
            state,
            lift,
            coarse,
            fine,
            handles,
        })
    }

    /// Takes other parameters; the pose stays until the next step.
    ///
    /// # Errors
    /// If a parameter is negative or not finite.
    pub fn set_settings(&mut self, settings: Settings) -> Result<()> {
        settings.check()?;
        let parameters = Parameters::new(&settings, self.handles.diagonal());
        self.fine.parameters = parameters;
        self.coarse.parameters = parameters;
        self.settings = settings;
        Ok(())
    }

    /// The parameters.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// The last pose; `None` if there is none to start from. Another poser that is given it goes
    /// on alike.
    pub fn state(&self) -> Option<Snapshot> {
        let targets = self.targets.as_deref()?;
        Some(self.state.snapshot(targets))
    }

    /// Goes on from the state of another poser of the same mesh and handles.
    ///
    /// # Errors
    /// If it is not of as many vertices, handles and free bodies, a number is not finite, or
    /// beyond 1e100, or a quaternion is not of length 1.
    pub fn set_state(&mut self, snapshot: Snapshot) -> Result<()> {
        let (vertices, bodies) = (self.fine.rest.len(), self.fine.body_count);
        let mut state = State::of(&snapshot, vertices, bodies)?;
        (self.goals, self.motion) = self.handles.goals(&snapshot.targets)?;
        self.fine.place(&self.goals, &mut state);
        self.state = state;
        self.targets = Some(snapshot.targets);
        Ok(())
    }

    /// A step towards the pose for target `positions` of the handles, from the last one: what
    /// there is time for while a handle is dragged.
    ///
    /// # Errors
    /// If there are not as many positions as constraints, one is not finite, two exact ones of a
    /// vertex differ, or a system cannot be solved.
    pub fn drag(&mut self, positions: &[[f64; 3]]) -> Result<Pose> {
        let monitor = Monitor::new();
        let movement = self.update(positions, DRAG_STEPS, monitor.whole())?;
        Ok(self.outcome(f64::NAN, movement, 1))
    }

    /// A stationary pose for the target `positions`, the decrement being `tolerance` at most.
    ///
    /// # Errors
    /// As [`Self::drag`]; for a tolerance not in (0, 1).
    pub fn solve(&mut self, positions: &[[f64; 3]], tolerance: f64) -> Result<Pose> {
        self.solve_with(positions, tolerance, Monitor::new().whole())
    }

    /// [`Self::solve`], watched: `stage` tells how far it is, and cancels it.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`crate::Error::Cancelled`], after which the poser can go on from
    /// where it was.
    pub fn solve_with(
        &mut self,
        positions: &[[f64; 3]],
        tolerance: f64,
        stage: Stage,
    ) -> Result<Pose> {
        check_tolerance(tolerance)?;
        let mut iterations = 0;
        let mut movement = f64::INFINITY;
        while movement > NEAR * self.handles.diagonal() && iterations < MOST_UPDATES {
            movement = self.update(positions, DRAG_STEPS, stage)?;
            iterations += 1;
            stage.report(1.0 - PROGRESS.powi(iterations as i32))?;
        }
        let mut decrement = f64::INFINITY;
        for _ in 0..MOST_NEWTON {
            (decrement, movement) = self.newton(tolerance, stage)?;
            iterations += 1;
            stage.report(1.0 - PROGRESS.powi(iterations as i32))?;
            if decrement <= tolerance {
                break;
            }
        }
        stage.report(1.0)?;
        Ok(self.outcome(decrement, movement, iterations))
    }

    /// Stationary poses for a sequence of targets, each starting from the one before.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`crate::Error::Memory`] at once if all of them do not fit.
    pub fn solve_sequence(
        &mut self,
        sequence: &[Vec<[f64; 3]>],
        tolerance: f64,
    ) -> Result<Vec<Pose>> {
        self.solve_sequence_with(sequence, tolerance, Monitor::new().whole())
    }

    /// [`Self::solve_sequence`], watched: `stage` tells how far it is, and cancels it.
    ///
    /// # Errors
    /// As [`Self::solve_sequence`]; [`crate::Error::Cancelled`] as [`Self::solve_with`].
    pub fn solve_sequence_with(
        &mut self,
        sequence: &[Vec<[f64; 3]>],
        tolerance: f64,
        stage: Stage,
    ) -> Result<Vec<Pose>> {
        check_tolerance(tolerance)?;
        let (vertices, count) = (self.fine.rest.len(), sequence.len());
        let faces = self.fine.operators.gradient().face_areas().len();
        stage.require(
            needs::poses(needs::Size::new(vertices, faces), count),
            &format!("posing {vertices} vertices {count} times"),
            "take fewer at a time, or a mesh of fewer vertices",
        )?;
        let end = |index: usize| index as f64 / count as f64;
        let solve = |(index, positions): (usize, &Vec<[f64; 3]>)| {
            self.solve_with(
                positions,
                tolerance,
                stage.stage(end(index), end(index + 1)),
            )
        };
        sequence.iter().enumerate().map(solve).collect()
    }

    /// One cycle: the coarse mesh follows the handles, the fine one follows it, and is smoothed.
    /// Returns the largest movement, length.
    fn update(&mut self, targets: &[[f64; 3]], steps: usize, stage: Stage) -> Result<f64> {
        let (goals, motion) = self.handles.goals(targets)?;
        let before = self.lift.injected(&self.state);
        // What the coarse gradient lacks, so that a stationary fine pose stays (Nash 2000, "A
        // multigrid approach to discretized optimization problems").
        let mut lack = {
            let coarse_goals = self.coarse_goals(&self.goals);
            let fine = Linearized::new(&self.fine, &self.state, &self.goals);
            let mut asked = self.lift.restrict(&fine.gradient, &before, &self.state);
            self.coarse.reduce(&before, &mut asked);
            let coarse = Linearized::new(&self.coarse, &before, &coarse_goals);
            let mut lack = asked;
            lack.add(-1.0, &coarse.gradient);
            lack
        };
        let carried = self.motion.to(&motion);
        // Of a copy, as the work may end before the motion is kept, too.
        let mut moved = self.state.clone();
        carry(&mut moved, &carried);
        let mut coarse = before;
        carry(&mut coarse, &carried);
        for vectors in [&mut lack.moves, &mut lack.turns, &mut lack.bodies] {
            for vector in vectors.iter_mut() {
                *vector = rotated(&carried.rotation, vector);
            }
        }
        let start = coarse.clone();
        let coarse_goals = self.coarse_goals(&goals);
        self.coarse.place(&coarse_goals, &mut coarse);
        for _ in 0..steps {
            stage.check()?;
            let linearized = Linearized::new(&self.coarse, &coarse, &coarse_goals);
            self.system.factorize(&linearized, stage)?;
            let mut descent = linearized.gradient.clone();
            descent.add(1.0, &lack);
            let slope_field = descent.clone();
            let mut direction = self.system.solve(&descent, &self.coarse);
            direction.add(-2.0, &direction.clone());
            let limit = limited(&direction);
            let slope = slope_field.dot(&direction);
            let mut expanded = direction.clone();
            self.coarse.expand(&coarse, &mut expanded);
            let value = self.coarse.value(&coarse, &coarse_goals);
            let along = lack.dot(&direction);
            let (model, goals) = (&self.coarse, &coarse_goals);
            let state = coarse.clone();
            let (length, next) = searched(limit, slope, value, |length| {
                let next = model.moved(&state, &expanded, length, goals);
                let value = model.value(&next, goals) + length * along;
                (value, next)
            });
            if length == 0.0 {
                break;
            }
            coarse = next;
        }
        let next = self.lift.carry(&moved, &start, &coarse);
        let last = std::mem::replace(&mut self.state, next);
        (self.goals, self.motion) = (goals, motion);
        self.targets = Some(targets.to_vec());
        self.fine.place(&self.goals, &mut self.state);
        self.smooth(stage)?;
        Ok(largest_movement(&last, &self.state))
    }

    /// Positions, then rotations, by themselves.
    fn smooth(&mut self, stage: Stage) -> Result<()> {
        let (fine, goals) = (&self.fine, &self.goals);
        for is_turning in [false, true] {
            stage.check()?;
            let linearized = Linearized::new(fine, &self.state, goals);
            let mut direction = Field::zeros(fine.rest.len(), fine.body_count);
            let forces = &linearized.gradient;
            match is_turning {
                false => {
                    self.smoother.set_moves(&linearized, stage)?;
                    direction.moves = self.smoother.moves(&forces.moves, stage)?;
                }
                true => {
                    self.smoother.set_turns(&linearized, stage)?;
                    direction.turns = self.smoother.turns(&forces.turns, stage)?;
                }
            }
            direction.add(-2.0, &direction.clone());
            let slope = linearized.gradient.dot(&direction);
            let value = fine.value(&self.state, goals);
            let state = &self.state;
            let (length, next) = searched(limited(&direction), slope, value, |length| {
                let next = fine.moved(state, &direction, length, goals);
                (fine.value(&next, goals), next)
            });
            if length > 0.0 {
                self.state = next;
            }
        }
        Ok(())
    }

    /// A Gauss–Newton step of the fine mesh by preconditioned conjugate gradients. Returns the
    /// decrement of the state it started from, and the largest movement.
    fn newton(&mut self, tolerance: f64, stage: Stage) -> Result<(f64, f64)> {
        let fine = &self.fine;
        let linearized = Linearized::new(fine, &self.state, &self.goals);
        self.smoother.set_moves(&linearized, stage)?;
        self.smoother.set_turns(&linearized, stage)?;
        let coarse_state = self.lift.injected(&self.state);
        let coarse_goals = self.coarse_goals(&self.goals);
        let coarse_linearized = Linearized::new(&self.coarse, &coarse_state, &coarse_goals);
        self.system.factorize(&coarse_linearized, stage)?;
        let (smoother, system) = (&mut self.smoother, &mut self.system);
        let (coarse, lift, state) = (&self.coarse, &self.lift, &self.state);
        let mut precondition = |residual: &Field| -> Result<Field> {
            let mut found = smoother.solve(residual, stage)?;
            let mut restricted = lift.restrict(residual, &coarse_state, state);
            coarse.reduce(&coarse_state, &mut restricted);
            let mut correction = system.solve(&restricted, coarse);
            coarse.expand(&coarse_state, &mut correction);
            let mut prolonged = lift.prolong(&correction, &coarse_state, state);
            mask(fine, &mut prolonged);
            found.add(1.0, &prolonged);
            Ok(found)
        };
        let value = fine.value(state, &self.goals);
        let mut direction = Field::zeros(fine.rest.len(), fine.body_count);
        let mut residual = linearized.gradient.clone();
        residual.add(-2.0, &linearized.gradient);
        let mut preconditioned = precondition(&residual)?;
        let mut search = preconditioned.clone();
        let mut norm = residual.dot(&preconditioned);
        let first = norm;
        let mut iterations = 0;
        while norm > INNER_TOLERANCE * INNER_TOLERANCE * first && iterations < MOST_INNER {
            stage.check()?;
            let image = linearized.apply(&search);
            let curvature = search.dot(&image);
            if curvature <= 0.0 {
                break;
            }
            let length = norm / curvature;
            direction.add(length, &search);
            let old = residual.clone();
            residual.add(-length, &image);
            preconditioned = precondition(&residual)?;
            let next = residual.dot(&preconditioned);
            // Of Polak and Ribière, as iterative solves make the preconditioner vary.
            let beta = ((next - old.dot(&preconditioned)) / norm).max(0.0);
            norm = next;
            search.scale_and_add(beta, &preconditioned);
            iterations += 1;
        }
        let slope = linearized.gradient.dot(&direction);
        let decrement = match value > 0.0 {
            true => -0.5 * slope / value,
            false => 0.0,
        };
        if decrement <= 0.01 * tolerance {
            return Ok((decrement.max(0.0), 0.0));
        }
        let mut expanded = direction.clone();
        fine.expand(&self.state, &mut expanded);
        let (state, goals) = (&self.state, &self.goals);
        let (length, next) = searched(limited(&direction), slope, value, |length| {
            let next = fine.moved(state, &expanded, length, goals);
            (fine.value(&next, goals), next)
        });
        let movement = match length > 0.0 {
            true => largest_movement(state, &next),
            false => 0.0,
        };
        if length > 0.0 {
            self.state = next;
        }
        Ok((decrement, movement))
    }

    /// The goals of the coarse mesh.
    fn coarse_goals(&self, goals: &Goals) -> Goals {
        let take = |values: &[Vector3<f64>]| {
            let vertices = self.lift.vertices.iter();
            vertices.map(|&v| values[v as usize]).collect::<Vec<_>>()
        };
        let springs = self.lift.shared(|vertex| goals.springs[vertex]);
        let mut positions = take(&goals.positions);
        for axis in 0..3 {
            let pulls = self.lift.shared(|vertex| {
                let off = goals.positions[vertex][axis] - self.fine.rest[vertex][axis];
                goals.springs[vertex] * off
            });
            for (vertex, pull) in pulls.into_iter().enumerate() {
                if springs[vertex] > 0.0 && self.coarse.roles[vertex] == Role::Free {
                    positions[vertex][axis] =
                        self.coarse.rest[vertex][axis] + pull / springs[vertex];
                }
            }
        }
        Goals {
            positions,
            springs: springs
                .into_iter()
                .zip(&self.coarse.roles)
                .map(|(spring, role)| if *role == Role::Free { spring } else { 0.0 })
                .collect(),
            centres: goals.centres.clone(),
            still: take(&goals.still),
        }
    }

    fn outcome(&self, decrement: f64, movement: f64, iterations: usize) -> Pose {
        let rest = &self.fine.rest;
        let mut displacement = Array2::from_shape_fn((3, rest.len()), |(axis, vertex)| {
            self.state.positions[vertex][axis] - rest[vertex][axis]
        });
        let mut rotations = self.state.rotations.clone();
        let floating = &self.handles.constraints.floating;
        floating.carry_and(&mut displacement, |vertex, turn| {
            rotations[vertex] = UnitQuaternion::from_rotation_matrix(turn).into_inner();
        });
        Pose {
            displacement,
            rotations: quaternions(&rotations),
            energy: self.fine.value(&self.state, &self.goals),
            decrement,
            movement,
            iterations,
        }
    }
}

/// One pose, from rest.
///
/// # Errors
/// As [`Poser::new`] and [`Poser::solve`].
pub fn pose(
    mesh: &TriangleMesh,
    handles: Handles,
    targets: &[[f64; 3]],
    settings: Settings,
    tolerance: f64,
) -> Result<Pose> {
    let monitor = Monitor::new();
    pose_with(mesh, handles, targets, settings, tolerance, monitor.whole())
}

/// [`pose`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`pose`], or [`crate::Error::Cancelled`].
pub fn pose_with(
    mesh: &TriangleMesh,
    handles: Handles,
    targets: &[[f64; 3]],
    settings: Settings,
    tolerance: f64,
    stage: Stage,
) -> Result<Pose> {
    let mut poser = Poser::new_with(mesh, handles, settings, stage)?;
    poser.solve_with(targets, tolerance, stage)
}

/// Moves a whole state rigidly.
fn carry(state: &mut State, motion: &Motion) {
    if *motion == Motion::none() {
        return;
    }
    for position in &mut state.positions {
        *position = motion.applied(position);
    }
    for rotation in state.rotations.iter_mut().chain(&mut state.bodies) {
        *rotation = (motion.rotation * *rotation).normalize();
    }
}

/// Takes out what is given.
fn mask(model: &Model, field: &mut Field) {
    for (vertex, role) in model.roles.iter().enumerate() {
        match role {
            Role::Free => {}
            Role::Fixed => field.moves[vertex] = Vector3::zeros(),
            Role::Body(_) | Role::Floating => {
                field.moves[vertex] = Vector3::zeros();
                field.turns[vertex] = Vector3::zeros();
            }
        }
    }
}

/// The longest step along a direction whose turns are not too large.
fn limited(direction: &Field) -> f64 {
    let vertices = parallel::largest(direction.turns.len(), |range| {
        let turns = direction.turns[range].iter();
        turns.map(|turn| turn.norm()).fold(0.0, f64::max)
    });
    let bodies = direction.bodies.iter().map(|turn| turn.norm());
    let largest = bodies.fold(vertices, f64::max);
    match largest > LARGEST_TURN {
        true => LARGEST_TURN / largest,
        false => 1.0,
    }
}

/// Halves a step until it decreases the value; 0 if none does.
fn searched(first: f64, slope: f64, value: f64, at: impl Fn(f64) -> (f64, State)) -> (f64, State) {
    let mut length = first;
    let (mut found, mut state) = at(length);
    for _ in 0..HALVINGS {
        if found <= value + ENOUGH * length * slope {
            return (length, state);
        }
        length *= 0.5;
        (found, state) = at(length);
    }
    match found < value {
        true => (length, state),
        false => (0.0, state),
    }
}

fn largest_movement(before: &State, after: &State) -> f64 {
    parallel::largest(before.positions.len(), |range| {
        let pairs = before.positions[range.clone()]
            .iter()
            .zip(&after.positions[range]);
        pairs.map(|(a, b)| a.metric_distance(b)).fold(0.0, f64::max)
    })
}
