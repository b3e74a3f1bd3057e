//! L(w) = Gᵀ diag(A w) G, and the systems M + τ L(w): one fixed sparsity pattern.

use std::sync::{Arc, OnceLock};

use sprs::CsMatI;

use crate::error::Result;
use crate::graph::Graph;
use crate::monitor::Stage;
use crate::operators::grouped::grouped;
use crate::operators::{FaceVector, Gradient};
use crate::parallel;

/// The sparsity pattern shared by every weighted Laplacian of a mesh, and where each face's
/// entries go.
///
/// Matrices are lower triangles in compressed columns, as the Cholesky factorization reads them.
#[derive(Debug, Clone)]
pub struct LaplacianPattern {
    /// Its neighbours, and where their entries are.
    graph: Arc<Graph>,
    /// Positions of each face's three off-diagonal entries, opposite to its corners. Made for assembly
    /// only; flows on large meshes never ask for them.
    edge_entries: OnceLock<Vec<[u32; 3]>>,
}

impl LaplacianPattern {
    /// The pattern of the mesh that `gradient` belongs to.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(gradient: &Gradient, stage: Stage) -> Result<Self> {
        let graph = graph_of(gradient.triangles(), gradient.vertex_count(), stage)?;
        Ok(Self::of_graph(graph))
    }

    /// The pattern with this `graph`.
    pub(crate) fn of_graph(graph: Graph) -> Self {
        Self {
            graph: Arc::new(graph),
            edge_entries: OnceLock::new(),
        }
    }

    /// Number of entries.
    pub fn entry_count(&self) -> usize {
        self.graph.entry_count()
    }

    /// Positions of each face's three off-diagonal entries, opposite to its corners; that of the first
    /// diagonal entry where a face repeats an index, as it adds 0.
    pub fn edge_entries(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let graph = &*self.graph;
        let entry = |i: u32, j: u32| {
            let neighbours = graph.neighbours_of(i as usize);
            match neighbours.binary_search_by_key(&j, |pair| pair.0) {
                Ok(place) => neighbours[place].1,
                // Nothing is its own neighbour.
                Err(_) => 0,
            }
        };
        let entries = |&[i, j, k]: &[u32; 3]| [entry(j, k), entry(k, i), entry(i, j)];
        parallel::map(triangles, entries)
    }

    /// Every edge once: its vertices, the lower one first, and its entry.
    pub fn edges(&self) -> impl Iterator<Item = (u32, u32, u32)> + '_ {
        (0..self.graph.size()).flat_map(move |vertex| {
            let vertex = vertex as u32;
            let neighbours = self.graph.neighbours_of(vertex as usize).iter();
            let later = neighbours.filter(move |(other, _)| *other > vertex);
            later.map(move |&(other, entry)| (vertex, other, entry))
        })
    }

    /// All neighbours of every vertex with their entries.
    pub(crate) fn graph(&self) -> &Arc<Graph> {
        &self.graph
    }

    /// A matrix of this pattern with all entries 0.
    pub fn zeros(&self) -> CsMatI<f64, u32> {
        self.graph.lower_triangle()
    }

    /// Fills `system` with diag(`diagonal`) + Σ_f K_f, where `stiffness` gives the off-diagonal
    /// entries of each face's K_f, opposite to its corners. Rows of every K_f sum to 0.
    pub fn assemble(
        &self,
        gradient: &Gradient,
        diagonal: &[f64],
        stiffness: impl Fn(usize) -> [f64; 3],
        system: &mut CsMatI<f64, u32>,
    ) {
        if self.edge_entries.get().is_none() {
            // Whoever was faster has made the same.
            let _ = self
                .edge_entries
                .set(self.edge_entries(gradient.triangles()));
        }
        let edge_entries = self.edge_entries.get().into_iter().flatten();
        // The diagonal is the first entry of its column, as rows are sorted.
        let starts = system.proper_indptr().into_owned();
        let values = system.data_mut();
        values.fill(0.0);
        for (start, value) in starts.iter().zip(diagonal) {
            values[*start as usize] = *value;
        }
        for (face, (corners, entries)) in gradient.triangles().iter().zip(edge_entries).enumerate()
        {
            let edges = stiffness(face);
            let [a, b, c] = edges;
            for (&entry, edge) in entries.iter().zip(edges) {
                values[entry as usize] += edge;
            }
            for (&corner, sum) in corners.iter().zip([b + c, c + a, a + b]) {
                values[starts[corner as usize] as usize] -= sum;
            }
        }
    }
}

