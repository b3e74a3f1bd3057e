//! The graph of a symmetric matrix: its vertices are the rows, its edges the couplings.

use sprs::CsMatI;

use crate::error::Result;
use crate::monitor::Stage;

/// The neighbours of every vertex, each with the entry of the lower triangle that couples them.
pub(super) struct Graph {
    /// First neighbour of each vertex, V + 1.
    pub starts: Vec<u32>,
    pub neighbours: Vec<(u32, u32)>,
}

impl Graph {
    /// The graph of the matrix with the lower triangle `lower`.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(lower: &CsMatI<f64, u32>, stage: Stage) -> Result<Self> {
        let columns = lower.proper_indptr();
        let edges = || {
            (0..lower.cols()).flat_map(|column| {
                (columns[column]..columns[column + 1])
                    .map(move |entry| (column as u32, lower.indices()[entry as usize], entry))
                    .filter(|(column, row, _)| column != row)
            })
        };
        let mut starts = vec![0_u32; lower.cols() + 1];
        stage.for_each(edges(), |(i, j, _)| {
            starts[i as usize + 1] += 1;
            starts[j as usize + 1] += 1;
        })?;
        for vertex in 0..lower.cols() {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![(0, 0); starts[lower.cols()] as usize];
        stage.for_each(edges(), |(i, j, entry)| {
            for (from, to) in [(i, j), (j, i)] {
                let place = &mut next[from as usize];
                neighbours[*place as usize] = (to, entry);
                *place += 1;
            }
        })?;
        Ok(Self { starts, neighbours })
    }

    /// The neighbours of one.
    pub fn neighbours_of(&self, vertex: usize) -> &[(u32, u32)] {
        &self.neighbours[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}
