//! Quadratic energies of the displacement, and the linear deformations that minimise them.

use ndarray::{Array2, ArrayView1};
use sprs::CsMatI;

use crate::deformation::problem::{Problem, Task};
use crate::error::Result;
use crate::monitor::Stage;
use crate::operators::{element_stiffness, pin};
use crate::solver::Cholesky;

/// K of a quadratic energy: L(w), or L(w) M⁻¹ L(w).
pub(super) struct Stiffness<'a> {
    /// The lower triangle of L(w).
    laplacian: CsMatI<f64, u32>,
    /// The diagonal of M, where it is the product.
    masses: Option<&'a [f64]>,
}

impl<'a> Stiffness<'a> {
    /// That of ½∫ w |∇d|².
    pub fn membrane(problem: &Problem, weights: &[f64]) -> Self {
        Self {
            laplacian: laplacian(problem, weights),
            masses: None,
        }
    }

    /// That of ½‖M^(−1/2) L(w) d‖².
    pub fn bending(problem: &Problem<'a>, weights: &[f64]) -> Self {
        Self {
            laplacian: laplacian(problem, weights),
            masses: Some(problem.operators.masses()),
        }
    }

    /// K `values` (3, V), without the rounding of the product of matrices.
    pub fn apply(&self, values: &Array2<f64>) -> Array2<f64> {
        let mut product = weighted_differences(&self.laplacian, values);
        if let Some(masses) = self.masses {
            product /= &ArrayView1::from(masses);
            product = weighted_differences(&self.laplacian, &product);
        }
        product
    }

    /// Solves of one system. The rounding of the product of matrices is that of the square of L's
    /// condition number; a second solve corrects it (Björck 1987, "Stability Analysis of the
    /// Method of Seminormal Equations for Linear Least Squares Problems").
    fn solves(&self) -> usize {
        if self.masses.is_some() { 2 } else { 1 }
    }

    /// The lower triangle of K.
    fn matrix(&self) -> CsMatI<f64, u32> {
        match self.masses {
            Some(masses) => squared(&self.laplacian, masses),
            None => self.laplacian.clone(),
        }
    }
}

/// ½⟨d, K d⟩ + ½ Σ s κ |d − c|² − ⟨f, d⟩ over the displacements that are given at fixed vertices.
pub(super) struct Quadratic<'a> {
    problem: Problem<'a>,
    stiffness: Stiffness<'a>,
    spring_scale: f64,
    cholesky: Cholesky,
}

impl<'a> Quadratic<'a> {
    /// Factorizes the energy whose K is `stiffness`.
    ///
    /// # Errors
    /// [`crate::Error::Solver`] if it cannot be factorized, or [`crate::Error::Cancelled`].
    pub fn new(
        problem: Problem<'a>,
        stiffness: Stiffness<'a>,
        spring_scale: f64,
        stage: Stage,
    ) -> Result<Self> {
        let mut system = stiffness.matrix();
        for (column, mut entries) in system.outer_iterator_mut().enumerate() {
            if let Some(diagonal) = entries.get_mut(column) {
                *diagonal += spring_scale * problem.targets.springs[column];
            }
        }
        pin(problem.fixed, &mut system);
        let mut cholesky = Cholesky::analyse(&system, stage)?;
        cholesky.factorize(&system, stage)?;
        Ok(Self {
            problem,
            stiffness,
            spring_scale,
            cholesky,
        })
    }

    /// Moves `state` (3, V) to the minimum for the `forces` f (3, V).
    pub fn minimise(&mut self, state: &mut Array2<f64>, forces: &Array2<f64>) {
        let Problem { targets, fixed, .. } = self.problem;
        self.problem.place_fixed(state);
        for _ in 0..self.stiffness.solves() {
            let mut residual = forces - &self.stiffness.apply(state);
            for (axis, mut row) in residual.rows_mut().into_iter().enumerate() {
                for (vertex, value) in row.iter_mut().enumerate() {
                    let off = targets.displacements[[axis, vertex]] - state[[axis, vertex]];
                    let pull = self.spring_scale * targets.springs[vertex] * off;
                    *value = if fixed[vertex] { 0.0 } else { *value + pull };
                }
            }
            self.cholesky.solve_in_place(&mut residual);
            *state += &residual;
        }
    }
}

