//! The length of a set's boundary, independent of the triangles that it crosses.
//!
//! A set of vertices says where the boundary is but for the width of the triangles between its members
//! and the rest. Edges with both ends in the set have the mean 1, those with none have 0. What the
//! others have is sought, where both ends have neighbours on their side: the means v that minimise ‖v − 1/2‖²_M / (2 τ) + TV(v) on the triangles
//! between. With Crouzeix and Raviart's elements TV(v) is the length of the boundary in whatever
//! direction it crosses the triangles.

use ndarray::Array2;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::mesh::TriangleMesh;
use crate::minimization::{Energy, PrimalDualNewton, Variation};
use crate::monitor::Stage;
use crate::operators::{EdgeElements, Mass, inner_product, total_variation};

/// τ in widths of the triangles. With less the triangles show; with more the boundary takes short cuts
/// within them. From 10 000 vertices on, 2 leaves both below 0.5 %.
const REACH: f64 = 2.0;
/// Newton iterations: ε is 1 by the width at first, and this much less in each, down to the least.
const MOST_ITERATIONS: usize = 60;
const CONTINUATION: f64 = 0.2;
const LEAST_EPSILON: f64 = 1e-3;
/// What a Newton step has to promise, relative to the perimeter.
const TOLERANCE: f64 = 1e-5;

/// Measures perimeters on one mesh.
pub(super) struct Perimeter<'a> {
    operators: &'a Discretization,
    mesh: &'a TriangleMesh,
    on_edges: &'a EdgeElements,
}

impl<'a> Perimeter<'a> {
    /// With `operators` on the edges of `mesh`.
    pub fn new(mesh: &'a TriangleMesh, operators: &'a Discretization) -> Self {
        Self {
            on_edges: operators.on_edges().expect("on edges"),
            operators,
            mesh,
        }
    }

    /// The perimeter of a `set` (V), in length.
    ///
    /// # Errors
    /// [`crate::Error::Solver`] or [`crate::Error::Cancelled`].
    pub fn of(&self, set: &[bool], stage: Stage) -> Result<f64> {
        let is_crossed = |face: &u32| {
            let [a, b, c] =
                self.mesh.triangles()[*face as usize].map(|corner| set[corner as usize]);
            (a != b || b != c) && self.mesh.face_areas()[*face as usize] > 0.0
        };
        let faces = 0..self.mesh.triangles().len() as u32;
        let crossed: Vec<u32> = faces.filter(is_crossed).collect();
        if crossed.is_empty() {
            return Ok(0.0);
        }
        let (band, edges) = self.operators.on_faces(&crossed, stage)?;
        let members =
            |&edge: &u32| self.on_edges.ends()[edge as usize].map(|end| set[end as usize]);
        let anchored = self.anchored(set);
        let is_fixed = |edge: &u32| {
            let [i, j] = self.on_edges.ends()[*edge as usize].map(|end| end as usize);
            set[i] == set[j] || !anchored[i] || !anchored[j]
        };
        let fixed: Vec<bool> = edges.iter().map(is_fixed).collect();
        let data = |(_, edge): (usize, usize)| match members(&edges[edge]) {
            [true, true] => 1.0,
            [false, false] => 0.0,
            _ => 0.5,
        };
        let data = Array2::from_shape_fn((1, edges.len()), data);
        let width = (band.area() / crossed.len() as f64).sqrt();
        least_variation(&band, data, &fixed, width, stage)
    }

    /// Which vertices have a neighbour on their side of the boundary. Nothing else would keep the
    /// means around a vertex from leaving it out.
    fn anchored(&self, set: &[bool]) -> Vec<bool> {
        let mut anchored = vec![false; set.len()];
        for &[i, j] in self.on_edges.ends() {
            let (i, j) = (i as usize, j as usize);
            if set[i] == set[j] {
                (anchored[i], anchored[j]) = (true, true);
            }
        }
        anchored
    }
}

/// The least TV of functions like `data` (1, N), which keep its `fixed` values (N).
fn least_variation(
    operators: &Discretization,
    data: Array2<f64>,
    fixed: &[bool],
    width: f64,
    stage: Stage,
) -> Result<f64> {
    let mut newton = PrimalDualNewton::new(operators, 1, stage)?;
    let mut state = data.clone();
    let mut epsilon = 1.0 / width;
    let variation = |state: &Array2<f64>| total_variation(operators.gradient(), state.view());
    for _ in 0..MOST_ITERATIONS {
        let smoothed = Variation::smoothed(epsilon);
        let energy = Energy {
            operators,
            weights: &|norms| smoothed.weights(norms),
            least_weight: 0.0,
            mass: Mass::lumped(operators.masses()),
            data: &data,
            tau: REACH * width,
            fixed,
        };
        let slope = energy.slope(state.view());
        let descent = energy.descent(state.view(), &slope);
        let direction = newton.direction(&energy, &slope, &descent, stage)?;
        let length = energy.line_search(&slope, &direction, &descent, stage)?;
        newton.update_dual(&energy, &slope, &direction);
        state.scaled_add(length, &direction);
        let promised = inner_product(descent.view(), direction.view()) / energy.tau;
        let is_sharp = epsilon <= LEAST_EPSILON / width;
        if is_sharp && promised <= TOLERANCE * variation(&state) {
            break;
        }
        epsilon = (CONTINUATION * epsilon).max(LEAST_EPSILON / width);
    }
    Ok(variation(&state))
}
