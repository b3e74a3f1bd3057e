//! Movements and turns each by themselves, by scalar Laplacians.

use nalgebra::Vector3;
use ndarray::Array2;

use crate::error::Result;
use crate::monitor::Stage;
use crate::parallel;
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
    moves: Block,
    turns: Block,
}

/// One of them.
struct Block {
    solver: LinearSolver,
    /// Whether the row of each vertex is that of the identity, V.
    held: Vec<bool>,
    /// Entries of the pattern that couple a held vertex with another, and that other if it is free.
    cut: Vec<(u32, Option<u32>)>,
}

impl Smoother {
    pub fn new(model: &Model, stage: Stage) -> Result<Self> {
        model.operators.prepare_edges(stage)?;
        let moves = |role: &Role| *role == Role::Free;
        let turns = |role: &Role| matches!(role, Role::Free | Role::Pinned);
        Ok(Self {
            moves: Block::new(model, moves, stage)?,
            turns: Block::new(model, turns, stage)?,
        })
    }

    /// Takes the block of movements.
    ///
    /// # Errors
    /// [`crate::Error::Solver`] or [`crate::Error::Cancelled`].
    pub fn set_moves(&mut self, linearized: &Linearized, stage: Stage) -> Result<()> {
        let diagonal = |vertex: usize| linearized.diagonal(vertex);
        self.moves.set(linearized, 1.0, diagonal, stage)
    }

    /// Takes the block of turns.
    ///
    /// # Errors
    /// As [`Self::set_moves`].
    pub fn set_turns(&mut self, linearized: &Linearized, stage: Stage) -> Result<()> {
        let model = linearized.model;
        let mut masses = vec![0.0; model.rest.len()];
        let triangles = model.operators.gradient().triangles();
        for (face, corners) in triangles.iter().enumerate() {
            for &corner in corners {
                masses[corner as usize] += SPIN / 3.0 * linearized.numbers.weight(face);
            }
        }
        let stiffness = model.parameters.stiffness;
        // A vertex of no face that counts is turned by nothing.
        let diagonal = |vertex: usize| match masses[vertex] {
            mass if mass > 0.0 => mass,
            _ => 1.0,
        };
        self.turns.set(linearized, stiffness, diagonal, stage)
    }

    /// Movements that answer the forces `field`, turns staying.
    ///
    /// # Errors
    /// As [`Self::set_moves`].
    pub fn moves(&mut self, field: &[Vector3<f64>], stage: Stage) -> Result<Vec<Vector3<f64>>> {
        self.moves.solved(field, stage)
    }

    /// Turns that answer the torques `field`, movements staying.
    ///
    /// # Errors
    /// As [`Self::set_moves`].
    pub fn turns(&mut self, field: &[Vector3<f64>], stage: Stage) -> Result<Vec<Vector3<f64>>> {
        self.turns.solved(field, stage)
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

impl Block {
    fn new(model: &Model, is_free: impl Fn(&Role) -> bool, stage: Stage) -> Result<Self> {
        let held: Vec<bool> = model.roles.iter().map(|role| !is_free(role)).collect();
        let pattern = model.operators.pattern().zeros();
        let mut cut = Vec::new();
        let mut entry = 0;
        for (column, entries) in pattern.outer_iterator().enumerate() {
            for (row, _) in entries.iter() {
                if held[row] || held[column] {
                    let free = [row, column].into_iter().find(|&vertex| !held[vertex]);
                    cut.push((entry, free.map(|vertex| vertex as u32)));
                }
                entry += 1;
            }
        }
        Ok(Self {
            solver: model.operators.solver(Solver::Auto, DEMAND, stage)?,
            held,
            cut,
        })
    }

    /// Takes diag + `scale` L(w), with the rows of held vertices those of the identity.
    fn set(
        &mut self,
        linearized: &Linearized,
        scale: f64,
        diagonal: impl Fn(usize) -> f64,
        stage: Stage,
    ) -> Result<()> {
        let operators = &linearized.model.operators;
        let areas = operators.gradient().face_areas();
        let weights = parallel::values(areas.len(), |face| match areas[face] > 0.0 {
            true => {
                let weight = linearized.numbers.weight(face);
                scale * linearized.crushing(face) * weight / areas[face]
            }
            false => 0.0,
        });
        let mut couplings = operators.edges().couplings(operators.gradient(), &weights);
        let own = |(vertex, &held): (usize, &bool)| if held { 1.0 } else { diagonal(vertex) };
        let mut masses: Vec<f64> = self.held.iter().enumerate().map(own).collect();
        for &(entry, free) in &self.cut {
            let coupling = std::mem::take(&mut couplings[entry as usize]);
            if let Some(vertex) = free {
                masses[vertex as usize] += coupling;
            }
        }
        self.solver.set_matrix(&masses, couplings, 1.0, stage)
    }

    fn solved(&mut self, field: &[Vector3<f64>], stage: Stage) -> Result<Vec<Vector3<f64>>> {
        let values = Array2::from_shape_fn((3, field.len()), |(axis, vertex)| field[vertex][axis]);
        let found = self.solver.solve(&values, None, TOLERANCE, stage)?;
        Ok((0..field.len())
            .map(|vertex| Vector3::from_fn(|axis, _| found[[axis, vertex]]))
            .collect())
    }
}
