//! L(w) by its edges: L u = Σ_j c_ij (u_i − u_j). The couplings c are gathered from the faces.
//!
//! Every value is gathered and none scattered. So threads can share the work, and the results do
//! not depend on how they do.

use ndarray::{Array2, ArrayViewMut2, Axis};
use rayon::prelude::*;

use crate::error::Result;
use crate::monitor::Stage;
use crate::operators::side_by_side::{Lanes, SideBySide, WIDTH};
use crate::operators::{Gradient, LaplacianPattern, Neighbour};
use crate::parallel;

/// The edges of a mesh, with the faces and the neighbours at each.
#[derive(Debug, Clone)]
pub struct EdgeLaplacian {
    /// The first two faces at each entry of the pattern, and −A ⟨∇λ, ∇λ′⟩ on them, for the hat
    /// functions of the edge's ends; 0 for what there is not, as at diagonal entries.
    faces: Vec<[u32; 2]>,
    cotangents: Vec<[f64; 2]>,
    /// The same for further faces, with the entry and the face: edges are rarely non-manifold.
    further: Vec<(u32, u32, f64)>,
    /// First neighbour of each vertex, and their number at the end.
    starts: Vec<u32>,
    /// The neighbours, and their entries of the pattern.
    neighbours: Vec<Neighbour>,
}

impl EdgeLaplacian {
    /// The edges of the mesh that `gradient` and `pattern` belong to.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(gradient: &Gradient, pattern: &LaplacianPattern, stage: Stage) -> Result<Self> {
        let edges = pattern.edge_entries();
        let (starts, order) = grouped(edges.as_flattened(), pattern.entry_count(), stage)?;
        let cotangent = |corner: u32| {
            let (face, corner) = (corner as usize / 3, corner as usize % 3);
            let hats = &gradient.hats()[face];
            let (p, q) = (hats[(corner + 1) % 3], hats[(corner + 2) % 3]);
            -gradient.face_areas()[face] * (p[0] * q[0] + p[1] * q[1])
        };
        let corners = |ends: &[u32]| &order[ends[0] as usize..ends[1] as usize];
        let both = |ends: &[u32], which: usize| corners(ends).get(which).copied();
        let entries = || starts.par_windows(2);
        let faces = |ends: &[u32]| [0, 1].map(|i| both(ends, i).map_or(0, |corner| corner / 3));
        let faces = stage.pass(|| parallel::map(entries(), faces))?;
        let cotangents = |ends: &[u32]| [0, 1].map(|i| both(ends, i).map_or(0.0, cotangent));
        let cotangents = stage.pass(|| parallel::map(entries(), cotangents))?;
        let mut further = Vec::new();
        stage.for_each(starts.windows(2).enumerate(), |(entry, ends)| {
            let corners = corners(ends).iter().skip(2);
            further.extend(corners.map(|&corner| (entry as u32, corner / 3, cotangent(corner))));
        })?;
        let (starts, neighbours) = pattern.neighbours(stage)?;
        Ok(Self {
            faces,
            cotangents,
            further,
            starts,
            neighbours,
        })
    }

    /// c of every entry of the pattern for the weights w of the faces; 0 for diagonal entries.
    pub fn couplings(&self, weights: &[f64]) -> Vec<f64> {
        if weights.is_empty() {
            return vec![0.0; self.faces.len()];
        }
        let coupling = |(faces, cotangents): (&[u32; 2], &[f64; 2])| {
            let (a, b) = (weights[faces[0] as usize], weights[faces[1] as usize]);
            cotangents[0] * a + cotangents[1] * b
        };
        let entries = self.faces.par_iter().zip(&self.cotangents);
        let mut couplings = parallel::map(entries, coupling);
        for &(entry, face, cotangent) in &self.further {
            couplings[entry as usize] += cotangent * weights[face as usize];
        }
        couplings
    }

    /// L u for `values` u (C, V).
    pub fn apply(&self, couplings: &[f64], values: &SideBySide) -> Array2<f64> {
        let mut product = Array2::zeros((values.channel_count(), self.starts.len() - 1));
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
        let bounds = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
        let mut sum = [0.0; L];
        for &(other, entry) in &self.neighbours[bounds] {
            let (coupling, other) = (couplings[entry as usize], &lanes[other as usize]);
            for lane in 0..L {
                sum[lane] += coupling * (own[lane] - other[lane]);
            }
        }
        sum
    }
}

/// The places of each of the `count` keys in `keys`, one after the other, and where each key's
/// begin.
pub(crate) fn grouped(keys: &[u32], count: usize, stage: Stage) -> Result<(Vec<u32>, Vec<u32>)> {
    let mut starts = vec![0_u32; count + 1];
    stage.for_each(keys, |&key| starts[key as usize + 1] += 1)?;
    for key in 0..count {
        starts[key + 1] += starts[key];
    }
    let mut next = starts.clone();
    let mut places = vec![0; keys.len()];
    stage.for_each(keys.iter().enumerate(), |(place, &key)| {
        places[next[key as usize] as usize] = place as u32;
        next[key as usize] += 1;
    })?;
    Ok((starts, places))
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
        let couplings = edges.couplings(&weights);
        let product = edges.apply(&couplings, &values.view().into());
        for (row, channel) in product.rows().into_iter().zip(values.rows()) {
            let expected = gradient.weighted_laplacian(&weights, channel);
            assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }
}
