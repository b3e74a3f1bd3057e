//! T-junctions: corners that lie on an edge.

use petgraph::unionfind::UnionFind;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};

use crate::mesh::open_edges::OpenEdge;
use crate::mesh::weld::surface::{Corner, REACH, Surface, around, distance, squared_distance};

/// The most edges that a corner splits at once, the nearest to it.
const EDGES: usize = 16;

/// A corner on an edge.
#[derive(Clone, Copy)]
struct Junction {
    /// Number of the edge.
    edge: usize,
    /// Where on the edge, from 0 at its first end to 1 at the other.
    at: f64,
    /// Number of the corner.
    corner: u32,
    /// How far the corner is from it.
    distance: f64,
}

/// A part of an open edge, or all of it: its ends, the lower vertex first, and the edge.
type Piece = ([u32; 2], usize);

/// Splits open edges at the corners of other open edges that are on them, within reach, where
/// that closes some of their pieces; whether there were any.
pub(super) fn close(surface: &mut Surface, tolerance: f64) -> bool {
    let corners = surface.corners();
    let edges = Edges::new(surface, &corners);
    let junctions = edges.junctions(surface, &corners, tolerance);
    let junctions = edges.useful(junctions, &corners);
    if junctions.is_empty() {
        return false;
    }
    let parts = edges.parts(surface, &junctions, &corners);
    let gap = junctions.iter().fold(0.0_f64, |max, j| max.max(j.distance));
    surface.split(parts.into_iter(), junctions.len(), gap);
    true
}

/// The open edges, ordered by place and directed.
struct Edges {
    edges: Vec<OpenEdge>,
    /// Numbers of the corners they lead from and to.
    ends: Vec<[u32; 2]>,
}

impl Edges {
    fn new(surface: &Surface, corners: &[Corner]) -> Self {
        let numbers = surface.numbers(corners);
        let ends = |edge: &OpenEdge| {
            let [a, b] = edge.ends.map(|end| numbers[end as usize]);
            [a.min(b), a.max(b)]
        };
        let edges = surface.border().iter().map(|edge| (ends(edge), *edge));
        let mut edges: Vec<_> = edges.collect();
        edges.par_sort_unstable();
        let (ends, edges) = edges.into_iter().unzip();
        Self { edges, ends }
    }

    /// All corners on edges, by edge and along it.
    fn junctions(&self, surface: &Surface, corners: &[Corner], tolerance: f64) -> Vec<Junction> {
        let reaches = surface.reaches(corners, tolerance);
        let lines = self.ends.iter().enumerate().map(|(edge, &[a, b])| {
            let [from, to] = [a, b].map(|end| corners[end as usize].position);
            GeomWithData::new(Line::new(from, to), edge)
        });
        let tree = RTree::bulk_load(lines.collect());
        let numbers = (0..corners.len()).into_par_iter();
        let mut junctions: Vec<_> = numbers
            .flat_map_iter(|number| self.splits(surface, &tree, corners, number, reaches[number]))
            .collect();
        junctions.par_sort_unstable_by(|a, b| {
            let along = a.at.total_cmp(&b.at);
            a.edge
                .cmp(&b.edge)
                .then(along)
                .then(a.corner.cmp(&b.corner))
        });
        junctions
    }

    /// The edges of `tree` that the corner of this number splits, within its reach: of every
    /// triangle at most the nearest, as the corner can be at one place only.
    fn splits(
        &self,
        surface: &Surface,
        tree: &RTree<GeomWithData<Line<[f64; 3]>, usize>>,
        corners: &[Corner],
        number: usize,
        reach: f64,
    ) -> Vec<Junction> {
        let Corner { vertex, position } = corners[number];
        let near = tree.locate_in_envelope_intersecting(&around(position, reach));
        let near = near.filter_map(|line| {
            let (geometry, edge) = (line.geom(), self.edges[line.data]);
            let triangle = surface.triangles()[edge.triangle];
            let at = along(geometry, position);
            if triangle.contains(&vertex) || !(at > 0.0 && at < 1.0) {
                return None;
            }
            let apex = surface.vertices()[triangle[edge.apex] as usize];
            let [from, to] = [geometry.from, geometry.to];
            let length = distance(from, to);
            let size = length.min(line_distance(geometry, apex));
            let away = line_distance(geometry, position);
            // Edges get shorter when they are split.
            let is_between = distance(from, position).max(distance(position, to)) < length;
            let is_on = is_between && away <= reach.min(REACH * size);
            is_on.then_some(Junction {
                edge: line.data,
                at,
                corner: number as u32,
                distance: away,
            })
        });
        let mut near: Vec<_> = near.collect();
        near.sort_unstable_by(|a, b| {
            let distances = a.distance.total_cmp(&b.distance);
            distances.then(a.edge.cmp(&b.edge))
        });
        let mut found: Vec<Junction> = Vec::new();
        for junction in near {
            let triangle = |junction: &Junction| self.edges[junction.edge].triangle;
            let is_split = |other: &Junction| triangle(other) == triangle(&junction);
            if found.len() < EDGES && !found.iter().any(is_split) {
                found.push(junction);
            }
        }
        found
    }

