//! Which vertices of a pose are of pieces that move rigidly, and which of joints.

use nalgebra::Quaternion;
use petgraph::unionfind::UnionFind;

use crate::mesh::TriangleMesh;
use crate::posing::model::Model;
use crate::posing::state::{State, aligned, normalized};

/// e of strain and turning from which on a face is of a joint, whatever others are.
const RIGID: f64 = 0.1;
/// The same where all bends are weak, relative to the largest e.
const JOINT: f64 = 0.3;
/// The part of the area that may exceed the largest e, as single faces say little.
const FEW: f64 = 1e-3;
/// The largest e of a mesh that does not bend.
const STILL: f64 = 1e-3;
/// The part of the area that makes a piece.
const LEAST_AREA: f64 = 0.004;
/// The angle, in radians, from which on pieces that touch are two: 5°.
const BEND: f64 = 0.0873;

/// The piece of every vertex, the largest first; `None` in joints.
///
/// Faces join their corners in the order of e. So two pieces grow until they meet, at the faces that
/// the joint between them strains least.
pub(super) fn pieces(mesh: &TriangleMesh, model: &Model, state: &State) -> Vec<Option<u32>> {
    let areas = mesh.face_areas();
    let terms: Vec<f64> = (0..areas.len())
        .map(|face| model.face_term(face, state).square.sqrt())
        .collect();
    let mut order: Vec<usize> = (0..areas.len()).filter(|&face| areas[face] > 0.0).collect();
    order.sort_by(|&a, &b| terms[a].total_cmp(&terms[b]));
    let least = least_of_joints(areas, &terms, &order);
    let mut growth = Growth::new(mesh, state);
    let mut is_in = vec![false; mesh.vertex_count()];
    for face in order.into_iter().take_while(|&face| terms[face] < least) {
        let corners = &mesh.triangles()[face];
        if growth.join(corners) {
            for &corner in corners {
                is_in[corner as usize] = true;
            }
        }
    }
    growth.numbered(&is_in)
}

/// The least e of faces that are of joints; `order` sorts the faces by theirs.
fn least_of_joints(areas: &[f64], terms: &[f64], order: &[usize]) -> f64 {
    let mut left = FEW * areas.iter().sum::<f64>();
    let largest = order.iter().rev().find(|&&face| {
        left -= areas[face];
        left < 0.0
    });
    match largest.map_or(0.0, |&face| terms[face]) {
        still if still < STILL => f64::INFINITY,
        largest => RIGID.min(JOINT * largest),
    }
}

/// Groups of vertices that move together so far; what is known of each is kept at its first one.
struct Growth {
    groups: UnionFind<u32>,
    areas: Vec<f64>,
    /// Sums of the vertices' rotations by area.
    turns: Vec<Quaternion<f64>>,
    /// Whether it has met another piece, and takes no more vertices.
    has_met: Vec<bool>,
    /// The area of a piece.
    least: f64,
}

impl Growth {
    fn new(mesh: &TriangleMesh, state: &State) -> Self {
        let areas = mesh.vertex_areas().to_vec();
        let turns = areas.iter().zip(&state.rotations);
        Self {
            groups: UnionFind::new(areas.len()),
            turns: turns.map(|(&area, turn)| turn * area).collect(),
            has_met: vec![false; areas.len()],
            least: LEAST_AREA * mesh.area(),
            areas,
        }
    }

    /// Joins what the corners of a face are of, unless it is between pieces.
    fn join(&mut self, corners: &[u32; 3]) -> bool {
        let mut groups = corners.map(|corner| self.groups.find_mut(corner)).to_vec();
        groups.sort_unstable();
        groups.dedup();
        let is_piece = |&group: &u32| self.areas[group as usize] > self.least;
        let pieces: Vec<u32> = groups.iter().copied().filter(is_piece).collect();
        if self.are_bent(&pieces) {
            for piece in pieces {
                self.has_met[piece as usize] = true;
            }
            return false;
        }
        let has_met = pieces.iter().any(|&piece| self.has_met[piece as usize]);
        if has_met && pieces.len() < groups.len() {
            if pieces.len() == 1 {
                return false;
            }
            groups = pieces;
        }
        let area = groups.iter().map(|&group| self.areas[group as usize]).sum();
        let first = self.turns[groups[0] as usize];
        let turn = groups
            .iter()
            .map(|&group| aligned(self.turns[group as usize], &first));
        let turn = turn.reduce(|sum, turn| sum + turn).unwrap_or(first);
        for pair in groups.windows(2) {
            self.groups.union(pair[0], pair[1]);
        }
        let group = self.groups.find_mut(groups[0]) as usize;
        self.areas[group] = area;
        self.turns[group] = turn;
        self.has_met[group] = has_met;
        true
    }

    /// Whether two of some pieces turn against one another.
    fn are_bent(&self, pieces: &[u32]) -> bool {
        let turn = |piece: u32| normalized(self.turns[piece as usize]);
        let cosine = (0.5 * BEND).cos();
        pieces.iter().enumerate().any(|(place, &one)| {
            let mut others = pieces[..place].iter();
            others.any(|&other| turn(one).dot(&turn(other)).abs() < cosine)
        })
    }

    /// The number of every vertex that `is_in` a piece.
    fn numbered(self, is_in: &[bool]) -> Vec<Option<u32>> {
        let Self {
            groups,
            areas,
            least,
            ..
        } = self;
        let labels = groups.into_labeling();
        let is_first = |&vertex: &usize| labels[vertex] as usize == vertex && is_in[vertex];
        let mut order: Vec<usize> = (0..labels.len())
            .filter(is_first)
            .filter(|&vertex| areas[vertex] > least)
            .collect();
        order.sort_by(|&a, &b| areas[b].total_cmp(&areas[a]).then(a.cmp(&b)));
        let mut numbers = vec![None; labels.len()];
        for (number, piece) in order.into_iter().enumerate() {
            numbers[piece] = Some(number as u32);
        }
        let of = |(&label, &is_in): (&u32, &bool)| numbers[label as usize].filter(|_| is_in);
        labels.iter().zip(is_in).map(of).collect()
    }
}
