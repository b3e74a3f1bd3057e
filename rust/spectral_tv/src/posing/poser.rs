//! A mesh that is posed again and again.

use nalgebra::UnitQuaternion;
use ndarray::Array2;

use crate::error::Result;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::minimization::check_tolerance;
use crate::monitor::{Monitor, Stage};
use crate::posing::current::Current;
use crate::posing::handles::Handles;
use crate::posing::levels::Levels;
use crate::posing::model::Parameters;
use crate::posing::outcome::Pose;
use crate::posing::search::Reached;
use crate::posing::settings::Settings;
use crate::posing::state::{Snapshot, State, quaternions};

/// A movement, relative to the diagonal, after which conjugate gradients take over.
const NEAR: f64 = 2e-3;
/// A cycle that leaves more of the energy than this is the last.
const WORTH_IT: f64 = 0.95;
const MOST_CYCLES: usize = 40;
const MOST_NEWTON: usize = 200;
/// What of the work is taken to be left after each Newton step.
const PROGRESS: f64 = 0.85;

/// A mesh, its handles, and its last pose, from which the next one starts.
pub struct Poser {
    handles: Handles,
    settings: Settings,
    levels: Levels,
    current: Current,
}

impl Poser {
    /// Prepares `mesh` for posing.
    ///
    /// # Errors
    /// If a parameter is not in 0 to 1e6, or memory does not suffice.
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
        stage.require(
            needs::pose(needs::Size::of(mesh)),
            &format!("posing {} vertices", mesh.vertex_count()),
            "take a mesh of fewer vertices",
        )?;
        let parameters = Parameters::new(&settings, handles.diagonal());
        let levels = Levels::new(mesh, &handles, parameters, stage)?;
        let current = Current::at_rest(&handles);
        Ok(Self {
            handles,
            settings,
            levels,
            current,
        })
    }

    /// Takes other parameters; the pose stays until the next step.
    ///
    /// # Errors
    /// If a parameter is not in 0 to 1e6.
    pub fn set_settings(&mut self, settings: Settings) -> Result<()> {
        settings.check()?;
        let parameters = Parameters::new(&settings, self.handles.diagonal());
        self.levels.set_parameters(parameters);
        self.current.numbers = None;
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
        let targets = self.current.targets.as_deref()?;
        Some(self.current.state.snapshot(targets))
    }

    /// Goes on from the state of another poser of the same mesh and handles.
    ///
    /// # Errors
    /// If it is not of as many vertices, handles and free bodies, a number is not finite, or
    /// beyond 1e100, or a quaternion is not of length 1.
    pub fn set_state(&mut self, snapshot: Snapshot) -> Result<()> {
        let fine = &self.levels.fine;
        let mut state = State::of(&snapshot, fine.rest.len(), fine.body_count)?;
        let (goals, motion) = self.handles.goals(&snapshot.targets)?;
        fine.place(&goals, &mut state);
        self.current = Current {
            state,
            goals,
            motion,
            targets: Some(snapshot.targets),
            numbers: None,
        };
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
        let reached = self.cycle(positions, monitor.whole())?;
        Ok(self.outcome(None, reached, 1))
    }

    fn cycle(&mut self, positions: &[[f64; 3]], stage: Stage) -> Result<Reached> {
        let (handles, levels) = (&self.handles, &mut self.levels);
        self.current.cycle(levels, handles, positions, stage)
    }

    /// A stationary pose for the target `positions`, the decrement being `tolerance` at most. Where
    /// handles turn by more than 45° against each other, the pose follows them on their way, as the
    /// shortest screw goes.
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
        let mut left = 1.0;
        for place in self.waypoints(positions)? {
            self.cycle(&place, stage)?;
            iterations += 1;
            left *= PROGRESS;
            stage.report(1.0 - left)?;
        }
        let mut reached = Reached {
            movement: f64::INFINITY,
            energy: f64::INFINITY,
        };
        while reached.movement > NEAR * self.handles.diagonal() && iterations < MOST_CYCLES {
            let before = reached.energy;
            reached = self.cycle(positions, stage)?;
            iterations += 1;
            left *= PROGRESS;
            stage.report(1.0 - left)?;
            if reached.energy > WORTH_IT * before {
                break;
            }
        }
        let mut decrement = f64::INFINITY;
        for _ in 0..MOST_NEWTON {
            (decrement, reached) = self.current.newton(&mut self.levels, tolerance, stage)?;
            iterations += 1;
            left *= PROGRESS;
            stage.report(1.0 - left)?;
            // No step helps where corners of a face are half a turn apart: either way is as short.
            if decrement <= tolerance || reached.movement == 0.0 {
                break;
            }
        }
        stage.report(1.0)?;
        Ok(self.outcome(Some(decrement), reached, iterations))
    }

    fn waypoints(&self, positions: &[[f64; 3]]) -> Result<Vec<Vec<[f64; 3]>>> {
        let (_, motion) = self.handles.goals(positions)?;
        let last = self.current.targets.as_deref();
        let common = self.current.motion.to(&motion);
        Ok(self.handles.waypoints(last, positions, &common))
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
        let fine = &self.levels.fine;
        let (vertices, count) = (fine.rest.len(), sequence.len());
        let faces = fine.operators.gradient().face_areas().len();
        stage.require(
            needs::poses(needs::Size::new(vertices, faces), count),
            &format!("posing {vertices} vertices {count} times"),
            "take fewer at a time, or a mesh of fewer vertices",
        )?;
        let solve = |(index, positions): (usize, &Vec<[f64; 3]>)| {
            let share = stage.part(index, count);
            self.solve_with(positions, tolerance, share)
        };
        sequence.iter().enumerate().map(solve).collect()
    }

    fn outcome(&self, decrement: Option<f64>, reached: Reached, iterations: usize) -> Pose {
        let rest = &self.levels.fine.rest;
        let state = &self.current.state;
        let mut displacement = Array2::from_shape_fn((3, rest.len()), |(axis, vertex)| {
            state.positions[vertex][axis] - rest[vertex][axis]
        });
        let mut rotations = state.rotations.clone();
        let floating = &self.handles.constraints.floating;
        floating.carry_and(&mut displacement, |vertex, turn| {
            rotations[vertex] = UnitQuaternion::from_rotation_matrix(turn).into_inner();
        });
        Pose {
            displacement,
            rotations: quaternions(&rotations),
            energy: reached.energy,
            decrement,
            movement: reached.movement,
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
