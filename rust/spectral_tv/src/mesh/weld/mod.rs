//! Joining surfaces along open edges that lie on one another.
//!
//! Three steps are repeated until none of them finds anything: corners at the same place become
//! one, so do corners that are near one another, and edges are split at corners that lie on them.
//! None depends on the order of vertices or triangles: what it treats is ordered by place.

mod coincident;
mod junctions;
mod near;

use crate::error::{Error, Result};
use crate::mesh::open_edges::{OpenEdge, edges_of, open_edges, vertices_of};

/// The share of a corner's shortest edge, or of the height of a triangle, that it may be off and
/// still be joined: less than what would let an edge collapse (1/√3, as [`near`] measures), or a
/// triangle turn over.
const REACH: f64 = 1.0 / 3.0;

/// Refuses tolerances that are no lengths.
pub(super) fn check_tolerance(tolerance: f64) -> Result<()> {
    match tolerance >= 0.0 && tolerance.is_finite() {
        true => Ok(()),
        false => Err(Error::Argument(format!(
            "weld must be a length of 0 or more, not {tolerance}"
        ))),
    }
}

/// A surface that is being joined.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    /// V positions; that of a corner that was joined to another is not used any more.
    pub vertices: Vec<[f64; 3]>,
    /// F or more triangles between corners that are left.
    pub triangles: Vec<[u32; 3]>,
    /// Of every vertex, the one that it is now: the first of those joined.
    pub place: Vec<u32>,
    /// Of how many vertices each is the mean.
    weights: Vec<f64>,
    /// Vertices that were on open edges at the start.
    pub border_vertices: usize,
    /// Open edges at the start.
    pub open_edges: usize,
    /// How many edges were split, each corner on each edge counted.
    pub junctions: usize,
}

impl Surface {
    /// Joins what is within `tolerance` along open edges; with 0 at exactly the same place alone.
    pub fn welded(vertices: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>, tolerance: f64) -> Self {
        let border = open_edges(vertices.len(), &triangles);
        let mut surface = Self {
            place: (0..vertices.len() as u32).collect(),
            weights: vec![1.0; vertices.len()],
            vertices,
            triangles,
            border_vertices: vertices_of(&border).len(),
            open_edges: border.len(),
            junctions: 0,
        };
        let mut border = border;
        loop {
            let joined = coincident::join(&mut surface, &mut border);
            if tolerance == 0.0 {
                break;
            }
            let near = near::join(&mut surface, &mut border, tolerance);
            let split = junctions::close(&mut surface, &mut border, tolerance);
            surface.junctions += split;
            if joined + near + split == 0 {
                break;
            }
        }
        surface
    }

    /// The corners at `border`, ordered by place.
    fn corners(&self, border: &[OpenEdge]) -> Vec<Corner> {
        let corner = |vertex: u32| Corner {
            vertex,
            // −0 and 0 are the same place.
            position: self.vertices[vertex as usize].map(|x| x + 0.0),
        };
        let mut corners: Vec<_> = vertices_of(border).into_iter().map(corner).collect();
        rayon::slice::ParallelSliceMut::par_sort_unstable_by(&mut corners[..], |a, b| {
            let places = a.position.iter().zip(&b.position);
            let order = places.map(|(a, b)| a.total_cmp(b));
            order
                .fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
                .then(a.vertex.cmp(&b.vertex))
        });
        corners
    }

    /// How far each of `corners` may be off: `tolerance`, or less at short edges.
    fn reaches(&self, corners: &[Corner], tolerance: f64) -> Vec<f64> {
        let mut numbers = vec![u32::MAX; self.vertices.len()];
        for (number, corner) in corners.iter().enumerate() {
            numbers[corner.vertex as usize] = number as u32;
        }
        let mut reaches = vec![tolerance; corners.len()];
        for &triangle in &self.triangles {
            for (ends, _) in edges_of(triangle) {
                let numbers = ends.map(|end| numbers[end as usize] as usize);
                if numbers.iter().all(|&number| number >= reaches.len()) {
                    continue;
                }
                let [a, b] = ends.map(|end| self.vertices[end as usize]);
                let length = squared_distance(a, b).sqrt();
                for reach in numbers {
                    if let Some(reach) = reaches.get_mut(reach) {
                        *reach = reach.min(REACH * length);
                    }
                }
            }
        }
        reaches
    }

    /// Makes the `members` of each group one, the first of them.
    fn join(&mut self, groups: &[Vec<u32>]) {
        if groups.is_empty() {
            return;
        }
        let mut next: Vec<u32> = (0..self.vertices.len() as u32).collect();
        for members in groups {
            let first = *members.iter().min().expect("groups have members");
            for &member in members {
                next[member as usize] = first;
            }
        }
        let follow = |vertex: &mut u32| *vertex = next[*vertex as usize];
        self.place.iter_mut().for_each(follow);
        self.triangles.iter_mut().flatten().for_each(follow);
    }
}

/// A vertex on an open edge.
#[derive(Debug, Clone, Copy)]
struct Corner {
    vertex: u32,
    position: [f64; 3],
}

fn squared_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum()
}
