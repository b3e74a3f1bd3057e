//! The levels: set up for a pattern and a matrix, refreshed for later matrices of the pattern.

use crate::error::{Error, Result};
use crate::monitor::Stage;
use crate::solver::multigrid::aggregation::{Aggregates, Strength};
use crate::solver::multigrid::coarsest::{self, Coarsest};
use crate::solver::multigrid::galerkin::Galerkin;
use crate::solver::multigrid::matrix::Matrix;
use crate::solver::multigrid::prolongation::Prolongation;
use crate::solver::multigrid::smoother::Smoother;

/// Couplings below this fraction of the largest are not followed when vertices are clustered;
/// half as much on every further level, where rows have more of them.
const STRENGTH: f32 = 0.2;

/// A matrix, how its error is smoothed, and the way to the next level.
pub(super) struct Level {
    pub matrix: Matrix,
    pub smoother: Smoother,
    /// `None` on the last level.
    pub coarsening: Option<Coarsening>,
}

/// From a level to the next.
pub(super) struct Coarsening {
    pub prolongation: Prolongation,
    galerkin: Galerkin,
}

/// All levels, the finest first.
pub(super) struct Hierarchy {
    pub levels: Vec<Level>,
    /// The last level's inverse, where it is small; else sweeps alone suffice there.
    pub coarsest: Option<Coarsest>,
}

impl Hierarchy {
    /// The finest level alone, without values.
    pub fn unset(matrix: Matrix) -> Self {
        let smoother = Smoother::new(matrix.size());
        Self {
            levels: vec![Level {
                matrix,
                smoother,
                coarsening: None,
            }],
            coarsest: None,
        }
    }

    /// Clusters anew on every level, by the values the finest matrix has now.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if the matrix is not positive definite.
    pub fn coarsen(&mut self, stage: Stage) -> Result<()> {
        self.levels.truncate(1);
        self.levels[0].coarsening = None;
        let mut threshold = STRENGTH;
        while let Some(next) = self.levels.last_mut().and_then(|last| {
            (last.matrix.size() > coarsest::LARGEST).then(|| last.coarsened(threshold, stage))
        }) {
            match next? {
                Some(matrix) => self.levels.push(Level {
                    smoother: Smoother::new(matrix.size()),
                    matrix,
                    coarsening: None,
                }),
                None => break,
            }
            threshold *= 0.5;
        }
        self.finish(stage)
    }

    /// Takes new values of the finest matrix through all levels.
    ///
    /// # Errors
    /// As [`Self::coarsen`].
    pub fn refresh(&mut self, stage: Stage) -> Result<()> {
        for index in 1..self.levels.len() {
            let (fine, coarse) = self.levels.split_at_mut(index);
            let fine = &mut fine[index - 1];
            if let Some(coarsening) = &mut fine.coarsening {
                coarsening.refresh(&fine.matrix, &mut coarse[0].matrix, stage)?;
            }
        }
        self.finish(stage)
    }

    /// Takes new values of the finest matrix on its own level alone: coarse levels of a similar
    /// matrix still serve.
    ///
    /// # Errors
    /// [`Error::Solver`] if the matrix is not positive definite.
    pub fn refresh_finest(&mut self) -> Result<()> {
        let finest = &mut self.levels[0];
        let is_definite = finest.smoother.refresh(&finest.matrix);
        // A single level is its own coarsest.
        let coarsest = self.coarsest.take().filter(|_| self.levels.len() > 1);
        self.coarsest = match coarsest {
            None if self.levels[0].matrix.size() <= coarsest::LARGEST => {
                Some(Coarsest::new(&self.levels[0].matrix).ok_or_else(not_definite)?)
            }
            coarsest => coarsest,
        };
        is_definite.then_some(()).ok_or_else(not_definite)
    }

    /// What follows from the matrices.
    fn finish(&mut self, stage: Stage) -> Result<()> {
        for level in &mut self.levels {
            if !stage.pass(|| level.smoother.refresh(&level.matrix))? {
                return Err(not_definite());
            }
        }
        let last = &self.levels[self.levels.len() - 1].matrix;
        self.coarsest = match last.size() <= coarsest::LARGEST {
            true => Some(Coarsest::new(last).ok_or_else(not_definite)?),
            false => None,
        };
        Ok(())
    }
}

impl Level {
    /// Sets up the way to the next level and returns its matrix; `None` if nothing is coupled
    /// so strongly that a coarser level would help.
    fn coarsened(&mut self, threshold: f32, stage: Stage) -> Result<Option<Matrix>> {
        let strength = stage.pass(|| Strength::new(&self.matrix, threshold))?;
        let aggregates = stage.pass(|| Aggregates::new(&self.matrix, &strength))?;
        if aggregates.count == 0 {
            return Ok(None);
        }
        let prolongation = Prolongation::new(&self.matrix, &strength, &aggregates, stage)?;
        let (galerkin, mut coarse) = Galerkin::new(&self.matrix, &prolongation, stage)?;
        let mut coarsening = Coarsening {
            prolongation,
            galerkin,
        };
        coarsening.refresh(&self.matrix, &mut coarse, stage)?;
        self.coarsening = Some(coarsening);
        Ok(Some(coarse))
    }
}

impl Coarsening {
    fn refresh(&mut self, matrix: &Matrix, coarse: &mut Matrix, stage: Stage) -> Result<()> {
        stage.pass(|| self.prolongation.refresh(matrix))?;
        let prolongation = &self.prolongation;
        self.galerkin.refresh(matrix, prolongation, coarse, stage)
    }
}

fn not_definite() -> Error {
    Error::Solver("the matrix is not positive definite".into())
}