/// The displacement of least ∫|∇d|², in one iteration.
pub(super) fn harmonic(task: Task) -> Result<(Array2<f64>, usize)> {
    let problem = &task.problem;
    let weights = vec![1.0; problem.operators.gradient().face_areas().len()];
    let stiffness = Stiffness::membrane(problem, &weights);
    least(task, stiffness, dirichlet_springs(problem))
}

/// The displacement of least ∫|Δd|², in one iteration.
pub(super) fn biharmonic(task: Task) -> Result<(Array2<f64>, usize)> {
    let problem = &task.problem;
    let weights = vec![1.0; problem.operators.gradient().face_areas().len()];
    let stiffness = Stiffness::bending(problem, &weights);
    let springs = dirichlet_springs(problem) / problem.operators.area();
    least(task, stiffness, springs)
}

/// The least displacement by a stiffness, with springs so strong, in one iteration.
fn least(task: Task, stiffness: Stiffness, springs: f64) -> Result<(Array2<f64>, usize)> {
    let mut state = Array2::zeros(task.problem.targets.displacements.dim());
    let forces = state.clone();
    Quadratic::new(task.problem, stiffness, springs, task.stage)?.minimise(&mut state, &forces);
    Ok((state, 1))
}

/// What makes springs as strong against ∫|∇d|² as they are against TV.
pub(super) fn dirichlet_springs(problem: &Problem) -> f64 {
    problem.targets.spread() / problem.operators.area().sqrt()
}

/// The lower triangle of L(w).
fn laplacian(problem: &Problem, weights: &[f64]) -> CsMatI<f64, u32> {
    let (gradient, pattern) = (problem.operators.gradient(), problem.operators.pattern());
    let mut matrix = pattern.zeros();
    let stiffness = |face: usize| {
        let scale = gradient.face_areas()[face] * weights[face];
        element_stiffness(&gradient.hats(face), scale)
    };
    let no_masses = vec![0.0; gradient.vertex_count()];
    pattern.assemble(gradient, &no_masses, stiffness, &mut matrix);
    matrix
}

/// L `values` (3, V), of differences along edges: where values are nearly constant, their size
/// does not round.
fn weighted_differences(laplacian: &CsMatI<f64, u32>, values: &Array2<f64>) -> Array2<f64> {
    let mut product = Array2::zeros(values.dim());
    for (column, entries) in laplacian.outer_iterator().enumerate() {
        for (row, &entry) in entries.iter().filter(|&(row, _)| row != column) {
            for axis in 0..values.nrows() {
                let flux = entry * (values[[axis, column]] - values[[axis, row]]);
                product[[axis, row]] += flux;
                product[[axis, column]] -= flux;
            }
        }
    }
    product
}

/// The lower triangle of L M⁻¹ L.
fn squared(laplacian: &CsMatI<f64, u32>, masses: &[f64]) -> CsMatI<f64, u32> {
    let mut half = laplacian.clone();
    for (column, mut entries) in half.outer_iterator_mut().enumerate() {
        if let Some(diagonal) = entries.get_mut(column) {
            *diagonal *= 0.5;
        }
    }
    let full = &half + &half.transpose_view().to_csc();
    let mut scaled = full.clone();
    for mut entries in scaled.outer_iterator_mut() {
        for (row, value) in entries.iter_mut() {
            *value /= masses[row];
        }
    }
    lower_triangle(&(&full * &scaled))
}

/// With its whole diagonal, of which the sparse product leaves out what vanishes.
fn lower_triangle(matrix: &CsMatI<f64, u32>) -> CsMatI<f64, u32> {
    let mut starts = vec![0];
    let (mut rows, mut values) = (Vec::new(), Vec::new());
    for (column, entries) in matrix.outer_iterator().enumerate() {
        rows.push(column as u32);
        values.push(entries.get(column).copied().unwrap_or(0.0));
        for (row, &value) in entries.iter().filter(|&(row, _)| row > column) {
            rows.push(row as u32);
            values.push(value);
        }
        starts.push(rows.len() as u32);
    }
    CsMatI::new_csc(matrix.shape(), starts, rows, values)
}
