//! Corners that lie on an edge: junctions in the form of a T.

use petgraph::unionfind::UnionFind;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};

use crate::mesh::open_edges::{OpenEdge, open_edges};
use crate::mesh::weld::{Corner, REACH, Surface, squared_distance};

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
}

/// A part of an open edge, or all of it: its ends, the lower vertex first, and the edge.
type Piece = ([u32; 2], usize);

/// Splits open edges at the corners of other open edges that are on them, within reach, where
/// that closes some of their pieces. Returns how many corners on edges these are.
pub(super) fn close(surface: &mut Surface, border: &mut Vec<OpenEdge>, tolerance: f64) -> usize {
    let corners = surface.corners(border);
    let edges = Edges::new(surface, border, &corners);
    let junctions = edges.junctions(surface, &corners, tolerance);
    let junctions = edges.useful(junctions, &corners);
    if junctions.is_empty() {
        return 0;
    }
    split(surface, &edges, &junctions, &corners);
    *border = open_edges(surface.vertices.len(), &surface.triangles);
    junctions.len()
}

/// The open edges, ordered by place and directed.
struct Edges {
    edges: Vec<OpenEdge>,
    /// Numbers of the corners they lead from and to.
    ends: Vec<[u32; 2]>,
}

impl Edges {
    fn new(surface: &Surface, border: &[OpenEdge], corners: &[Corner]) -> Self {
        let mut numbers = vec![0; surface.vertices.len()];
        for (number, corner) in corners.iter().enumerate() {
            numbers[corner.vertex as usize] = number as u32;
        }
        let ends = |edge: &OpenEdge| {
            let [a, b] = edge.ends.map(|end| numbers[end as usize]);
            [a.min(b), a.max(b)]
        };
        let mut edges: Vec<_> = border.iter().map(|edge| (ends(edge), *edge)).collect();
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
            .flat_map_iter(|number| {
                let Corner { vertex, position } = corners[number];
                let reach = reaches[number];
                let near = tree.nearest_neighbor_iter_with_distance_2(&position);
                near.take_while(move |(_, squared)| *squared <= reach * reach)
                    .filter_map(move |(line, squared)| {
                        let edge = self.edges[line.data];
                        let triangle = surface.triangles[edge.triangle];
                        if triangle.contains(&vertex) {
                            return None;
                        }
                        let apex = surface.vertices[triangle[edge.apex] as usize];
                        let height = line_distance_2(line.geom(), apex).sqrt();
                        let at = along(line.geom(), position);
                        let is_inside = at > 0.0 && at < 1.0;
                        let is_on = is_inside && squared.sqrt() <= REACH * height;
                        is_on.then_some(Junction {
                            edge: line.data,
                            at,
                            corner: number as u32,
                        })
                    })
                    .take(EDGES)
            })
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
}

/// Splits the triangles at `junctions`, by edge and along it; their parts fill the places of the
/// triangles, and then are added.
fn split(surface: &mut Surface, edges: &Edges, junctions: &[Junction], corners: &[Corner]) {
    let mut by_triangle: Vec<_> = junctions.chunk_by(|a, b| a.edge == b.edge).collect();
    by_triangle.sort_by_key(|on_edge| edges.edges[on_edge[0].edge].triangle);
    let triangle_of = |on_edge: &&[Junction]| edges.edges[on_edge[0].edge].triangle;
    for on_triangle in by_triangle.chunk_by(|a, b| triangle_of(a) == triangle_of(b)) {
        let triangle = triangle_of(&on_triangle[0]);
        let mut parts = vec![surface.triangles[triangle]];
        for on_edge in on_triangle {
            let [from, to] = edges.ends[on_edge[0].edge].map(|n| corners[n as usize].vertex);
            let inner = on_edge.iter().map(|j| corners[j.corner as usize].vertex);
            let chain: Vec<u32> = [from].into_iter().chain(inner).chain([to]).collect();
            split_part(&mut parts, &chain);
        }
        surface.triangles[triangle] = parts[0];
        surface.triangles.extend(&parts[1..]);
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

/// The squared distance of a point from the endless line.
fn line_distance_2(line: &Line<[f64; 3]>, point: [f64; 3]) -> f64 {
    let at = along(line, point);
    let foot = std::array::from_fn(|axis| line.from[axis] + at * (line.to[axis] - line.from[axis]));
    squared_distance(foot, point)
}
