//! A coarse mesh whose vertices are some of a fine one's.
//!
//! Own code, as the libraries at hand want manifolds, or place vertices anew: the coarse state is
//! read from the fine one, and the borders of handles stay where they are.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Vector3;

use crate::error::Result;
use crate::monitor::Stage;
use crate::posing::quadric::Quadric;

/// How much evenness counts beside the shape.
const EVENNESS: f64 = 0.05;
/// The least cosine between a triangle's normals before and after.
const LEAST_COSINE: f64 = 0.3;
/// The least quality of a triangle that becomes worse: 1 for an equilateral one.
const LEAST_QUALITY: f64 = 0.05;

/// The result.
pub(super) struct Decimated {
    /// The fine vertex that each coarse one is.
    pub vertices: Vec<u32>,
    /// Of coarse vertices.
    pub triangles: Vec<[u32; 3]>,
    /// The coarse vertex that each fine one went into; `None` where it is in no triangle.
    pub representatives: Vec<Option<u32>>,
}

/// Collapses edges until `target` vertices are left, or none can be. `labels` tell regions apart:
/// an edge between two of them stays on their border, and none goes into another.
pub(super) fn decimate(
    positions: &[Vector3<f64>],
    triangles: &[[u32; 3]],
    labels: &[u32],
    target: usize,
    stage: Stage,
) -> Result<Decimated> {
    let mut work = Work::new(positions, triangles, labels);
    let mut queue = BinaryHeap::new();
    for vertex in 0..positions.len() {
        if vertex.is_multiple_of(4096) {
            stage.check()?;
        }
        work.enqueue(vertex as u32, &mut queue);
    }
    let mut steps = 0_usize;
    while work.alive > target {
        let Some(Collapse { from, to, age, .. }) = queue.pop() else {
            break;
        };
        steps += 1;
        if steps.is_multiple_of(4096) {
            stage.check()?;
        }
        if work.ages[from as usize] != age {
            continue;
        }
        if !work.is_allowed(from, to) {
            work.refused[from as usize].push(to);
            work.enqueue(from, &mut queue);
            continue;
        }
        let changed = work.collapse(from, to);
        for vertex in changed {
            work.enqueue(vertex, &mut queue);
        }
    }
    Ok(work.finish())
}

/// A vertex that goes into another.
struct Collapse {
    cost: f64,
    from: u32,
    to: u32,
    /// That of the vertex when this was found.
    age: u32,
}

impl PartialEq for Collapse {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Collapse {}
impl PartialOrd for Collapse {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Collapse {
    /// The cheapest is the largest; ties go by number, so that the result is always the same.
    fn cmp(&self, other: &Self) -> Ordering {
        let cost = other.cost.total_cmp(&self.cost);
        cost.then(other.from.cmp(&self.from))
            .then(other.to.cmp(&self.to))
    }
}

struct Work<'a> {
    positions: &'a [Vector3<f64>],
    labels: &'a [u32],
    triangles: Vec<[u32; 3]>,
    is_gone: Vec<bool>,
    around: Vec<Vec<u32>>,
    quadrics: Vec<Quadric>,
    masses: Vec<f64>,
    ages: Vec<u32>,
    went_to: Vec<u32>,
    alive: usize,
    /// Where each vertex was refused to go since it last changed.
    refused: Vec<Vec<u32>>,
}

impl<'a> Work<'a> {
    fn new(positions: &'a [Vector3<f64>], triangles: &[[u32; 3]], labels: &'a [u32]) -> Self {
        let count = positions.len();
        let mut around = vec![Vec::new(); count];
        let mut quadrics = vec![Quadric::zero(); count];
        let mut masses = vec![0.0; count];
        for (face, corners) in triangles.iter().enumerate() {
            let points = corners.map(|corner| positions[corner as usize]);
            let quadric = Quadric::of_triangle(points);
            let area = 0.5
                * (points[1] - points[0])
                    .cross(&(points[2] - points[0]))
                    .norm();
            for &corner in corners {
                around[corner as usize].push(face as u32);
                quadrics[corner as usize].add(&quadric);
                masses[corner as usize] += area / 3.0;
            }
        }
        Self {
            positions,
            labels,
            triangles: triangles.to_vec(),
            is_gone: vec![false; triangles.len()],
            alive: around.iter().filter(|faces| !faces.is_empty()).count(),
            around,
            quadrics,
            masses,
            ages: vec![0; count],
            went_to: (0..count as u32).collect(),
            refused: vec![Vec::new(); count],
        }
    }

    /// The other corners of the faces around a vertex, each with the number of faces at the edge.
    fn neighbours(&self, vertex: u32) -> Vec<(u32, u32)> {
        let mut found: Vec<(u32, u32)> = Vec::with_capacity(12);
        for &face in &self.around[vertex as usize] {
            for corner in self.triangles[face as usize] {
                if corner != vertex {
                    match found.iter_mut().find(|(other, _)| *other == corner) {
                        Some((_, count)) => *count += 1,
                        None => found.push((corner, 1)),
                    }
                }
            }
        }
        found
    }

    /// Whether a vertex is next to one of another region.
    fn is_on_border(&self, vertex: u32) -> bool {
        let label = self.labels[vertex as usize];
        let faces = self.around[vertex as usize].iter();
        faces
            .flat_map(|&face| self.triangles[face as usize])
            .any(|corner| self.labels[corner as usize] != label)
    }

