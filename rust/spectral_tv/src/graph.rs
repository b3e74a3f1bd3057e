//! The graph of a symmetric matrix: its vertices are the rows, its edges the couplings.

use sprs::CsMatI;

use crate::error::Result;
use crate::monitor::Stage;

/// The neighbours of every vertex in order, each with the entry of the lower triangle that couples them.
#[derive(Debug, Clone)]
pub(crate) struct Graph {
    /// First neighbour of each vertex, V + 1.
    pub starts: Vec<u32>,
    pub neighbours: Vec<(u32, u32)>,
    /// Whether its vertices are known to be numbered breadth first.
    pub is_breadth_first: bool,
}

impl Graph {
    /// The graph of the matrix with the lower triangle `lower`.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(lower: &CsMatI<f64, u32>, stage: Stage) -> Result<Self> {
        Self::of_columns(&lower.proper_indptr(), lower.indices(), stage)
    }

    /// The graph of the matrix whose lower triangle has these `rows`, column by column, each of which
    /// begins at one of `columns`.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn of_columns(columns: &[u32], rows: &[u32], stage: Stage) -> Result<Self> {
        let size = columns.len() - 1;
        let edges = || {
            (0..size).flat_map(|column| {
                (columns[column]..columns[column + 1])
                    .map(move |entry| (column as u32, rows[entry as usize], entry))
                    .filter(|(column, row, _)| column != row)
            })
        };
        let mut starts = vec![0_u32; size + 1];
        stage.for_each(edges(), |(i, j, _)| {
            starts[i as usize + 1] += 1;
            starts[j as usize + 1] += 1;
        })?;
        for vertex in 0..size {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![(0, 0); starts[size] as usize];
        stage.for_each(edges(), |(i, j, entry)| {
            for (from, to) in [(i, j), (j, i)] {
                let place = &mut next[from as usize];
                neighbours[*place as usize] = (to, entry);
                *place += 1;
            }
        })?;
        Ok(Self {
            starts,
            neighbours,
            is_breadth_first: false,
        })
    }

    /// Number of entries in a lower triangle with this graph and a whole diagonal.
    pub fn entry_count(&self) -> usize {
        self.size() + self.neighbours.len() / 2
    }

    /// Number of vertices.
    pub fn size(&self) -> usize {
        self.starts.len() - 1
    }

    /// A lower triangle with this graph, all entries 0: each column its diagonal first, as in what the graph
    /// was made of.
    pub fn lower_triangle(&self) -> CsMatI<f64, u32> {
        let (size, count) = (self.size(), self.entry_count());
        let mut columns = Vec::with_capacity(size + 1);
        let mut rows = Vec::with_capacity(count);
        columns.push(0);
        for vertex in 0..size {
            let column = vertex as u32;
            let neighbours = self.neighbours_of(vertex).iter().map(|pair| pair.0);
            rows.push(column);
            rows.extend(neighbours.filter(|&row| row > column));
            columns.push(rows.len() as u32);
        }
        CsMatI::new_csc((size, size), columns, rows, vec![0.0; count])
    }

    /// The neighbours of one.
    pub fn neighbours_of(&self, vertex: usize) -> &[(u32, u32)] {
        &self.neighbours[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}
