//! A surface that is being joined.

use std::cmp::Ordering;

use rayon::slice::ParallelSliceMut;
use rstar::AABB;

use crate::mesh::intrinsic::repeats_an_index;
use crate::mesh::open_edges::{OpenEdge, edges_of, open_edges, vertices_of};

/// The share of a corner's shortest edge, or of the height of a triangle, that a corner may be off
/// and still be joined. The ends of an edge then never become one, nor meet: each moves by less than
/// √3 times as much, as clusters are measured along the axes.
pub(super) const REACH: f64 = 0.25;

/// Vertices and triangles, the first vertices of which can be joined.
#[derive(Debug, Clone)]
pub(in crate::mesh) struct Surface {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    place: Vec<u32>,
    /// Of how many vertices each is the mean.
    weights: Vec<f64>,
    joinable: usize,
    border: Vec<OpenEdge>,
    /// The triangles of the open edges at the start, once for each.
    bordering: Vec<usize>,
    junctions: usize,
    widest_gap: f64,
}

/// A vertex on an open edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub vertex: u32,
    pub position: [f64; 3],
}

impl Surface {
    /// A surface whose first `joinable` vertices can be joined; the others, and the edges at them,
    /// stay as they are.
    pub fn new(vertices: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>, joinable: usize) -> Self {
        let mut surface = Self {
            place: (0..vertices.len() as u32).collect(),
            weights: vec![1.0; vertices.len()],
            vertices,
            triangles,
            joinable,
            border: Vec::new(),
            bordering: Vec::new(),
            junctions: 0,
            widest_gap: 0.0,
        };
        surface.find_border();
        surface.bordering = surface.border.iter().map(|edge| edge.triangle).collect();
        surface
    }

    /// Positions of all vertices; those of vertices that were joined to another are not used.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// The triangles in their order, then the parts of those that were split.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Of every vertex, the one that it is now: the first of those joined.
    pub fn place(&self) -> &[u32] {
        &self.place
    }

    /// The open edges between vertices that can be joined.
    pub fn border(&self) -> &[OpenEdge] {
        &self.border
    }

    /// How many open edges there were at the start.
    pub fn border_length(&self) -> usize {
        self.bordering.len()
    }

    /// How many fewer open edges there are than at the start, without those of triangles that have
    /// vanished, as two of their corners were at one place.
    pub fn closed_edges(&self) -> usize {
        let is_left = |triangle: &&usize| !repeats_an_index(&self.triangles[**triangle]);
        let left = self.bordering.iter().filter(is_left).count();
        left.saturating_sub(self.border.len())
    }

    /// How many corners split an edge, each edge counted.
    pub fn junctions(&self) -> usize {
        self.junctions
    }

    /// The longest way that was bridged.
    pub fn widest_gap(&self) -> f64 {
        self.widest_gap
    }

    /// How many vertices were joined to another.
    pub fn joined_count(&self) -> usize {
        let mut members = vec![0_u32; self.place.len()];
        for &place in &self.place {
            members[place as usize] += 1;
        }
        let joined = self.place.iter();
        joined.filter(|&&place| members[place as usize] > 1).count()
    }

    /// The corners at open edges, ordered by place.
    pub(super) fn corners(&self) -> Vec<Corner> {
        let corner = |vertex: u32| Corner {
            vertex,
            // −0 and 0 are the same place.
            position: self.vertices[vertex as usize].map(|x| x + 0.0),
        };
        let mut corners: Vec<_> = vertices_of(&self.border).into_iter().map(corner).collect();
        corners.par_sort_unstable_by(|a, b| {
            let axes = a.position.iter().zip(&b.position);
            let orders = axes.map(|(a, b)| a.total_cmp(b));
            let order = orders.fold(Ordering::Equal, Ordering::then);
            order.then(a.vertex.cmp(&b.vertex))
        });
        corners
    }

