//! Parts of a graph.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use crate::error::{Error, Result};
use crate::graph::Graph;

/// On which side of a separator a vertex lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    First,
    Second,
    Between,
}

/// A part of a graph.
pub(super) struct Part {
    /// The caller's index of each vertex.
    pub vertices: Vec<u32>,
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Part {
    /// All of a graph.
    pub fn whole(graph: Graph) -> Self {
        let neighbours = graph.neighbours.iter();
        Self {
            vertices: (0..graph.starts.len() as u32 - 1).collect(),
            neighbours: neighbours.map(|neighbour| neighbour.0).collect(),
            starts: graph.starts,
        }
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// The neighbours of one, ascending.
    pub fn neighbours_of(&self, vertex: usize) -> &[u32] {
        &self.neighbours[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// Whether one has a neighbour on a side.
    pub fn touches(&self, vertex: usize, side: Side, sides: &[Side]) -> bool {
        let mut neighbours = self.neighbours_of(vertex).iter();
        neighbours.any(|&other| sides[other as usize] == side)
    }

    /// The distance of every vertex from the seed of its component, the vertices ring by ring, and
    /// where in these each component ends. With a seed, of one component alone.
    pub fn rings(&self, seed: Option<u32>) -> (Vec<u32>, Vec<u32>, Vec<usize>) {
        let mut distances = vec![u32::MAX; self.len()];
        let mut order = Vec::with_capacity(self.len());
        let mut ends = Vec::new();
        let seeds = match seed {
            Some(seed) => seed..seed + 1,
            None => 0..self.len() as u32,
        };
        for seed in seeds {
            if distances[seed as usize] != u32::MAX {
                continue;
            }
            let mut next = order.len();
            distances[seed as usize] = 0;
            order.push(seed);
            while let Some(&vertex) = order.get(next) {
                next += 1;
                for &other in self.neighbours_of(vertex as usize) {
                    if distances[other as usize] == u32::MAX {
                        distances[other as usize] = distances[vertex as usize] + 1;
                        order.push(other);
                    }
                }
            }
            ends.push(order.len());
        }
        (distances, order, ends)
    }

    /// What of it is on one side.
    pub fn restricted_to(&self, side: Side, sides: &[Side]) -> Self {
        let mut places = vec![0; self.len()];
        let mut own = Vec::new();
        for vertex in (0..self.len()).filter(|&vertex| sides[vertex] == side) {
            places[vertex] = own.len() as u32;
            own.push(vertex);
        }
        let mut starts = Vec::with_capacity(own.len() + 1);
        let mut neighbours = Vec::new();
        starts.push(0);
        for &vertex in &own {
            let all = self.neighbours_of(vertex).iter();
            let kept = all.filter(|&&other| sides[other as usize] == side);
            neighbours.extend(kept.map(|&other| places[other as usize]));
            starts.push(neighbours.len() as u32);
        }
        Self {
            vertices: own.iter().map(|&vertex| self.vertices[vertex]).collect(),
            starts,
            neighbours,
        }
    }

    /// Orders by approximate minimum degree (Amestoy, Davis, Duff 1996).
    pub fn by_degree(&self, order: &mut [u32]) -> Result<()> {
        let size = self.len();
        let (mut places, mut inverse) = (vec![0_u32; size], vec![0_u32; size]);
        let pattern =
            SymbolicSparseColMatRef::new_checked(size, size, &self.starts, None, &self.neighbours);
        let request = amd::order_scratch::<u32>(size, self.neighbours.len());
        let mut memory = MemBuffer::try_new(request).map_err(|_| {
            let message = "the order of the mesh's matrix takes more memory than there is";
            Error::Memory(message.into())
        })?;
        let stack = MemStack::new(&mut memory);
        amd::order(
            &mut places,
            &mut inverse,
            pattern,
            amd::Control::default(),
            stack,
        )
        .map_err(|error| Error::Solver(format!("ordering failed: {error:?}")))?;
        for (place, &vertex) in order.iter_mut().zip(&places) {
            *place = self.vertices[vertex as usize];
        }
        Ok(())
    }
}