/// Turns the rows and columns of `fixed` vertices (V, or empty for none) of `matrix`, a lower
/// triangle, into those of the identity.
pub fn pin(fixed: &[bool], matrix: &mut CsMatI<f64, u32>) {
    if fixed.is_empty() {
        return;
    }
    for (column, mut entries) in matrix.outer_iterator_mut().enumerate() {
        for (row, value) in entries.iter_mut() {
            if fixed[row] || fixed[column] {
                *value = if row == column { 1.0 } else { 0.0 };
            }
        }
    }
}

/// The off-diagonal entries, opposite to the corners, of a face's stiffness A w Gᵀ G.
#[inline]
pub fn element_stiffness(hats: &[FaceVector; 3], scale: f64) -> [f64; 3] {
    let dot = |p: FaceVector, q: FaceVector| scale * (p[0] * q[0] + p[1] * q[1]);
    [
        dot(hats[1], hats[2]),
        dot(hats[2], hats[0]),
        dot(hats[0], hats[1]),
    ]
}

/// Faces at a vertex among whose corners it is quick to look for one.
const FEW: usize = 16;

/// The graph of so many vertices between which `triangles` have edges.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(crate) fn graph_of(triangles: &[[u32; 3]], vertices: usize, stage: Stage) -> Result<Graph> {
    let (starts, corners) = grouped(triangles.as_flattened(), vertices, stage)?;
    let list = |vertex: usize, others: &mut Vec<u32>| {
        let corners = &corners[starts[vertex] as usize..starts[vertex + 1] as usize];
        // To look through a few takes less time than to sort twice as many.
        let are_few = corners.len() <= FEW;
        for turn in [1, 2] {
            for &corner in corners {
                let other = triangles[corner as usize / 3][(corner as usize + turn) % 3];
                if other as usize != vertex && !(are_few && others.contains(&other)) {
                    others.push(other);
                }
            }
        }
        others.sort_unstable();
        others.dedup();
    };
    Graph::listed(vertices, list, stage)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::examples::five_vertices;
    use crate::monitor::Monitor;

    #[test]
    fn assembly_equals_the_product_of_the_gradient() {
        // A fin on edge 1-2 makes it non-manifold; vertex 4 is in a repeated-index face only.
        let triangles = [[0, 1, 2], [1, 3, 2], [2, 1, 0], [4, 4, 1]];
        let mesh = five_vertices(&triangles);
        let gradient = Gradient::new(&mesh, Monitor::new().whole()).unwrap();
        let weights = [2.0, 0.5, 3.0, 7.0];
        let pattern = LaplacianPattern::new(&gradient, Monitor::new().whole()).unwrap();
        let mut lower = pattern.zeros();
        let stiffness = |face: usize| {
            let scale = gradient.face_areas()[face] * weights[face];
            element_stiffness(&gradient.hats(face), scale)
        };
        pattern.assemble(&gradient, &[0.0; 5], stiffness, &mut lower);

        let g = gradient.matrix();
        let scaled = g.clone();
        let mut scaled = scaled.into_csr();
        for (row, mut vector) in scaled.outer_iterator_mut().enumerate() {
            let factor = weights[row / 2] * gradient.face_areas()[row / 2];
            vector.iter_mut().for_each(|(_, value)| *value *= factor);
        }
        let product = (&g.transpose_view().to_csr() * &scaled).to_dense();
        let mut assembled = lower.to_dense();
        for i in 0..5 {
            for j in i + 1..5 {
                assembled[[i, j]] = assembled[[j, i]];
            }
        }
        assert!((&product - &assembled).iter().all(|d| d.abs() < 1e-12));
    }
}