    /// Puts the cheapest collapse of a vertex into the queue.
    fn enqueue(&mut self, vertex: u32, queue: &mut BinaryHeap<Collapse>) {
        let neighbours = self.neighbours(vertex);
        let label = self.labels[vertex as usize];
        let is_open = neighbours.iter().any(|&(_, count)| count != 2);
        let is_on_border = label != 0 && self.is_on_border(vertex);
        let mut best: Option<Collapse> = None;
        for &(other, count) in &neighbours {
            if self.labels[other as usize] != label
                || (is_open && count == 2)
                || (is_on_border && !self.is_on_border(other))
                || self.refused[vertex as usize].contains(&other)
            {
                continue;
            }
            let at = self.positions[other as usize];
            let apart = (at - self.positions[vertex as usize]).norm_squared();
            let cost = self.quadrics[vertex as usize].at(&at)
                + EVENNESS * self.masses[vertex as usize] * apart;
            let collapse = Collapse {
                cost,
                from: vertex,
                to: other,
                age: self.ages[vertex as usize],
            };
            if best.as_ref().is_none_or(|best| collapse > *best) {
                best = Some(collapse);
            }
        }
        queue.extend(best);
    }

    /// Whether a collapse leaves a surface of the same kind, and turns no face over.
    fn is_allowed(&self, from: u32, to: u32) -> bool {
        let (own, others) = (self.neighbours(from), self.neighbours(to));
        let common = own
            .iter()
            .filter(|(vertex, _)| others.iter().any(|(other, _)| other == vertex));
        let shared = own.iter().find(|(vertex, _)| *vertex == to);
        let Some(&(_, shared)) = shared else {
            return false;
        };
        if common.count() != shared as usize || own.len() < 3 {
            return false;
        }
        for &face in &self.around[from as usize] {
            let corners = self.triangles[face as usize];
            if corners.contains(&to) {
                continue;
            }
            let before = corners.map(|corner| self.positions[corner as usize]);
            let after = corners
                .map(|corner| self.positions[if corner == from { to } else { corner } as usize]);
            let ((old, old_quality), (new, quality)) = (shape(before), shape(after));
            if old.dot(&new) < LEAST_COSINE * old.norm() * new.norm()
                || (quality < LEAST_QUALITY && quality < old_quality)
            {
                return false;
            }
        }
        true
    }

    /// Does it, and tells whose neighbours changed.
    fn collapse(&mut self, from: u32, to: u32) -> Vec<u32> {
        let faces = std::mem::take(&mut self.around[from as usize]);
        for face in faces {
            let corners = self.triangles[face as usize];
            if corners.contains(&to) {
                self.is_gone[face as usize] = true;
                for corner in corners.into_iter().filter(|&corner| corner != from) {
                    self.around[corner as usize].retain(|&other| other != face);
                }
            } else {
                let corners = &mut self.triangles[face as usize];
                for corner in corners.iter_mut().filter(|corner| **corner == from) {
                    *corner = to;
                }
                self.around[to as usize].push(face);
            }
        }
        let quadric = self.quadrics[from as usize];
        self.quadrics[to as usize].add(&quadric);
        self.masses[to as usize] += self.masses[from as usize];
        self.went_to[from as usize] = to;
        self.alive -= 1;
        let mut changed = vec![to];
        changed.extend(self.neighbours(to).iter().map(|&(vertex, _)| vertex));
        for &vertex in &changed {
            self.ages[vertex as usize] += 1;
            self.refused[vertex as usize].clear();
        }
        self.ages[from as usize] += 1;
        changed
    }

    fn finish(self) -> Decimated {
        let mut numbers = vec![None; self.positions.len()];
        let mut vertices = Vec::new();
        for (vertex, faces) in self.around.iter().enumerate() {
            if !faces.is_empty() {
                numbers[vertex] = Some(vertices.len() as u32);
                vertices.push(vertex as u32);
            }
        }
        let kept = self.triangles.iter().zip(&self.is_gone);
        let renumbered = |corners: &[u32; 3]| {
            corners.map(|corner| numbers[corner as usize].expect("corners of kept faces are kept"))
        };
        let triangles = kept
            .filter(|(_, is_gone)| !**is_gone)
            .map(|(corners, _)| renumbered(corners))
            .collect();
        let representatives = (0..self.positions.len()).map(|vertex| {
            let mut vertex = vertex;
            while self.went_to[vertex] as usize != vertex {
                vertex = self.went_to[vertex] as usize;
            }
            numbers[vertex]
        });
        Decimated {
            representatives: representatives.collect(),
            vertices,
            triangles,
        }
    }
}

/// The normal, as long as twice the area, and the quality of a triangle.
fn shape([p, q, r]: [Vector3<f64>; 3]) -> (Vector3<f64>, f64) {
    let normal = (q - p).cross(&(r - p));
    let edges = (q - p).norm_squared() + (r - q).norm_squared() + (p - r).norm_squared();
    let quality = match edges > 0.0 {
        true => 2.0 * 3.0_f64.sqrt() * normal.norm() / edges,
        false => 0.0,
    };
    (normal, quality)
}
