//! L(w) by its edges: L u = Σ_j c_ij (u_i − u_j). The couplings c are gathered from the faces.
//!
//! Every value is gathered and none scattered. So threads can share the work, and the results do
//! not depend on how they do.

use std::sync::Arc;

use ndarray::{Array2, ArrayViewMut2, Axis};
use rayon::prelude::*;

use crate::error::Result;
use crate::graph::Graph;
use crate::monitor::Stage;
use crate::operators::side_by_side::{Lanes, SideBySide, WIDTH};
use crate::operators::{Gradient, LaplacianPattern, element_stiffness};
use crate::parallel;

/// No corner of a face.
const NONE: u32 = u32::MAX;

/// The edges of a mesh, with the faces and the neighbours at each.
#[derive(Debug, Clone)]
pub struct EdgeLaplacian {
    /// The corners of the first two faces at each entry of the pattern that face the edge, three times the
    /// face and the corner's place in it; [`NONE`] for what there is not, as at diagonal entries.
    corners: Vec<[u32; 2]>,
    /// Entry and corner of further faces: edges are rarely non-manifold.
    further: Vec<(u32, u32)>,
    /// Shared with solvers.
    graph: Arc<Graph>,
}

impl EdgeLaplacian {
    /// The edges of the mesh that `gradient` and `pattern` belong to.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(gradient: &Gradient, pattern: &LaplacianPattern, stage: Stage) -> Result<Self> {
        let edges = stage.pass(|| pattern.edge_entries(gradient.triangles()))?;
        let mut corners = vec![[NONE; 2]; pattern.entry_count()];
        let mut further = Vec::new();
        stage.for_each(
            edges.as_flattened().iter().enumerate(),
            |(corner, &entry)| {
                let places = &mut corners[entry as usize];
                match places.iter_mut().find(|place| **place == NONE) {
                    Some(place) => *place = corner as u32,
                    None => further.push((entry, corner as u32)),
                }
            },
        )?;
        drop(edges);
        Ok(Self {
            corners,
            further,
            graph: Arc::clone(pattern.graph()),
        })
    }

    /// c of every entry of the pattern for the weights w of the faces of `gradient`; 0 for diagonal entries.
    pub fn couplings(&self, gradient: &Gradient, weights: &[f64]) -> Vec<f64> {
        let areas = gradient.face_areas();
        let shares = parallel::values(areas.len(), |face| {
            element_stiffness(&gradient.hats(face), -areas[face] * weights[face])
        });
        self.couplings_of(&shares)
    }

    /// The same from the `shares` of every face in the couplings of the edges that its corners face.
    pub fn couplings_of(&self, shares: &[[f64; 3]]) -> Vec<f64> {
        let shares = shares.as_flattened();
        let share = |corner: u32| match corner {
            NONE => 0.0,
            corner => shares[corner as usize],
        };
        let coupling = |corners: &[u32; 2]| share(corners[0]) + share(corners[1]);
        let mut couplings = parallel::map(self.corners.par_iter(), coupling);
        for &(entry, corner) in &self.further {
            couplings[entry as usize] += share(corner);
        }
        couplings
    }

    /// L u for `values` u (C, V).
    pub fn apply(&self, couplings: &[f64], values: &SideBySide) -> Array2<f64> {
        let mut product = parallel::zeros((values.channel_count(), self.graph.size()));
        match values {
            SideBySide::One(lanes) => self.apply_to(couplings, lanes, product.view_mut()),
            SideBySide::Several { blocks, .. } => {
                let products = product.axis_chunks_iter_mut(Axis(0), WIDTH);
                for (lanes, product) in blocks.iter().zip(products) {
                    self.apply_to(couplings, lanes, product);
                }
            }
        }
        product
    }

    /// `product` ← L u for at most L channels.
    fn apply_to<const L: usize>(
        &self,
        couplings: &[f64],
        lanes: &[Lanes<L>],
        mut product: ArrayViewMut2<f64>,
    ) {
        parallel::columns_mut(&mut product).for_each(|(first, mut product)| {
            let count = product.ncols();
            let rows = product.rows_mut().into_iter();
            let mut rows: Vec<&mut [f64]> = rows.filter_map(|row| row.into_slice()).collect();
            for (offset, own) in lanes[first..first + count].iter().enumerate() {
                let sum = self.at_vertex(first + offset, own, couplings, lanes);
                for (row, sum) in rows.iter_mut().zip(sum) {
                    row[offset] = sum;
                }
            }
        });
    }

    #[inline(always)]
    fn at_vertex<const L: usize>(
        &self,
        vertex: usize,
        own: &Lanes<L>,
        couplings: &[f64],
        lanes: &[Lanes<L>],
    ) -> Lanes<L> {
        let mut sum = [0.0; L];
        for &(other, entry) in self.graph.neighbours_of(vertex) {
            let (coupling, other) = (couplings[entry as usize], &lanes[other as usize]);
            for lane in 0..L {
                sum[lane] += coupling * (own[lane] - other[lane]);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::examples::five_vertices;
    use crate::monitor::Monitor;

    #[test]
    fn edges_give_what_the_gradient_and_its_adjoint_give() {
        // A non-manifold edge 1-2, a repeated index and a vertex without neighbours.
        let triangles = [[0, 1, 2], [1, 3, 2], [2, 1, 0], [3, 3, 1]];
        let mesh = five_vertices(&triangles);
        let monitor = Monitor::new();
        let gradient = Gradient::new(&mesh, monitor.whole()).unwrap();
        let pattern = LaplacianPattern::new(&gradient, monitor.whole()).unwrap();
        let edges = EdgeLaplacian::new(&gradient, &pattern, monitor.whole()).unwrap();
        let weights = [2.0, 0.5, 3.0, 7.0];
        let values = ndarray::arr2(&[[1.0, -2.0, 0.5, 3.0, 1.0], [0.0, 4.0, 1.0, -1.0, 2.0]]);
        let couplings = edges.couplings(&gradient, &weights);
        let product = edges.apply(&couplings, &values.view().into());
        for (row, channel) in product.rows().into_iter().zip(values.rows()) {
            let expected = gradient.weighted_laplacian(&weights, channel);
            assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }
}
