//! The operators of one mesh and what solving with them needs: built once, shared by all steps.

use std::sync::OnceLock;

use ndarray::ArrayView2;

use crate::error::{ArgumentError, Error, Result, unusable_values};
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
pub use crate::operators::positions;
use crate::operators::{EdgeLaplacian, Gradient, LaplacianPattern, invertible_masses};
use crate::solver::{Cholesky, Demand, LinearSolver, Solver, Symbolic};

/// Gradients from here on are refused: their squares, added up, have to be numbers.
const STEEPEST: f64 = 1e145;

/// G, the areas A and M, and the pattern of L(w), in the metric g₀ of a mesh.
#[derive(Debug, Clone)]
pub struct Discretization {
    gradient: Gradient,
    pattern: LaplacianPattern,
    symbolic: Symbolic,
    /// Made for flows only; deformations never ask for them.
    edges: OnceLock<EdgeLaplacian>,
    masses: Vec<f64>,
    area: f64,
    /// The largest component of a ∇λ, 1/length.
    steepest_hat: f64,
}

impl Discretization {
    /// The operators of `mesh`.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn new(mesh: &TriangleMesh) -> Result<Self> {
        Self::new_with(mesh, Monitor::new().whole())
    }

    /// [`Self::new`], watched: `stage` cancels it.
    ///
    /// # Errors
    /// As [`Self::new`], or [`Error::Cancelled`].
    pub fn new_with(mesh: &TriangleMesh, stage: Stage) -> Result<Self> {
        stage.require(
            needs::operators(needs::Size::of(mesh)),
            &format!("working on {} vertices", mesh.vertex_count()),
            "take a mesh of fewer vertices",
        )?;
        let gradient = Gradient::new(mesh, stage)?;
        let pattern = LaplacianPattern::new(&gradient, stage)?;
        let hats = gradient.hats().as_flattened().as_flattened();
        let largest = || hats.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
        let steepest_hat = stage.pass(largest)?;
        Ok(Self {
            steepest_hat,
            edges: OnceLock::new(),
            gradient,
            pattern,
            symbolic: Symbolic::default(),
            masses: invertible_masses(mesh.vertex_areas()),
            area: mesh.area(),
        })
    }

    /// The gradient and the face areas.
    pub fn gradient(&self) -> &Gradient {
        &self.gradient
    }

    /// The pattern of weighted Laplacians.
    pub(crate) fn pattern(&self) -> &LaplacianPattern {
        &self.pattern
    }

    /// Makes [`Self::edges`], if they are not made yet.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub(crate) fn prepare_edges(&self, stage: Stage) -> Result<()> {
        if self.edges.get().is_none() {
            let edges = EdgeLaplacian::new(&self.gradient, &self.pattern, stage)?;
            // Whoever was faster has made the same.
            let _ = self.edges.set(edges);
        }
        Ok(())
    }

    /// Weighted Laplacians by their edges.
    ///
    /// # Panics
    /// Without [`Self::prepare_edges`].
    pub(crate) fn edges(&self) -> &EdgeLaplacian {
        self.edges.get().expect("prepared before")
    }

    /// A solver of systems with matrices of the pattern.
    ///
    /// # Errors
    /// As [`LinearSolver::new`].
    pub(crate) fn solver(
        &self,
        choice: Solver,
        demand: Demand,
        stage: Stage,
    ) -> Result<LinearSolver> {
        LinearSolver::new(self.pattern.zeros(), &self.symbolic, choice, demand, stage)
    }

    /// Which solver `choice` means for what is demanded of matrices of the pattern.
    ///
    /// # Errors
    /// As [`Solver::chosen`].
    pub(crate) fn chosen(&self, choice: Solver, demand: Demand) -> Result<Solver> {
        choice.chosen(&self.pattern.zeros(), &self.symbolic, demand)
    }

    /// Room for the factor of a matrix of the pattern.
    ///
    /// # Errors
    /// As [`Cholesky::new`].
    pub(crate) fn cholesky(&self, stage: Stage) -> Result<Cholesky> {
        Cholesky::new(&self.pattern.zeros(), &self.symbolic, stage)
    }

    /// M: the lumped mass of every vertex, length², positive everywhere.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// Area of the surface, length².
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Refuses functions of values up to `largest` whose gradients could not be squared.
    ///
    /// # Errors
    /// [`Error::Argument`].
    pub fn check_gradients(&self, largest: f64) -> Result<()> {
        match largest * self.steepest_hat < STEEPEST {
            true => Ok(()),
            false => Err(ArgumentError::contradiction(
                "values",
                &["mesh"],
                format!(
                    "values of {largest:.0e} on faces {:.0e} high have gradients beyond {STEEPEST:.0e}",
                    self.steepest_hat.recip()
                ),
            ).into()),
        }
    }

    /// Refuses `values` that are not a finite function on this mesh, (C, V) with C ≥ 1.
    ///
    /// # Errors
    /// Names the shape, or the first vertex and channel whose value is not finite; as
    /// [`Self::check_gradients`].
    pub fn check_values(&self, values: ArrayView2<f64>) -> Result<()> {
        let (channels, vertices) = values.dim();
        if channels == 0 || vertices != self.masses.len() {
            return Err(ArgumentError::contradiction(
                "values",
                &["mesh"],
                format!(
                    "values must have one row per vertex ({}) and at least one channel, but have \
                     {vertices} rows and {channels} channels",
                    self.masses.len()
                ),
            )
            .into());
        }
        match unusable_values(values) {
            Some((vertices, channel, value)) => Err(Error::NonFiniteValues {
                vertices,
                channel,
                value,
            }),
            None => {
                let largest = values.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
                self.check_gradients(largest)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn preparations_end_when_cancelled() {
        let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
        let mesh = TriangleMesh::new(vertices, &[[0, 1, 2]]).unwrap();
        let operators = Discretization::new(&mesh).unwrap();
        let monitor = Monitor::new();
        monitor.cancel();
        let outcome = operators.prepare_edges(monitor.whole());
        assert!(matches!(outcome, Err(Error::Cancelled)));
        let outcome = Discretization::new_with(&mesh, monitor.whole());
        assert!(matches!(outcome, Err(Error::Cancelled)));
    }
}
