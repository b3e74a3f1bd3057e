//! Breadth-first vertex order: neighbours in the mesh become neighbours in memory.

use std::sync::Arc;

use crate::error::Result;
use crate::graph::Graph;
use crate::monitor::Stage;
use crate::numbering::Numbering;

/// The vertices of a graph in the order of the levels.
///
/// Iterates then depend on the order the caller gave by rounding and ties alone, and a sweep
/// finds the values of neighbours in cache.
pub(super) struct Ordering {
    /// `None` where the caller's numbering is breadth first.
    numbering: Option<Numbering>,
    /// The graph, by the caller's indices.
    graph: Arc<Graph>,
}

impl Ordering {
    /// The order of a graph.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn breadth_first(graph: Arc<Graph>, stage: Stage) -> Result<Self> {
        let numbering = match graph.is_breadth_first {
            true => None,
            false => Some(Numbering::breadth_first(&graph, stage)?),
        };
        Ok(Self { numbering, graph })
    }

    /// Number of vertices.
    pub fn size(&self) -> usize {
        self.graph.size()
    }

    /// The caller's index of the vertex at a place.
    #[inline]
    pub fn vertex_at(&self, place: usize) -> usize {
        match &self.numbering {
            None => place,
            Some(numbering) => numbering.order[place] as usize,
        }
    }

    /// Where one of the caller's vertices is.
    #[inline]
    pub fn place_of(&self, vertex: usize) -> usize {
        match &self.numbering {
            None => vertex,
            Some(numbering) => numbering.places[vertex] as usize,
        }
    }

    /// Fills `row` with the places of the neighbours of the vertex at a place, in order, with the entries
    /// that couple them. To sort them for each matrix costs less than to keep them.
    #[inline]
    pub fn sorted_row(&self, place: usize, row: &mut Vec<(u32, u32)>) {
        let neighbours = self.graph.neighbours_of(self.vertex_at(place));
        row.clear();
        match &self.numbering {
            None => row.extend_from_slice(neighbours),
            Some(numbering) => {
                let place =
                    |&(other, entry): &(u32, u32)| (numbering.places[other as usize], entry);
                row.extend(neighbours.iter().map(place));
                row.sort_unstable();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Monitor;
    use crate::solver::multigrid::examples::lattice;

    #[test]
    fn rows_are_those_of_the_graph_in_order_whoever_numbered_it() {
        let (lower, _) = lattice(40, 30, 1.0);
        let monitor = Monitor::new();
        let graph = Graph::new(&lower, monitor.whole()).unwrap();
        let numbering = Numbering::breadth_first(&graph, monitor.whole()).unwrap();
        let ordered = Arc::new(numbering.renumbered(&graph, monitor.whole()).unwrap());
        let graph = Arc::new(graph);
        let [own, given] = [&graph, &ordered]
            .map(|graph| Ordering::breadth_first(Arc::clone(graph), monitor.whole()).unwrap());
        let (mut row, mut same) = (Vec::new(), Vec::new());
        for place in 0..own.size() {
            let vertex = own.vertex_at(place);
            assert_eq!(own.place_of(vertex), place);
            assert_eq!(given.vertex_at(place), place);
            own.sorted_row(place, &mut row);
            for &(other, entry) in &row {
                let lower_one = vertex.max(own.vertex_at(other as usize));
                assert_eq!(lower.indices()[entry as usize] as usize, lower_one);
            }
            given.sorted_row(place, &mut same);
            assert!(
                row.iter()
                    .map(|pair| pair.0)
                    .eq(same.iter().map(|pair| pair.0))
            );
        }
    }
}
