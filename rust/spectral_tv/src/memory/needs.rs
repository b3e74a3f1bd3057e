//! How much memory work takes, estimated before it starts.
//!
//! What is kept (states, eigenfunctions) is counted. What matrices, factors and hierarchies take
//! besides was fitted to the peaks of processes that worked on 10 000 to a million vertices.

use crate::memory::NUMBER;
use crate::mesh::TriangleMesh;

/// Bytes per vertex of a flow beside its states, where systems are factorized, in double or single precision, or
/// iterated on.
const FACTORIZED: u64 = 2200;
const FACTORIZED_IN_SINGLE: u64 = 1300;
const ITERATED: u64 = 900;
/// The same of eigenpairs beside their functions.
const LANCZOS: u64 = 3400;
/// The same of the pair of surfaces that a flow on a base holds.
const BASE: u64 = 500;
/// The same of the operators of a mesh, which are part of all of these.
const OPERATORS: u64 = 500;
/// The same of a flow and of operators on edges.
const FACTORIZED_ON_EDGES: u64 = 4000;
const OPERATORS_ON_EDGES: u64 = 1000;
/// The same of a pose: from 3800 at a million vertices to 5500 at 40 000 were measured.
const POSED: u64 = 5000;
/// The same of one solution of a deformer, beside what that holds.
const SOLUTION: u64 = 600;
/// The same of looking for faces that fold, of clamping a displacement, and of boxes round faces.
const FOLDS: u64 = 120;
const CLAMPED: u64 = 300;
const BOXES: u64 = 520;

/// How large a mesh is, for what is held of its vertices and triangles: V, or F/4 if that is more:
/// most have 2 V triangles, an image's grid 4 V.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size(u64);

impl Size {
    /// That of a mesh.
    pub fn of(mesh: &TriangleMesh) -> Self {
        Self::new(mesh.vertex_count(), mesh.triangles().len())
    }

    /// That of a mesh with so many vertices and triangles.
    pub fn new(vertices: usize, triangles: usize) -> Self {
        Self(vertices.max(triangles / 4) as u64)
    }

    /// V, or F/4.
    pub fn count(self) -> u64 {
        self.0
    }

    fn times(self, bytes: u64) -> u64 {
        self.0.saturating_mul(bytes)
    }
}

/// How the systems of a flow are solved, as far as it is known of a size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solved {
    /// By factorization in double precision.
    Exactly,
    /// By factorization in single precision, or less costly by iteration.
    InSingle,
    /// By iteration.
    Iteratively,
}

/// Bytes of a flow of so many channels and steps while it runs. Increments are kept in double precision where
/// systems are solved exactly, else in single; in half of that on a mesh of one piece.
pub fn flow(size: Size, channels: usize, steps: usize, solved: Solved) -> u64 {
    let (beside, number) = match solved {
        Solved::Exactly => (FACTORIZED, NUMBER),
        Solved::InSingle => (FACTORIZED_IN_SINGLE, NUMBER / 2),
        Solved::Iteratively => (ITERATED, NUMBER / 2),
    };
    let states = number
        .saturating_mul(channels as u64)
        .saturating_mul(steps as u64);
    size.times(beside.saturating_add(states))
}

/// Bytes of a flow on edges, whose steps are exact.
pub fn edge_flow(size: Size, channels: usize, steps: usize) -> u64 {
    let states = functions(channels, 1).saturating_mul(steps as u64);
    size.times(FACTORIZED_ON_EDGES.saturating_add(states))
}

/// What a flow takes more that goes along a base.
pub fn base(size: Size) -> u64 {
    size.times(BASE)
}

/// Bytes of `count` eigenpairs while they are sought: a basis of up to twice as many functions,
/// which is moved when it grows.
pub fn eigenpairs(size: Size, count: usize) -> u64 {
    size.times(LANCZOS.saturating_add((4 * NUMBER).saturating_mul(count as u64)))
}

/// Bytes of finding segments among so many vertices in all: the components of one shape with
/// `most_components` each at a time, and the quantiles of all, twice while they are brought together.
pub fn segments(vertices: usize, most_components: usize, quantiles: usize) -> u64 {
    let numbers = (2 * quantiles as u64).saturating_add(most_components as u64);
    (vertices as u64).saturating_mul(NUMBER.saturating_mul(numbers))
}

/// Bytes of a deformation while it is sought.
pub fn deformation(size: Size) -> u64 {
    size.times(FACTORIZED)
}

/// The same by an algorithm with matrices of its own, beside those of the certificate.
pub fn deformation_for_comparison(size: Size) -> u64 {
    size.times(2 * FACTORIZED)
}

/// Bytes of so many solutions of a deformer, which are kept, while they are sought.
pub fn solutions(size: Size, count: usize) -> u64 {
    let kept = functions(3, size.0).saturating_mul(count as u64);
    size.times(SOLUTION).saturating_add(kept)
}

/// Bytes of a pose while it is sought.
pub fn pose(size: Size) -> u64 {
    size.times(POSED)
}

/// Bytes of so many poses, which are kept, while they are sought.
pub fn poses(size: Size, count: usize) -> u64 {
    let kept = functions(7, size.0).saturating_mul(count as u64);
    size.times(SOLUTION).saturating_add(kept)
}

/// Bytes of looking for faces that fold, if all of them do.
pub fn folds(size: Size) -> u64 {
    size.times(FOLDS)
}

/// Bytes of clamping a displacement.
pub fn safe_displacement(size: Size) -> u64 {
    size.times(CLAMPED)
}

/// Bytes of looking for faces that cross others.
pub fn self_intersections(size: Size) -> u64 {
    size.times(BOXES)
}

/// Bytes of the operators of a mesh.
pub fn operators(size: Size) -> u64 {
    size.times(OPERATORS)
}

/// Bytes of the operators of a mesh for functions on its edges.
pub fn edge_operators(size: Size) -> u64 {
    size.times(OPERATORS_ON_EDGES)
}

/// Bytes of a mesh of so many vertices and triangles while it is made.
pub fn mesh(vertices: usize, triangles: usize) -> u64 {
    let of_vertices = 16 * NUMBER * vertices as u64;
    of_vertices.saturating_add(16 * NUMBER * triangles as u64)
}

/// Bytes of joining a mesh of so many vertices, if all of them are on open edges and no two at
/// the same place.
pub fn welding(vertices: usize) -> u64 {
    64 * NUMBER * vertices as u64
}

/// Bytes of `count` functions of one value at each of so many vertices.
pub fn functions(count: usize, vertices: u64) -> u64 {
    NUMBER.saturating_mul(count as u64).saturating_mul(vertices)
}
