//! Breadth-first vertex order: neighbours in the mesh become neighbours in memory.

use std::sync::Arc;

use crate::error::Result;
use crate::graph::Graph;
use crate::monitor::Stage;

/// Vertices between two looks at whether the work was cancelled.
const PIECE: usize = 1 << 16;

/// A permutation of the vertices of a graph.
///
/// Iterates then depend on the order the caller gave by rounding and ties alone, and a sweep
/// finds the values of neighbours in cache.
pub(super) struct Ordering {
    /// The caller's index of each vertex.
    pub order: Vec<u32>,
    /// Where each of the caller's vertices is in it.
    pub places: Vec<u32>,
    /// The graph, by the caller's indices.
    pub graph: Arc<Graph>,
}

impl Ordering {
    /// The order of a graph.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn breadth_first(graph: Arc<Graph>, stage: Stage) -> Result<Self> {
        let order = graph.breadth_first(stage)?;
        let mut places = vec![0; order.len()];
        stage.for_each(order.iter().enumerate(), |(place, &vertex)| {
            places[vertex as usize] = place as u32;
        })?;
        Ok(Self {
            order,
            places,
            graph,
        })
    }

    /// The neighbours of the vertex at a place, by the caller's indices, with the entries that couple them.
    #[inline]
    pub fn neighbours_at(&self, place: usize) -> &[(u32, u32)] {
        self.graph.neighbours_of(self.order[place] as usize)
    }

    /// Fills `row` with the same by their places, in order. To sort them for each matrix costs less than to
    /// keep them.
    #[inline]
    pub fn sorted_row(&self, place: usize, row: &mut Vec<(u32, u32)>) {
        let neighbours = self.neighbours_at(place).iter();
        row.clear();
        row.extend(neighbours.map(|&(other, entry)| (self.places[other as usize], entry)));
        row.sort_unstable();
    }
}

impl Graph {
    /// The vertices, component by component, ring by ring around the end of a first search:
    /// rings are then short.
    fn breadth_first(&self, stage: Stage) -> Result<Vec<u32>> {
        let size = self.size();
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
        let graph = Arc::new(Graph::new(&lower, monitor.whole()).unwrap());
        let ordering = Ordering::breadth_first(graph, monitor.whole()).unwrap();
        let mut sorted = ordering.order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(i, &v)| i == v as usize));
        for place in 0..ordering.order.len() {
            for &(neighbour, entry) in ordering.neighbours_at(place) {
                let vertex = ordering.order[place];
                assert_eq!(lower.indices()[entry as usize], vertex.max(neighbour));
                assert!((ordering.places[neighbour as usize] as usize).abs_diff(place) <= 80);
            }
        }
    }
}
