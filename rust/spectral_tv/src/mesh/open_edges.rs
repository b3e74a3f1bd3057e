//! Edges that belong to one triangle only: the borders of a surface.

use rayon::prelude::*;

use crate::mesh::intrinsic::repeats_an_index;

/// An edge of one triangle and of no other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct OpenEdge {
    /// Its vertices, the lower index first.
    pub ends: [u32; 2],
    /// The triangle.
    pub triangle: usize,
    /// The triangle's corner that it is opposite to.
    pub apex: usize,
}

/// The open edges of `triangles`, ordered by their ends. A triangle that repeats an index has no
/// edges.
pub(super) fn open_edges(vertex_count: usize, triangles: &[[u32; 3]]) -> Vec<OpenEdge> {
    let odd = vertices_of_odd_edges(vertex_count, triangles);
    let edges = triangles.par_iter().enumerate();
    let mut edges: Vec<_> = edges
        .flat_map_iter(|(triangle, &corners)| {
            edges_of(corners).map(move |(ends, apex)| OpenEdge {
                ends,
                triangle,
                apex,
            })
        })
        .filter(|edge| odd[edge.ends[0] as usize] != 0)
        .collect();
    edges.par_sort_unstable();
    let alone = edges.chunk_by(|a, b| a.ends == b.ends);
    let alone = alone.filter(|same| same.len() == 1);
    alone.map(|edge| edge[0]).collect()
}

/// The vertices of `edges`, in order.
pub(super) fn vertices_of(edges: &[OpenEdge]) -> Vec<u32> {
    let mut vertices: Vec<u32> = edges.iter().flat_map(|edge| edge.ends).collect();
    vertices.par_sort_unstable();
    vertices.dedup();
    vertices
}

/// Not 0 for every vertex that is the lower end of an edge with an odd number of triangles: two
/// triangles at an edge cancel. That the hashes of several such edges cancel as well has a
/// probability of 2⁻⁶⁴.
fn vertices_of_odd_edges(vertex_count: usize, triangles: &[[u32; 3]]) -> Vec<u64> {
    let mut odd = vec![0; vertex_count];
    for &corners in triangles {
        for ([lower, higher], _) in edges_of(corners) {
            odd[lower as usize] ^= hash(higher);
        }
    }
    odd
}

/// The edges of a triangle, the lower index first, each with the corner opposite to it.
pub(super) fn edges_of(corners: [u32; 3]) -> impl Iterator<Item = ([u32; 2], usize)> {
    let count = if repeats_an_index(&corners) { 0 } else { 3 };
    (0..count).map(move |apex| {
        let (a, b) = (corners[(apex + 1) % 3], corners[(apex + 2) % 3]);
        ([a.min(b), a.max(b)], apex)
    })
}

/// Spreads the bits of an index, by the finalizer of SplitMix64; never 0.
fn hash(index: u32) -> u64 {
    let mut bits = u64::from(index) + 1;
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