    /// The place of every vertex in `corners`, `u32::MAX` where it is none.
    pub(super) fn numbers(&self, corners: &[Corner]) -> Vec<u32> {
        let mut numbers = vec![u32::MAX; self.vertices.len()];
        for (corner, number) in corners.iter().zip(0..) {
            numbers[corner.vertex as usize] = number;
        }
        numbers
    }

    /// How far each of `corners` may be off: `tolerance`, or less at short edges.
    pub(super) fn reaches(&self, corners: &[Corner], tolerance: f64) -> Vec<f64> {
        let numbers = self.numbers(corners);
        let mut reaches = vec![tolerance; corners.len()];
        for &triangle in &self.triangles {
            for (ends, _) in edges_of(triangle) {
                let own = ends.map(|end| numbers[end as usize]);
                if own == [u32::MAX; 2] {
                    continue;
                }
                let [a, b] = ends.map(|end| self.vertices[end as usize]);
                let length = distance(a, b);
                // An edge without length cannot get shorter.
                if length > 0.0 {
                    for reach in own {
                        if let Some(reach) = reaches.get_mut(reach as usize) {
                            *reach = reach.min(REACH * length);
                        }
                    }
                }
            }
        }
        reaches
    }

    /// The mean of the `members` of a group in their order, and of how many vertices it is that.
    pub(super) fn mean(&self, members: &[u32]) -> ([f64; 3], f64) {
        let start = self.vertices[members[0] as usize];
        let mut sum = [0.0; 3];
        let mut total = 0.0;
        for &member in members {
            let position = self.vertices[member as usize];
            let weight = self.weights[member as usize];
            // Of differences: far from the origin, sums would lose digits.
            for axis in 0..3 {
                sum[axis] += weight * (position[axis] - start[axis]);
            }
            total += weight;
        }
        let mean = std::array::from_fn(|axis| start[axis] + sum[axis] / total);
        (mean, total)
    }

    /// Makes the members of each of `groups` one, the first of them, at their mean; with
    /// `same_place` where it was. `gap`: the longest way between members.
    pub(super) fn join(&mut self, groups: &[Vec<u32>], same_place: bool, gap: f64) {
        if groups.is_empty() {
            return;
        }
        self.widest_gap = self.widest_gap.max(gap);
        let mut next: Vec<u32> = (0..self.vertices.len() as u32).collect();
        for members in groups {
            let first = *members.iter().min().expect("groups have members");
            let (mean, weight) = self.mean(members);
            self.weights[first as usize] = weight;
            if !same_place {
                self.vertices[first as usize] = mean;
            }
            for &member in members {
                next[member as usize] = first;
            }
        }
        let follow = |vertex: &mut u32| *vertex = next[*vertex as usize];
        self.place.iter_mut().for_each(follow);
        self.triangles.iter_mut().flatten().for_each(follow);
        self.find_border();
    }

    /// Replaces triangles by their parts, the first of which takes its place. Each of the `count`
    /// corners on an edge is within `gap` of it.
    pub(super) fn split(
        &mut self,
        triangles: impl Iterator<Item = (usize, Vec<[u32; 3]>)>,
        count: usize,
        gap: f64,
    ) {
        for (triangle, parts) in triangles {
            self.triangles[triangle] = parts[0];
            self.triangles.extend(&parts[1..]);
        }
        self.junctions += count;
        self.widest_gap = self.widest_gap.max(gap);
        self.find_border();
    }

    fn find_border(&mut self) {
        self.border = open_edges(self.vertices.len(), &self.triangles);
        let joinable = self.joinable;
        self.border
            .retain(|edge| (edge.ends[1] as usize) < joinable);
    }
}

/// The box of all that is within `reach` of a position.
pub(super) fn around(position: [f64; 3], reach: f64) -> AABB<[f64; 3]> {
    AABB::from_corners(position.map(|x| x - reach), position.map(|x| x + reach))
}

pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    squared_distance(a, b).sqrt()
}

pub(super) fn squared_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum()
}
