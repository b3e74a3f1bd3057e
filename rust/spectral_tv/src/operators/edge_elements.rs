//! Crouzeix–Raviart elements: one unknown per edge, the mean of a function along it.
//!
//! Piecewise linear functions that are continuous at the midpoints of edges (Crouzeix and Raviart
//! 1973). A set whose border runs across triangles has its true perimeter in them, in every
//! direction: continuous elements pay for the stairs that the border takes along the edges.

use std::sync::Arc;

use ndarray::{Array2, ArrayView1, ArrayView2};

use crate::error::Result;
use crate::mesh::TriangleMesh;
use crate::monitor::Stage;
use crate::operators::limiter::Corrections;
use crate::operators::over_lumping::over_lumping;
use crate::operators::{Gradient, LaplacianPattern};
use crate::parallel;

/// Where the unknowns of a mesh are, and the ways from functions on its vertices to them and back.
///
/// Vertices are joined by one edge at most: an edge of three triangles or more is one unknown.
#[derive(Debug, Clone)]
pub struct EdgeElements {
    /// The vertices of each edge, E.
    ends: Vec<[u32; 2]>,
    /// The vertices of each triangle, F.
    corners: Arc<[[u32; 3]]>,
    /// The edges opposite to them.
    edges: Arc<[[u32; 3]]>,
    face_areas: Arc<[f64]>,
    vertex_areas: Vec<f64>,
}

impl EdgeElements {
    /// The edges of `mesh`, with the `gradient` of continuous functions on it.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(mesh: &TriangleMesh, gradient: &Gradient, stage: Stage) -> Result<Self> {
        let pattern = LaplacianPattern::new(gradient, stage)?;
        let mut ends = Vec::with_capacity(pattern.entry_count() - mesh.vertex_count());
        stage.for_each(pattern.edges(), |(i, j, _)| ends.push([i, j]))?;
        // Every column has its diagonal before its edges.
        let edge_of = |entry: u32, [i, j]: [u32; 2]| match i == j {
            // A triangle that repeats an index has no area, so its unknowns are of no account.
            true => 0,
            false => entry - i.min(j) - 1,
        };
        let corners = Arc::clone(mesh.triangles());
        let entries = stage.pass(|| pattern.edge_entries(&corners))?;
        let of_face = |face: usize| {
            let ([i, j, k], [a, b, c]): ([u32; 3], [u32; 3]) = (corners[face], entries[face]);
            [edge_of(a, [j, k]), edge_of(b, [k, i]), edge_of(c, [i, j])]
        };
        let edges = stage.pass(|| parallel::values(corners.len(), of_face))?;
        Ok(Self {
            ends,
            edges: edges.into(),
            face_areas: Arc::clone(mesh.shared_face_areas()),
            vertex_areas: mesh.vertex_areas().to_vec(),
            corners,
        })
    }

    /// D: ∇w = −2 Σ_k w_k ∇λ_k on each triangle, λ_k the hat function of the corner opposite to edge k
    /// and `gradient` that of the hat functions.
    pub fn gradient(&self, gradient: &Gradient) -> Gradient {
        let hats = gradient.later_hats().iter();
        let hats = hats.map(|hats| hats.map(|hat| hat.map(|component| -2.0 * component)));
        Gradient::of_functions(
            hats.collect(),
            Arc::clone(&self.edges),
            Arc::clone(&self.face_areas),
            self.ends.len(),
        )
    }

    /// M: a third of the area of each edge's triangles, length², E; 0 for edges without area.
    pub fn areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.ends.len()];
        for (edges, area) in self.edges.iter().zip(&*self.face_areas) {
            for &edge in edges {
                areas[edge as usize] += area / 3.0;
            }
        }
        areas
    }

    /// c_T of [`crate::operators::Mass`], F: A κ/12 with the κ of the triangle's shape.
    pub fn couplings(&self, mesh: &TriangleMesh) -> Vec<f64> {
        parallel::values(self.corners.len(), |face| {
            self.face_areas[face] / 12.0 * over_lumping(mesh.edge_lengths(face))
        })
    }

    /// The vertices of each edge, E.
    pub fn ends(&self) -> &[[u32; 2]] {
        &self.ends
    }

    /// Number of vertices, V.
    pub fn vertex_count(&self) -> usize {
        self.vertex_areas.len()
    }

    /// S f of a function f, `values` (C, V): (f_i + f_j)/2 on every edge, (C, E).
    pub fn sample(&self, values: ArrayView2<f64>) -> Array2<f64> {
        Array2::from_shape_fn((values.nrows(), self.ends.len()), |(channel, edge)| {
            let [i, j] = self.ends[edge].map(|end| values[[channel, end as usize]]);
            0.5 * (i + j)
        })
    }

    /// A function on the vertices, (C, V), for `unknowns` w (C, E), with the same mean: the mean of w
    /// around each vertex, corrected with a limiter so that S f leads back to f where neighbours
    /// leave room for it. A vertex without area keeps its value of `before` (C, V).
    pub fn interpolate(&self, unknowns: ArrayView2<f64>, before: ArrayView2<f64>) -> Array2<f64> {
        let mut function = before.to_owned();
        for (w, mut values) in unknowns.rows().into_iter().zip(function.rows_mut()) {
            let sums = self.around_vertices(w);
            for ((value, sum), area) in values.iter_mut().zip(sums).zip(&self.vertex_areas) {
                if *area > 0.0 {
                    *value = sum / area;
                }
            }
        }
        function
    }

    /// The integrals of an interpolated function over the vertices' areas, V.
    fn around_vertices(&self, w: ArrayView1<f64>) -> Vec<f64> {
        let mut corrections = Corrections::new(self.vertex_areas.len());
        self.for_each_face(w, |corners, values, third| {
            corrections.take_in(corners, values, third);
        });
        let limits = corrections.limits(&self.vertex_areas);
        self.for_each_face(w, |corners, values, third| {
            corrections.correct(corners, values, third, &limits);
        });
        corrections.into_sums()
    }

    /// Calls `work` with the corners of each triangle, w at the edges opposite to them, and A/3.
    fn for_each_face(&self, w: ArrayView1<f64>, mut work: impl FnMut([usize; 3], [f64; 3], f64)) {
        let faces = self
            .corners
            .iter()
            .zip(self.edges.iter())
            .zip(&*self.face_areas);
        for ((corners, edges), &area) in faces {
            if area > 0.0 {
                let values = edges.map(|edge| w[edge as usize]);
                work(corners.map(|corner| corner as usize), values, area / 3.0);
            }
        }
    }
}
