//! Breadth-first vertex order: neighbours in the mesh become neighbours in memory.

use sprs::CsMatI;

use crate::error::Result;
use crate::monitor::Stage;
use crate::solver::graph::Graph;

/// Vertices between two looks at whether the work was cancelled.
const PIECE: usize = 1 << 16;

/// A permutation of the vertices, and the neighbours of each in it.
///
/// Iterates then depend on the order the caller gave by rounding and ties alone, and a sweep
/// finds the values of neighbours in cache.
pub(super) struct Ordering {
    /// The caller's index of each vertex.
    pub order: Vec<u32>,
    /// Where each of the caller's vertices is in it.
    pub places: Vec<u32>,
    /// First neighbour of each vertex in `neighbours`, V + 1.
    pub starts: Vec<u32>,
    /// The neighbours of each, by their place in the order.
    pub neighbours: Vec<u32>,
    /// The entries of the matrix's lower triangle that couple them.
    pub entries: Vec<u32>,
}

impl Ordering {
    /// The order of the graph of a matrix, of which `lower` is the lower triangle.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn breadth_first(lower: &CsMatI<f64, u32>, stage: Stage) -> Result<Self> {
        let graph = Graph::new(lower, stage)?;
        let order = graph.breadth_first(stage)?;
        let mut places = vec![0; order.len()];
        stage.for_each(order.iter().enumerate(), |(place, &vertex)| {
            places[vertex as usize] = place as u32;
        })?;
        let mut starts = Vec::with_capacity(order.len() + 1);
        let mut neighbours = Vec::with_capacity(graph.neighbours.len());
        let mut entries = Vec::with_capacity(graph.neighbours.len());
        let mut row: Vec<(u32, u32)> = Vec::new();
        starts.push(0);
        stage.for_each(&order, |&vertex| {
            let of_vertex = graph.neighbours_of(vertex as usize).iter();
            row.clear();
            row.extend(of_vertex.map(|&(other, entry)| (places[other as usize], entry)));
            row.sort_unstable();
            neighbours.extend(row.iter().map(|pair| pair.0));
            entries.extend(row.iter().map(|pair| pair.1));
            starts.push(neighbours.len() as u32);
        })?;
        Ok(Self {
            places,
            order,
            starts,
            neighbours,
            entries,
        })
    }
}

impl Graph {
    /// The vertices, component by component, ring by ring around the end of a first search:
    /// rings are then short.
    fn breadth_first(&self, stage: Stage) -> Result<Vec<u32>> {
        let size = self.starts.len() - 1;
        let mut order = Vec::with_capacity(size);
        let mut visited = vec![false; size];
        for seed in 0..size {
            if visited[seed] {
                continue;
            }
            let first = order.len();
            self.visit(seed as u32, &mut visited, &mut order, stage)?;
            let farthest = order[order.len() - 1];
            for vertex in order.drain(first..) {
                visited[vertex as usize] = false;
            }
            self.visit(farthest, &mut visited, &mut order, stage)?;
        }
        Ok(order)
    }

    fn visit(
        &self,
        seed: u32,
        visited: &mut [bool],
        order: &mut Vec<u32>,
        stage: Stage,
    ) -> Result<()> {
        let mut next = order.len();
        visited[seed as usize] = true;
        order.push(seed);
        while next < order.len() {
            if next.is_multiple_of(PIECE) {
                stage.check()?;
            }
            for &(neighbour, _) in self.neighbours_of(order[next] as usize) {
                if !visited[neighbour as usize] {
                    visited[neighbour as usize] = true;
                    order.push(neighbour);
                }
            }
            next += 1;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Monitor;
    use crate::solver::multigrid::examples::lattice;

    #[test]
    fn every_vertex_has_one_place_and_its_neighbours_are_near() {
        let (lower, _) = lattice(40, 30, 1.0);
        let monitor = Monitor::new();
        let ordering = Ordering::breadth_first(&lower, monitor.whole()).unwrap();
        let mut sorted = ordering.order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(i, &v)| i == v as usize));
        for place in 0..ordering.order.len() {
            let range = ordering.starts[place] as usize..ordering.starts[place + 1] as usize;
            let neighbours = ordering.neighbours[range.clone()].iter();
            for (&neighbour, &entry) in neighbours.zip(&ordering.entries[range]) {
                let ends = [place, neighbour as usize].map(|p| ordering.order[p]);
                assert_eq!(lower.indices()[entry as usize], ends[0].max(ends[1]));
                assert!((neighbour as usize).abs_diff(place) <= 80);
            }
        }
    }
}
