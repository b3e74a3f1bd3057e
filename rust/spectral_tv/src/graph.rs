//! The graph of a symmetric matrix: its vertices are the rows, its edges the couplings.

use std::ops::Range;

use sprs::CsMatI;

use crate::error::Result;
use crate::monitor::Stage;
use crate::parallel;

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
        let (columns, rows) = (lower.proper_indptr(), lower.indices());
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

    /// The graph of a symmetric matrix of `size` rows, given what `list` adds to an empty list for each vertex:
    /// its neighbours in order. Threads share the work.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn listed(
        size: usize,
        list: impl Fn(usize, &mut Vec<u32>) + Sync + Send,
        stage: Stage,
    ) -> Result<Self> {
        let lists = Lists::new(size, list, stage)?;
        let earlier =
            stage.pass(|| parallel::values(size, |vertex| lists.before(vertex, vertex)))?;
        // Where the entries below the diagonal begin in each column, were there some above it.
        let mut end = 0;
        let column = |(vertex, &earlier): (usize, &u32)| {
            let begin = end + 1;
            end = begin + lists.of(vertex).len() as u32 - earlier;
            begin.wrapping_sub(earlier)
        };
        let columns: Vec<u32> = earlier.iter().enumerate().map(column).collect();
        let entry = |column: usize, place: u32| columns[column].wrapping_add(place);
        let (all, entry) = (&lists, &entry);
        let neighbours = |vertex: usize| {
            (0..).zip(all.of(vertex)).map(move |(place, &other)| {
                let entry = match other as usize > vertex {
                    true => entry(vertex, place),
                    false => entry(other as usize, all.before(other as usize, vertex)),
                };
                (other, entry)
            })
        };
        let piece = |vertices: Range<usize>| vertices.flat_map(&neighbours).collect::<Vec<_>>();
        let neighbours = stage.pass(|| parallel::parts(size, piece).concat())?;
        Ok(Self {
            starts: lists.starts,
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

/// The neighbours of every vertex in order.
struct Lists {
    /// First neighbour of each vertex, V + 1.
    starts: Vec<u32>,
    others: Vec<u32>,
}

impl Lists {
    /// See [`Graph::listed`].
    fn new(
        size: usize,
        list: impl Fn(usize, &mut Vec<u32>) + Sync + Send,
        stage: Stage,
    ) -> Result<Self> {
        let piece = |vertices: Range<usize>| {
            let (mut ends, mut others) = (Vec::with_capacity(vertices.len()), Vec::new());
            let mut own = Vec::new();
            for vertex in vertices {
                own.clear();
                list(vertex, &mut own);
                others.extend_from_slice(&own);
                ends.push(others.len() as u32);
            }
            (ends, others)
        };
        let pieces = stage.pass(|| parallel::parts(size, piece))?;
        let (ends, others): (Vec<_>, Vec<_>) = pieces.into_iter().unzip();
        let mut starts = Vec::with_capacity(size + 1);
        starts.push(0);
        for ends in ends {
            let first = starts[starts.len() - 1];
            starts.extend(ends.iter().map(|end| first + end));
        }
        let others = stage.pass(|| others.concat())?;
        Ok(Self { starts, others })
    }

    fn of(&self, vertex: usize) -> &[u32] {
        &self.others[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// How many neighbours of a vertex come before `other`.
    fn before(&self, vertex: usize, other: usize) -> u32 {
        let neighbours = self.of(vertex);
        neighbours.partition_point(|&neighbour| (neighbour as usize) < other) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Monitor;

    #[test]
    fn lists_of_neighbours_give_the_graph_of_the_matrix() {
        // A lattice in two pieces for threads.
        let (rows, columns) = (90, 100);
        let size = rows * columns;
        let list = |vertex: usize, others: &mut Vec<u32>| {
            let (row, column) = (vertex / columns, vertex % columns);
            let around = [
                (row > 0, vertex.wrapping_sub(columns)),
                (column > 0, vertex.wrapping_sub(1)),
                (column + 1 < columns, vertex + 1),
                (row + 1 < rows, vertex + columns),
            ];
            others.extend(
                around
                    .iter()
                    .filter(|(is_there, _)| *is_there)
                    .map(|&(_, v)| v as u32),
            );
        };
        let monitor = Monitor::new();
        let graph = Graph::listed(size, list, monitor.whole()).unwrap();
        let edges = rows * (columns - 1) + (rows - 1) * columns;
        assert_eq!(graph.entry_count(), size + edges);
        let same = Graph::new(&graph.lower_triangle(), monitor.whole()).unwrap();
        assert_eq!(
            (graph.starts, graph.neighbours),
            (same.starts, same.neighbours)
        );
    }
}
