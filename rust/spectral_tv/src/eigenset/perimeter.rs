//! The length of a set's boundary, independent of the triangles that it crosses.
//!
//! The TV of an indicator and the length of its contour both follow the triangles. On most meshes
//! they are some 10 % too long. The amount that crosses the boundary in a short time of diffusion
//! does not follow the triangles (Ledoux 1994 for heat; here one implicit step):
//!
//! ∫_{M∖C} (I − r²Δ)⁻¹ χ_C = r/2 per(C) + O(r³).
//!
//! Where the surface flares within some edges, as at a short neck, this gives too long a boundary
//! instead. So the smaller of both is taken.

use ndarray::{Array2, Axis};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::mesh::TriangleMesh;
use crate::monitor::Stage;
use crate::operators::{element_stiffness, total_variation};
use crate::solver::Cholesky;

/// The smaller radius in edge lengths: below it the triangles show.
const RADIUS: f64 = 2.0;

/// (I − r²Δ)⁻¹, factorized.
pub(super) struct Diffusion<'a> {
    operators: &'a Discretization,
    cholesky: Cholesky,
    radius: f64,
}

impl<'a> Diffusion<'a> {
    /// The diffusion of the radius r, a length.
    pub fn new(operators: &'a Discretization, radius: f64, stage: Stage) -> Result<Self> {
        let (gradient, pattern) = (operators.gradient(), operators.pattern());
        let mut system = pattern.zeros();
        let stiffness = |face: usize| {
            let scale = radius * radius * gradient.face_areas()[face];
            element_stiffness(&gradient.hats()[face], scale)
        };
        pattern.assemble(gradient, operators.masses(), stiffness, &mut system);
        let mut cholesky = operators.cholesky(stage)?;
        cholesky.factorize(&system, stage)?;
        Ok(Self {
            operators,
            cholesky,
            radius,
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

    /// 2/r ∫_{M∖C} of it: the perimeter but for O(r²).
    fn perimeter(&mut self, set: &[bool]) -> f64 {
        let outside: f64 = self
            .apply(set)
            .iter()
            .zip(self.operators.masses())
            .zip(set)
            .filter(|(_, inside)| !**inside)
            .map(|((value, mass), _)| value * mass)
            .sum();
        2.0 / self.radius * outside
    }
}

/// Measures perimeters on one mesh: at two radii, so that the terms in r² cancel.
pub(super) struct Perimeter<'a> {
    diffusions: [Diffusion<'a>; 2],
    corrections: [f64; 2],
}

impl<'a> Perimeter<'a> {
    /// For sets and gaps wider than some edges of length `edge`.
    pub fn new(operators: &'a Discretization, edge: f64, stage: Stage) -> Result<Self> {
        let radii = [RADIUS * edge, 2.0 * RADIUS * edge];
        // On a lattice of equilateral triangles a straight line then has its length exactly.
        let correction = |r: f64| (1.0 + 3.0 / 16.0 * (edge / r).powi(2)).sqrt();
        Ok(Self {
            diffusions: [
                Diffusion::new(operators, radii[0], stage)?,
                Diffusion::new(operators, radii[1], stage)?,
            ],
            corrections: radii.map(correction),
        })
    }

    /// The perimeter of a set, in length.
    pub fn of(&mut self, set: &[bool]) -> f64 {
        let [near, far] = [0, 1].map(|k| self.corrections[k] * self.diffusions[k].perimeter(set));
        let indicator = Array2::from_shape_fn((1, set.len()), |(_, v)| f64::from(u8::from(set[v])));
        let contour = total_variation(self.diffusions[0].operators.gradient(), indicator.view());
        ((4.0 * near - far) / 3.0).min(contour)
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