    /// Those of `junctions` at the end of a piece that two edges or more then have in common.
    ///
    /// Edges with common pieces are left as they are if splitting all of them would leave more
    /// open edges than before: they merely cross.
    fn useful(&self, mut junctions: Vec<Junction>, corners: &[Corner]) -> Vec<Junction> {
        if junctions.is_empty() {
            return junctions;
        }
        let (_, is_common) = self.pieces(&junctions, corners);
        // Edge k with j junctions has the pieces from k and the junctions before it on.
        let before = |place: usize, edge: usize| place + edge;
        let mut place = 0;
        junctions.retain(|junction| {
            let piece = before(place, junction.edge);
            place += 1;
            is_common[piece] || is_common[piece + 1]
        });
        let (pieces, is_common) = self.pieces(&junctions, corners);
        let mut groups = UnionFind::<usize>::new(self.edges.len());
        let mut common: Vec<Piece> = pieces
            .iter()
            .zip(&is_common)
            .filter_map(|(&piece, &is_common)| is_common.then_some(piece))
            .collect();
        common.sort_unstable();
        for pair in common.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            groups.union(pair[0].1, pair[1].1);
        }
        let mut more_open = vec![0_isize; self.edges.len()];
        for junction in &junctions {
            more_open[groups.find_mut(junction.edge)] += 1;
        }
        for (_, edge) in &common {
            more_open[groups.find_mut(*edge)] -= 1;
        }
        junctions.retain(|junction| more_open[groups.find_mut(junction.edge)] <= 0);
        junctions
    }

    /// The pieces of all edges, edge by edge and along each, and whether several edges have it.
    fn pieces(&self, junctions: &[Junction], corners: &[Corner]) -> (Vec<Piece>, Vec<bool>) {
        let mut rest = junctions;
        let mut pieces: Vec<Piece> = Vec::with_capacity(self.edges.len() + junctions.len());
        for (edge, &[from, to]) in self.ends.iter().enumerate() {
            let count = rest.partition_point(|junction| junction.edge == edge);
            let (own, others) = rest.split_at(count);
            rest = others;
            let mut start = from;
            for end in own.iter().map(|junction| junction.corner).chain([to]) {
                let [a, b] = [start, end].map(|number| corners[number as usize].vertex);
                pieces.push(([a.min(b), a.max(b)], edge));
                start = end;
            }
        }
        let mut order: Vec<usize> = (0..pieces.len()).collect();
        order.par_sort_unstable_by_key(|&piece| pieces[piece]);
        let mut is_common = vec![false; pieces.len()];
        for same in order.chunk_by(|&a, &b| pieces[a].0 == pieces[b].0) {
            same.iter().for_each(|&p| is_common[p] = same.len() > 1);
        }
        (pieces, is_common)
    }

    /// The triangles that `junctions`, by edge and along it, split, and their parts.
    fn parts(
        &self,
        surface: &Surface,
        junctions: &[Junction],
        corners: &[Corner],
    ) -> Vec<(usize, Vec<[u32; 3]>)> {
        let triangle_of = |on_edge: &&[Junction]| self.edges[on_edge[0].edge].triangle;
        let mut by_edge: Vec<_> = junctions.chunk_by(|a, b| a.edge == b.edge).collect();
        by_edge.sort_by_key(triangle_of);
        let by_triangle = by_edge.chunk_by(|a, b| triangle_of(a) == triangle_of(b));
        by_triangle
            .map(|on_triangle| {
                let triangle = triangle_of(&on_triangle[0]);
                let mut parts = vec![surface.triangles()[triangle]];
                for on_edge in on_triangle {
                    let [from, to] = self.ends[on_edge[0].edge];
                    let inner = on_edge.iter().map(|junction| junction.corner);
                    let chain = [from].into_iter().chain(inner).chain([to]);
                    let chain: Vec<_> = chain.map(|n| corners[n as usize].vertex).collect();
                    split_part(&mut parts, &chain);
                }
                (triangle, parts)
            })
            .collect()
    }
}

/// Replaces the part that has the edge from the first to the last of `chain` by a fan over it.
fn split_part(parts: &mut Vec<[u32; 3]>, chain: &[u32]) {
    let (from, to) = (chain[0], chain[chain.len() - 1]);
    let has_both = |part: &[u32; 3]| part.contains(&from) && part.contains(&to);
    let Some(place) = parts.iter().position(has_both) else {
        return;
    };
    let part = parts.swap_remove(place);
    let with =
        |replaced: u32, by: u32| part.map(|corner| if corner == replaced { by } else { corner });
    // The part with its corner `to` at the end of the piece, and `from` at its start.
    let fan = chain.windows(2).map(|piece| {
        let moved = with(to, piece[1]);
        moved.map(|corner| if corner == from { piece[0] } else { corner })
    });
    parts.extend(fan);
}

/// Where on the line the nearest point of the endless one is, from 0 to 1 between its ends.
fn along(line: &Line<[f64; 3]>, point: [f64; 3]) -> f64 {
    let direction: [f64; 3] = std::array::from_fn(|axis| line.to[axis] - line.from[axis]);
    let way: f64 = (0..3)
        .map(|axis| (point[axis] - line.from[axis]) * direction[axis])
        .sum();
    way / squared_distance(line.from, line.to)
}

/// The distance of a point from the endless line.
fn line_distance(line: &Line<[f64; 3]>, point: [f64; 3]) -> f64 {
    let at = along(line, point);
    let foot = std::array::from_fn(|axis| line.from[axis] + at * (line.to[axis] - line.from[axis]));
    distance(foot, point)
}
