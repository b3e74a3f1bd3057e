//! Quadratic energies of the displacement, and the linear deformations they give.

use ndarray::Array2;
use sprs::CsMatI;

use crate::deformation::problem::Problem;
use crate::error::Result;
use crate::operators::{element_stiffness, pin};
use crate::solver::Cholesky;

/// ½⟨d, K d⟩ + ½ Σ s κ |d − c|² − ⟨f, d⟩ over the displacements that are given at fixed vertices.
pub(super) struct Quadratic<'a> {
    problem: Problem<'a>,
    /// The lower triangle of K.
    matrix: CsMatI<f64, u32>,
    spring_scale: f64,
    cholesky: Cholesky,
}

impl<'a> Quadratic<'a> {
    /// Factorizes the energy whose K has the lower triangle `matrix`.
    ///
    /// # Errors
    /// [`crate::Error::Solver`] if it cannot be factorized.
    pub fn new(problem: Problem<'a>, matrix: CsMatI<f64, u32>, spring_scale: f64) -> Result<Self> {
        let mut system = matrix.clone();
        for (column, mut entries) in system.outer_iterator_mut().enumerate() {
            if let Some(diagonal) = entries.get_mut(column) {
                *diagonal += spring_scale * problem.targets.springs[column];
            }
        }
        pin(problem.fixed, &mut system);
        let mut cholesky = Cholesky::analyse(&system)?;
        cholesky.factorize(&system)?;
        Ok(Self {
            problem,
            matrix,
            spring_scale,
            cholesky,
        })
    }

    /// Moves `state` (3, V) to the minimum for the `forces` f (3, V).
    pub fn minimise(&mut self, state: &mut Array2<f64>, forces: &Array2<f64>) {
        let Problem { targets, fixed, .. } = self.problem;
        self.problem.place_fixed(state);
        let mut residual = forces - &self.apply(state);
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

    /// K `values` (3, V).
    pub fn apply(&self, values: &Array2<f64>) -> Array2<f64> {
        let mut product = Array2::zeros(values.dim());
        for (column, entries) in self.matrix.outer_iterator().enumerate() {
            for (row, &entry) in entries.iter() {
                for axis in 0..values.nrows() {
                    product[[axis, row]] += entry * values[[axis, column]];
                    if row != column {
                        product[[axis, column]] += entry * values[[axis, row]];
                    }
                }
            }
        }
        product
    }
}

/// The displacement of least ∫|∇d|².
pub(super) fn harmonic(problem: Problem) -> Result<Array2<f64>> {
    let weights = vec![1.0; problem.operators.gradient().face_areas().len()];
    least(
        problem,
        laplacian(&problem, &weights),
        dirichlet_springs(&problem),
    )
}

/// The displacement of least ∫|Δd|².
pub(super) fn biharmonic(problem: Problem) -> Result<Array2<f64>> {
    let weights = vec![1.0; problem.operators.gradient().face_areas().len()];
    let springs = dirichlet_springs(&problem) / problem.operators.area();
    least(problem, bilaplacian(&problem, &weights), springs)
}

fn least(problem: Problem, matrix: CsMatI<f64, u32>, springs: f64) -> Result<Array2<f64>> {
    let mut state = Array2::zeros(problem.targets.displacements.dim());
    let forces = state.clone();
    Quadratic::new(problem, matrix, springs)?.minimise(&mut state, &forces);
    Ok(state)
}

/// What makes springs as strong against ∫|∇d|² as they are against TV.
pub(super) fn dirichlet_springs(problem: &Problem) -> f64 {
    problem.targets.spread() / problem.operators.area().sqrt()
}

/// The lower triangle of L(w).
pub(super) fn laplacian(problem: &Problem, weights: &[f64]) -> CsMatI<f64, u32> {
    let (gradient, pattern) = (problem.operators.gradient(), problem.operators.pattern());
    let mut matrix = pattern.zeros();
    let stiffness = |face: usize| {
        let scale = gradient.face_areas()[face] * weights[face];
        element_stiffness(&gradient.hats()[face], scale)
    };
    let no_masses = vec![0.0; gradient.vertex_count()];
    pattern.assemble(gradient, &no_masses, stiffness, &mut matrix);
    matrix
}

/// The lower triangle of L(w) M⁻¹ L(w).
pub(super) fn bilaplacian(problem: &Problem, weights: &[f64]) -> CsMatI<f64, u32> {
    let mut half = laplacian(problem, weights);
    for (column, mut entries) in half.outer_iterator_mut().enumerate() {
        if let Some(diagonal) = entries.get_mut(column) {
            *diagonal *= 0.5;
        }
    }
    let full = &half + &half.transpose_view().to_csc();
    let mut scaled = full.clone();
    for mut entries in scaled.outer_iterator_mut() {
        for (row, value) in entries.iter_mut() {
            *value /= problem.operators.masses()[row];
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
