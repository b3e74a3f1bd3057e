//! A numbering of vertices by which neighbours are near each other in memory.
//!
//! A pass over a mesh reads values at neighbours. On large meshes most of its time is spent waiting
//! for those, unless they are in the processor's caches. Many files have their vertices in any order.
//! Flows and solvers number them breadth first, and give results in the numbering of the caller.

use ndarray::{Array2, ArrayView2, Zip};

use crate::error::Result;
use crate::graph::Graph;
use crate::monitor::Stage;

/// Vertices between two looks at whether the work was cancelled.
const PIECE: usize = 1 << 16;

/// A permutation of vertices.
#[derive(Debug)]
pub(crate) struct Numbering {
    /// The caller's number of each vertex.
    pub order: Vec<u32>,
    /// The number of each of the caller's vertices.
    pub places: Vec<u32>,
}

impl Numbering {
    /// The vertices of `graph`, component by component, ring by ring around the end of a first search:
    /// rings are then short.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn breadth_first(graph: &Graph, stage: Stage) -> Result<Self> {
        let size = graph.size();
        let mut order = Vec::with_capacity(size);
        let mut visited = vec![false; size];
        for seed in 0..size {
            if visited[seed] {
                continue;
            }
            let first = order.len();
            visit(graph, seed as u32, &mut visited, &mut order, stage)?;
            let farthest = order[order.len() - 1];
            for vertex in order.drain(first..) {
                visited[vertex as usize] = false;
            }
            visit(graph, farthest, &mut visited, &mut order, stage)?;
        }
        let mut places = vec![0; size];
        stage.for_each(order.iter().enumerate(), |(place, &vertex)| {
            places[vertex as usize] = place as u32;
        })?;
        Ok(Self { order, places })
    }

    /// The caller's `graph` in this numbering, which is breadth first for it.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn renumbered(&self, graph: &Graph, stage: Stage) -> Result<Graph> {
        let list = |place: usize, others: &mut Vec<u32>| {
            let neighbours = graph.neighbours_of(self.order[place] as usize).iter();
            others.extend(neighbours.map(|(other, _)| self.places[*other as usize]));
            others.sort_unstable();
        };
        Ok(Graph {
            is_breadth_first: true,
            ..Graph::listed(graph.size(), list, stage)?
        })
    }

    /// The caller's `values` (C, V) in this numbering.
    pub fn inwards<T: Copy + Default + Send + Sync>(&self, values: ArrayView2<T>) -> Array2<T> {
        gathered(values, &self.order)
    }

    /// `values` (C, V) of this numbering in the caller's.
    pub fn outwards<T: Copy + Default + Send + Sync>(&self, values: ArrayView2<T>) -> Array2<T> {
        gathered(values, &self.places)
    }
}

fn gathered<T: Copy + Default + Send + Sync>(values: ArrayView2<T>, numbers: &[u32]) -> Array2<T> {
    let mut result = Array2::from_elem(values.dim(), T::default());
    for (mut result, values) in result.rows_mut().into_iter().zip(values.rows()) {
        let take = |value: &mut T, number: &u32| *value = values[*number as usize];
        Zip::from(&mut result).and(numbers).par_for_each(take);
    }
    result
}

/// Appends to `order` what can be reached from `seed`.
fn visit(
    graph: &Graph,
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
        for &(neighbour, _) in graph.neighbours_of(order[next] as usize) {
            if !visited[neighbour as usize] {
                visited[neighbour as usize] = true;
                order.push(neighbour);
            }
        }
        next += 1;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Monitor;

    /// A lattice whose vertices are in any order.
    fn graph() -> Graph {
        let (rows, columns) = (30_u32, 40_u32);
        let size = rows * columns;
        // 7 has no factor in common with the size.
        let number = |i: u32, j: u32| (7 * (i * columns + j) + 5) % size;
        let mut lists = vec![Vec::new(); size as usize];
        for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            let ahead = [(i + 1, j), (i, j + 1)].into_iter();
            for (p, q) in ahead.filter(|&(p, q)| p < rows && q < columns) {
                let (a, b) = (number(i, j), number(p, q));
                lists[a as usize].push(b);
                lists[b as usize].push(a);
            }
        }
        lists.iter_mut().for_each(|list| list.sort_unstable());
        let list = |vertex: usize, others: &mut Vec<u32>| others.extend_from_slice(&lists[vertex]);
        Graph::listed(size as usize, list, Monitor::new().whole()).unwrap()
    }

    #[test]
    fn every_vertex_has_one_place_and_its_neighbours_are_near() {
        let (graph, monitor) = (graph(), Monitor::new());
        let numbering = Numbering::breadth_first(&graph, monitor.whole()).unwrap();
        let ordered = numbering.renumbered(&graph, monitor.whole()).unwrap();
        assert!(ordered.is_breadth_first);
        for (place, &vertex) in numbering.order.iter().enumerate() {
            assert_eq!(numbering.places[vertex as usize] as usize, place);
            let mut expected: Vec<u32> = graph
                .neighbours_of(vertex as usize)
                .iter()
                .map(|(other, _)| numbering.places[*other as usize])
                .collect();
            expected.sort_unstable();
            let found = ordered.neighbours_of(place).iter().map(|pair| pair.0);
            assert!(found.eq(expected.iter().copied()));
            assert!(
                expected
                    .iter()
                    .all(|other| place.abs_diff(*other as usize) <= 80)
            );
        }
        let values = Array2::from_shape_fn((2, graph.size()), |(c, v)| c * 10_000 + v);
        let inside = numbering.inwards(values.view());
        assert_eq!(inside[[1, 3]], 10_000 + numbering.order[3] as usize);
        assert_eq!(numbering.outwards(inside.view()), values);
    }
}
