//! Corners that are near one another.

use petgraph::unionfind::UnionFind;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::mesh::open_edges::{OpenEdge, open_edges};
use crate::mesh::weld::{Corner, Surface};

/// The most neighbours that a corner looks for at once. Where more are near, it finds the others
/// when these have become one with it.
const NEIGHBOURS: usize = 16;

/// Two corners that may become one, by their numbers.
struct Link {
    squared_length: f64,
    ends: [u32; 2],
}

/// What has become one so far.
#[derive(Clone, Copy)]
struct Cluster {
    lower: [f64; 3],
    upper: [f64; 3],
    /// The least of its corners'.
    reach: f64,
}

impl Cluster {
    fn with(&self, other: &Self) -> Self {
        let axes = |a: [f64; 3], b: [f64; 3], pick: fn(f64, f64) -> f64| {
            std::array::from_fn(|axis| pick(a[axis], b[axis]))
        };
        Self {
            lower: axes(self.lower, other.lower, f64::min),
            upper: axes(self.upper, other.upper, f64::max),
            reach: self.reach.min(other.reach),
        }
    }

    /// Whether it is, along every axis, no larger than its corners' reach. Corners within reach of
    /// one another always are; the ends of an edge, at three times the reach, never.
    fn is_compact(&self) -> bool {
        (0..3).all(|axis| self.upper[axis] - self.lower[axis] <= self.reach)
    }
}

/// Makes corners on open edges that are within reach of one another one, the nearest first; how
/// many went.
pub(super) fn join(surface: &mut Surface, border: &mut Vec<OpenEdge>, tolerance: f64) -> usize {
    let corners = surface.corners(border);
    let reaches = surface.reaches(&corners, tolerance);
    let links = links(&corners, &reaches);
    let mut joined = UnionFind::<u32>::new(corners.len());
    let cluster = |(corner, &reach): (&Corner, &f64)| Cluster {
        lower: corner.position,
        upper: corner.position,
        reach,
    };
    let mut clusters: Vec<_> = corners.iter().zip(&reaches).map(cluster).collect();
    for link in &links {
        let roots = link.ends.map(|end| joined.find_mut(end));
        let [a, b] = roots.map(|root| &clusters[root as usize]);
        let both = a.with(b);
        if roots[0] != roots[1] && both.is_compact() {
            joined.union(roots[0], roots[1]);
            clusters[joined.find_mut(roots[0]) as usize] = both;
        }
    }
    let mut members: Vec<_> = (0..corners.len() as u32)
        .map(|number| (joined.find_mut(number), number))
        .collect();
    // By their numbers, and so by place, within each.
    members.par_sort_unstable();
    let groups = members.chunk_by(|a, b| a.0 == b.0);
    let groups = groups.filter(|group| group.len() > 1);
    let groups: Vec<Vec<u32>> = groups
        .map(|group| group.iter().map(|&(_, n)| corners[n as usize].vertex))
        .map(Iterator::collect)
        .collect();
    for group in &groups {
        let (mean, weight) = mean(surface, group);
        let first = *group.iter().min().expect("groups have members") as usize;
        surface.vertices[first] = mean;
        surface.weights[first] = weight;
    }
    surface.join(&groups);
    let gone = groups.iter().map(|group| group.len() - 1).sum();
    if gone > 0 {
        *border = open_edges(surface.vertices.len(), &surface.triangles);
    }
    gone
}

/// Pairs of corners within reach of one another, the nearest first.
fn links(corners: &[Corner], reaches: &[f64]) -> Vec<Link> {
    let numbered = corners.iter().zip(0_u32..);
    let points = numbered.map(|(corner, number)| GeomWithData::new(corner.position, number));
    let tree = RTree::bulk_load(points.collect());
    let numbers = (0..corners.len()).into_par_iter();
    let mut links: Vec<_> = numbers
        .flat_map_iter(|number| {
            let reach = reaches[number];
            let near = tree.nearest_neighbor_iter_with_distance_2(&corners[number].position);
            let near = near
                .take_while(move |(_, squared)| *squared <= reach * reach)
                .filter(move |(other, _)| other.data as usize != number)
                .take(NEIGHBOURS);
            near.filter(|(other, squared)| {
                let theirs = reaches[other.data as usize];
                *squared <= theirs * theirs
            })
            .map(move |(other, squared_length)| {
                let (a, b) = (number as u32, other.data);
                Link {
                    squared_length,
                    ends: [a.min(b), a.max(b)],
                }
            })
        })
        .collect();
    links.par_sort_unstable_by(|a, b| {
        let lengths = a.squared_length.total_cmp(&b.squared_length);
        lengths.then(a.ends.cmp(&b.ends))
    });
    links.dedup_by(|a, b| a.ends == b.ends);
    links
}

/// The mean of a group in the order of their places, and of how many vertices it is the mean.
fn mean(surface: &Surface, group: &[u32]) -> ([f64; 3], f64) {
    let start = surface.vertices[group[0] as usize];
    let mut sum = [0.0; 3];
    let mut total = 0.0;
    for &member in group {
        let (position, weight) = (
            surface.vertices[member as usize],
            surface.weights[member as usize],
        );
        for axis in 0..3 {
            // Differences: far from the origin, sums would lose digits.
            sum[axis] += weight * (position[axis] - start[axis]);
        }
        total += weight;
    }
    let mean = std::array::from_fn(|axis| start[axis] + sum[axis] / total);
    (mean, total)
}
