//! Corners that are near one another.

use petgraph::unionfind::UnionFind;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::mesh::weld::surface::{Corner, Surface, around, distance};

/// The most neighbours that a corner looks for at once. Where more are near, it finds the others
/// when these have become one with it.
const NEIGHBOURS: usize = 16;

/// From so many points on, a search for the nearest is faster than one for all.
const MANY: usize = 64;

type Tree = RTree<GeomWithData<[f64; 3], u32>>;

/// Two corners that may become one, by their numbers.
struct Link {
    length: f64,
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

    /// Its largest extent along an axis.
    fn extent(&self) -> f64 {
        let sides = self.lower.iter().zip(&self.upper);
        sides.fold(0.0, |max, (lower, upper)| max.max(upper - lower))
    }

    /// Whether its extent is within its corners' reach. That of corners within reach of one another
    /// always is; that of the ends of an edge, at four times the reach, never.
    fn is_compact(&self) -> bool {
        self.extent() <= self.reach
    }
}

/// Makes corners on open edges that are within reach of one another one, the nearest first;
/// whether there were any.
pub(super) fn join(surface: &mut Surface, tolerance: f64) -> bool {
    let corners = surface.corners();
    let reaches = surface.reaches(&corners, tolerance);
    let mut joined = UnionFind::<u32>::new(corners.len());
    let cluster = |(corner, &reach): (&Corner, &f64)| Cluster {
        lower: corner.position,
        upper: corner.position,
        reach,
    };
    let mut clusters: Vec<_> = corners.iter().zip(&reaches).map(cluster).collect();
    let mut gap = 0.0_f64;
    for link in links(&corners, &reaches) {
        let roots = link.ends.map(|end| joined.find_mut(end));
        let [a, b] = roots.map(|root| &clusters[root as usize]);
        let both = a.with(b);
        if roots[0] != roots[1] && both.is_compact() {
            joined.union(roots[0], roots[1]);
            clusters[joined.find_mut(roots[0]) as usize] = both;
            gap = gap.max(link.length).max(both.extent());
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
    surface.join(&groups, false, gap);
    !groups.is_empty()
}

/// Pairs of corners within reach of one another, the nearest first.
fn links(corners: &[Corner], reaches: &[f64]) -> Vec<Link> {
    let numbered = corners.iter().zip(0_u32..);
    let points = numbered.map(|(corner, number)| GeomWithData::new(corner.position, number));
    let tree = RTree::bulk_load(points.collect());
    let numbers = (0..corners.len()).into_par_iter();
    let mut links: Vec<_> = numbers
        .flat_map_iter(|number| {
            let near = neighbours(&tree, corners[number].position, reaches[number]);
            let near = near.into_iter().filter(move |&(other, length)| {
                other as usize != number && length <= reaches[other as usize]
            });
            near.map(move |(other, length)| Link {
                length,
                ends: [other.min(number as u32), other.max(number as u32)],
            })
        })
        .collect();
    links.par_sort_unstable_by(|a, b| {
        let lengths = a.length.total_cmp(&b.length);
        lengths.then(a.ends.cmp(&b.ends))
    });
    links.dedup_by(|a, b| a.ends == b.ends);
    links
}

/// The nearest points within `reach` of a position, itself among them, and their distances.
fn neighbours(tree: &Tree, position: [f64; 3], reach: f64) -> Vec<(u32, f64)> {
    let near = tree.locate_in_envelope(&around(position, reach));
    let mut near: Vec<_> = near.take(MANY).collect();
    if near.len() == MANY {
        let nearest = tree.nearest_neighbor_iter(&position);
        near = nearest.take(NEIGHBOURS + 1).collect();
    }
    let near = near.into_iter();
    let near = near.map(|other| (other.data, distance(*other.geom(), position)));
    let mut near: Vec<_> = near.filter(|&(_, length)| length <= reach).collect();
    near.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    near.truncate(NEIGHBOURS + 1);
    near
}
