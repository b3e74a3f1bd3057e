//! Movements and turns each by themselves, by scalar Laplacians.

use nalgebra::Vector3;
use ndarray::Array2;

use crate::error::Result;
use crate::monitor::Stage;
use crate::posing::field::Field;
use crate::posing::linearized::Linearized;
use crate::posing::model::{Model, Role};
use crate::solver::{Demand, LinearSolver, Solver};

/// Relative accuracy of solutions by iteration.
const TOLERANCE: f64 = 1e-3;
/// Solutions with each matrix, and functions at once.
const DEMAND: Demand = Demand {
    solutions: 4,
    channels: 3,
};
/// The mean of |θ × T|² over the directions of θ.
const SPIN: f64 = 4.0 / 3.0;

/// The diagonal blocks of the Gauss–Newton matrix.
pub(super) struct Smoother {
    moves: LinearSolver,
    turns: LinearSolver,
}

impl Smoother {
    pub fn new(model: &Model, stage: Stage) -> Result<Self> {
        model.operators.prepare_edges(stage)?;
        let solver = || model.operators.solver(Solver::Auto, DEMAND, stage);
        Ok(Self {
            moves: solver()?,
            turns: solver()?,
        })
    }

    /// Takes the block of movements.
    ///
    /// # Errors
    /// [`crate::Error::Solver`] or [`crate::Error::Cancelled`].
    pub fn set_moves(&mut self, linearized: &Linearized, stage: Stage) -> Result<()> {
        let model = linearized.model;
        let is_held = |vertex: usize| model.roles[vertex] != Role::Free;
        let diagonal = |vertex: usize| linearized.diagonal(vertex);
        set(&mut self.moves, linearized, 1.0, is_held, diagonal, stage)
    }

    /// Takes the block of turns.
    ///
    /// # Errors
    /// As [`Self::set_moves`].
    pub fn set_turns(&mut self, linearized: &Linearized, stage: Stage) -> Result<()> {
        let model = linearized.model;
        let is_held = |vertex: usize| !matches!(model.roles[vertex], Role::Free | Role::Pinned);
        let mut masses = vec![0.0; model.rest.len()];
        for (corners, face) in model
            .operators
            .gradient()
            .triangles()
            .iter()
            .zip(&linearized.faces)
        {
            for &corner in corners {
                masses[corner as usize] += SPIN / 3.0 * face.weight;
            }
        }
        let stiffness = model.parameters.stiffness;
        // A vertex of no face that counts is turned by nothing.
        let diagonal = |vertex: usize| match masses[vertex] {
            mass if mass > 0.0 => mass,
            _ => 1.0,
        };
        set(
            &mut self.turns,
            linearized,
            stiffness,
            is_held,
            diagonal,
            stage,
        )
    }

    /// Movements that answer the forces `field`, turns staying.
    ///
    /// # Errors
    /// As [`Self::set_moves`].
    pub fn moves(&mut self, field: &[Vector3<f64>], stage: Stage) -> Result<Vec<Vector3<f64>>> {
        solved(&mut self.moves, field, stage)
    }

    /// Turns that answer the torques `field`, movements staying.
    ///
    /// # Errors
    /// As [`Self::set_moves`].
    pub fn turns(&mut self, field: &[Vector3<f64>], stage: Stage) -> Result<Vec<Vector3<f64>>> {
        solved(&mut self.turns, field, stage)
    }

    /// Both, for what moves freely; bodies stay.
    ///
    /// # Errors
    /// As [`Self::set_moves`].
    pub fn solve(&mut self, field: &Field, stage: Stage) -> Result<Field> {
        Ok(Field {
            moves: self.moves(&field.moves, stage)?,
            turns: self.turns(&field.turns, stage)?,
            bodies: vec![Vector3::zeros(); field.bodies.len()],
        })
    }
}

/// Takes diag + `scale` L(w), with the rows of held vertices those of the identity.
fn set(
    solver: &mut LinearSolver,
    linearized: &Linearized,
    scale: f64,
    is_held: impl Fn(usize) -> bool,
    diagonal: impl Fn(usize) -> f64,
    stage: Stage,
) -> Result<()> {
    let model = linearized.model;
    let operators = &model.operators;
    let areas = operators.gradient().face_areas().iter();
    let weights: Vec<f64> = linearized
        .faces
        .iter()
        .zip(areas)
        .enumerate()
        .map(|(place, (face, &area))| match area > 0.0 {
            true => scale * linearized.crushing(place) * face.weight / area,
            false => 0.0,
        })
        .collect();
    let mut couplings = operators.edges().couplings(&weights);
    let count = model.rest.len();
    let mut masses: Vec<f64> = (0..count)
        .map(|vertex| {
            if is_held(vertex) {
                1.0
            } else {
                diagonal(vertex)
            }
        })
        .collect();
    let held: Vec<bool> = (0..count).map(is_held).collect();
    let pattern = operators.pattern().zeros();
    for (column, entries) in pattern.outer_iterator().enumerate() {
        let first = pattern.proper_indptr()[column] as usize;
        for (place, (row, _)) in entries.iter().enumerate() {
            if held[row] || held[column] {
                let coupling = std::mem::take(&mut couplings[first + place]);
                if row != column {
                    for (one, other) in [(row, column), (column, row)] {
                        if !held[one] && held[other] {
                            masses[one] += coupling;
                        }
                    }
                }
            }
        }
    }
    solver.set_matrix(&masses, &couplings, 1.0, stage)
}

fn solved(
    solver: &mut LinearSolver,
    field: &[Vector3<f64>],
    stage: Stage,
) -> Result<Vec<Vector3<f64>>> {
    let values = Array2::from_shape_fn((3, field.len()), |(axis, vertex)| field[vertex][axis]);
    let found = solver.solve(&values, None, TOLERANCE, stage)?;
    Ok((0..field.len())
        .map(|vertex| Vector3::from_fn(|axis, _| found[[axis, vertex]]))
        .collect())
}
