//! Which vertices of a pose are of pieces that move rigidly, and which of joints.

use nalgebra::Quaternion;
use petgraph::unionfind::UnionFind;

use crate::mesh::{TriangleMesh, component_count};
use crate::posing::handles::diagonal;
use crate::posing::lanes::LANES;
use crate::posing::model::Model;
use crate::posing::motion::{self, Motion, Pair};
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
/// The vertices of a piece that another one is kept apart from: fewer may be of a joint that turns.
const LEAST_VERTICES: usize = 10;
/// The angle, in radians, from which on pieces that touch are two: 5°.
const BEND: f64 = 0.0873;
/// How far from a piece's motion, relative to the diagonal, what is not connected to it is of it.
const ALIKE: f64 = 1e-2;

/// The piece of every vertex, the largest first; `None` in joints.
///
/// Faces join their corners in the order of e. So two pieces grow until they meet, at the faces that
/// the joint between them strains least.
pub(super) fn pieces(mesh: &TriangleMesh, model: &Model, state: &State) -> Vec<Option<u32>> {
    let areas = mesh.face_areas();
    let terms: Vec<f64> = (0..areas.len())
        .step_by(LANES)
        .flat_map(|first| model.face_terms(first, state).square.sqrt().0)
        .take(areas.len())
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
    let labels = growth.labels(&is_in);
    numbered(mesh, &attached(mesh, model, state, labels))
}

/// The rigid motion of each piece that fits best.
pub(super) fn motions(
    mesh: &TriangleMesh,
    model: &Model,
    state: &State,
    labels: &[Option<u32>],
) -> Vec<Motion> {
    let pieces = by_label(labels);
    let fitted = |vertices: &Vec<usize>| {
        let points: Vec<Pair> = vertices
            .iter()
            .map(|&v| pair(mesh, model, state, v))
            .collect();
        motion::fitted(&points, &Motion::none(), 0.0, |point| point.0)
    };
    pieces.iter().map(fitted).collect()
}

/// Has parts that are not connected be of one piece where they move alike. Parts without a piece,
/// as they are small, are of the one that moves most like them.
fn attached(
    mesh: &TriangleMesh,
    model: &Model,
    state: &State,
    labels: Vec<Option<u32>>,
) -> Vec<Option<u32>> {
    let components = mesh.connected_components();
    if component_count(&components) < 2 || labels.iter().all(Option::is_none) {
        return labels;
    }
    let motions = motions(mesh, model, state, &labels);
    let pieces = by_label(&labels);
    let component = |vertices: &Vec<usize>| components[vertices[0]];
    let nearest = |vertices: &[usize], among: &mut dyn Iterator<Item = usize>| {
        let apart = |piece: usize| {
            let pairs = vertices.iter().map(|&v| pair(mesh, model, state, v));
            let off = |p: Pair| [p.0, p.0 * (motions[piece].applied(&p.1) - p.2).norm()];
            let [area, sum] = pairs
                .map(off)
                .fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
            (sum / area.max(f64::MIN_POSITIVE), piece)
        };
        among
            .map(apart)
            .min_by(|one, other| one.0.total_cmp(&other.0))
    };
    let mut targets: Vec<u32> = (0..pieces.len() as u32).collect();
    let alike = ALIKE * diagonal(&model.rest);
    for (piece, vertices) in pieces.iter().enumerate().skip(1) {
        let mut larger =
            (0..piece).filter(|&other| component(&pieces[other]) != component(vertices));
        match nearest(vertices, &mut larger) {
            Some((apart, other)) if apart < alike => targets[piece] = targets[other],
            _ => {}
        }
    }
    let mut parts = vec![Vec::new(); component_count(&components)];
    for (vertex, &component) in components.iter().enumerate() {
        parts[component as usize].push(vertex);
    }
    let mut labels: Vec<Option<u32>> = labels
        .iter()
        .map(|label| label.map(|piece| targets[piece as usize]))
        .collect();
    for part in parts {
        if part.iter().all(|&vertex| labels[vertex].is_none()) {
            let found = nearest(&part, &mut (0..pieces.len()));
            for vertex in part {
                labels[vertex] = found.map(|(_, piece)| targets[piece]);
            }
        }
    }
    labels
}

/// Labels as numbers of pieces, the largest first.
fn numbered(mesh: &TriangleMesh, labels: &[Option<u32>]) -> Vec<Option<u32>> {
    let mut areas = vec![0.0; by_label(labels).len()];
    for (label, area) in labels.iter().zip(mesh.vertex_areas()) {
        if let Some(piece) = label {
            areas[*piece as usize] += area;
        }
    }
    let is_used = |piece: &usize| labels.contains(&Some(*piece as u32));
    let mut order: Vec<usize> = (0..areas.len()).filter(is_used).collect();
    order.sort_by(|&a, &b| areas[b].total_cmp(&areas[a]).then(a.cmp(&b)));
    let mut numbers = vec![0; areas.len()];
    for (number, piece) in order.into_iter().enumerate() {
        numbers[piece] = number as u32;
    }
    let of = |label: &Option<u32>| label.map(|piece| numbers[piece as usize]);
    labels.iter().map(of).collect()
}

/// The vertices of every label.
fn by_label(labels: &[Option<u32>]) -> Vec<Vec<usize>> {
    let count = labels.iter().flatten().max().map_or(0, |&last| last + 1);
    let mut found = vec![Vec::new(); count as usize];
    for (vertex, label) in labels.iter().enumerate() {
        if let Some(piece) = label {
            found[*piece as usize].push(vertex);
        }
    }
    found
}

/// The area of a vertex, and where it is at rest and posed.
fn pair(mesh: &TriangleMesh, model: &Model, state: &State, vertex: usize) -> Pair {
    let area = mesh.vertex_areas()[vertex];
    (area, model.rest[vertex], state.positions[vertex])
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
    sizes: Vec<usize>,
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
            sizes: vec![1; areas.len()],
            least: LEAST_AREA * mesh.area(),
            areas,
        }
    }

    /// Joins what the corners of a face are of, unless it is between pieces.
    fn join(&mut self, corners: &[u32; 3]) -> bool {
        let mut groups = corners.map(|corner| self.groups.find_mut(corner)).to_vec();
        groups.sort_unstable();
        groups.dedup();
        let is_piece = |&group: &u32| {
            let group = group as usize;
            self.areas[group] > self.least && self.sizes[group] >= LEAST_VERTICES
        };
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
        let size = groups.iter().map(|&group| self.sizes[group as usize]).sum();
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
        self.sizes[group] = size;
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

    /// The pieces of vertices, the largest first; `is_in` tells which are in a face of one.
    fn labels(self, is_in: &[bool]) -> Vec<Option<u32>> {
        let Self {
            groups,
            areas,
            least,
            ..
        } = self;
        let first = groups.into_labeling();
        let is_piece = |&v: &usize| first[v] as usize == v && is_in[v] && areas[v] > least;
        let mut order: Vec<usize> = (0..first.len()).filter(is_piece).collect();
        order.sort_by(|&a, &b| areas[b].total_cmp(&areas[a]).then(a.cmp(&b)));
        let mut numbers = vec![None; first.len()];
        for (number, piece) in order.into_iter().enumerate() {
            numbers[piece] = Some(number as u32);
        }
        let of = |(&first, &is_in): (&u32, &bool)| numbers[first as usize].filter(|_| is_in);
        first.iter().zip(is_in).map(of).collect()
    }
}
