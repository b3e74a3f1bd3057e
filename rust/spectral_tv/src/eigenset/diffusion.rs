//! The indicator of a set, diffused: its level sets are sets near it.

use ndarray::{Array2, Axis};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::mesh::TriangleMesh;
use crate::monitor::Stage;
use crate::operators::element_stiffness;
use crate::solver::Cholesky;

/// (I − r²Δ)⁻¹, factorized.
pub(super) struct Diffusion<'a> {
    operators: &'a Discretization,
    cholesky: Cholesky,
}

impl<'a> Diffusion<'a> {
    /// The diffusion of the radius r, a length.
    pub fn new(operators: &'a Discretization, radius: f64, stage: Stage) -> Result<Self> {
        let (gradient, pattern) = (operators.gradient(), operators.pattern());
        let mut system = pattern.zeros();
        let stiffness = |face: usize| {
            let scale = radius * radius * gradient.face_areas()[face];
            element_stiffness(&gradient.hats(face), scale)
        };
        pattern.assemble(gradient, operators.masses(), stiffness, &mut system);
        let mut cholesky = operators.cholesky(stage)?;
        cholesky.factorize(&system, stage)?;
        Ok(Self {
            operators,
            cholesky,
        })
    }

    /// Of the indicator of `set` (V).
    pub fn apply(&mut self, set: &[bool]) -> Vec<f64> {
        let masses = self.operators.masses();
        let mut values = Array2::from_shape_fn((1, set.len()), |(_, v)| match set[v] {
            true => masses[v],
            false => 0.0,
        });
        self.cholesky.solve_in_place(&mut values);
        values.index_axis(Axis(0), 0).to_vec()
    }
}

/// The mean length of the triangles' edges, by area.
pub(super) fn mean_edge(mesh: &TriangleMesh) -> f64 {
    let areas = mesh.face_areas().iter().enumerate();
    let lengths = areas.map(|(face, area)| (mesh.edge_lengths(face), area));
    lengths
        .map(|(edges, area)| area * edges.iter().sum::<f64>() / 3.0)
        .sum::<f64>()
        / mesh.area()
}
