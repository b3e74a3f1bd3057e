//! Faces of a mesh that cross other faces of it.

use ndarray::ArrayView2;
use rayon::prelude::*;
use rstar::AABB;

use crate::error::Result;
use crate::guard::crossing::{Triangle, cross};
use crate::guard::displaced::Displaced;
use crate::guard::slabs::{Boxes, Slabs};
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
use crate::parallel;

/// Share of the progress that is given to sorting the faces by place.
const SORTING: f64 = 0.4;

/// The faces of `mesh` that cross another face of it, in order, where its vertices are moved by
/// `displacement` (3, V), if there is one.
///
/// Two faces cross if a point inside one is in the other, inside it or on its border. So those
/// do not count that merely touch at their borders: neighbours, faces whose corners lie at the same places
/// without being joined, and those whose edges lie on one another. Faces that share a corner or an edge
/// count if they meet beyond it; so do faces that lie on one another. A face with no area crosses nothing.
///
/// Decided by exact arithmetic on the positions, so there is no tolerance.
///
/// # Errors
/// If the displacement is not of this mesh or not finite, or memory does not suffice.
pub fn self_intersections(
    mesh: &TriangleMesh,
    displacement: Option<ArrayView2<f64>>,
) -> Result<Vec<usize>> {
    self_intersections_with(mesh, displacement, Monitor::new().whole())
}

/// [`self_intersections`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`self_intersections`], or [`crate::Error::Cancelled`].
pub fn self_intersections_with(
    mesh: &TriangleMesh,
    displacement: Option<ArrayView2<f64>>,
    stage: Stage,
) -> Result<Vec<usize>> {
    stage.report(0.0)?;
    let count = mesh.triangles().len();
    stage.require(
        needs::self_intersections(needs::Size::of(mesh)),
        &format!("looking for faces that cross among {count}"),
        "take a mesh of fewer faces",
    )?;
    let positions = match displacement {
        Some(displacement) => moved(&Displaced::new(mesh, displacement)?),
        None => scaled(mesh.vertices()),
    };
    let faces = Faces {
        triangles: mesh.triangles(),
        positions,
    };
    let slabs = Slabs::new(&faces, stage.stage(0.0, SORTING))?;
    let stage = stage.stage(SORTING, 1.0);
    let mut is_crossed = vec![false; count];
    for slab in 0..slabs.count() {
        stage.report(slab as f64 / slabs.count() as f64)?;
        for face in slabs.pairs(slab, |one, other| faces.cross(one, other)) {
            is_crossed[face as usize] = true;
        }
    }
    stage.report(1.0)?;
    Ok((0..count).filter(|&face| is_crossed[face]).collect())
}

/// The vertices where a displacement takes them.
fn moved(displaced: &Displaced) -> Vec<[f64; 3]> {
    let pairs = displaced.mesh.vertices().par_iter().zip(&*displaced.shifts);
    scaled(&parallel::map(pairs, |(vertex, shift)| {
        std::array::from_fn(|axis| vertex[axis] + shift[axis])
    }))
}

/// The same by a power of two, with coordinates around 1: then no product overflows, and nothing is
/// rounded.
fn scaled(positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let largest = parallel::largest(positions.len(), |part| {
        let coordinates = positions[part].as_flattened().iter();
        coordinates.fold(0.0, |most: f64, x| most.max(x.abs()))
    });
    let exponent = largest.max(f64::MIN_POSITIVE).log2() as i32;
    let scale = 2.0_f64.powi(-exponent);
    parallel::map(positions, |position| position.map(|x| scale * x))
}

/// Where the faces are.
struct Faces<'a> {
    triangles: &'a [[u32; 3]],
    positions: Vec<[f64; 3]>,
}

impl Faces<'_> {
    fn corners(&self, face: u32) -> Triangle {
        self.triangles[face as usize].map(|corner| self.positions[corner as usize])
    }

    fn cross(&self, one: u32, other: u32) -> bool {
        cross(&self.corners(one), &self.corners(other))
    }
}

impl Boxes for Faces<'_> {
    fn count(&self) -> usize {
        self.triangles.len()
    }

    fn envelope(&self, face: u32) -> AABB<[f64; 3]> {
        AABB::from_points(&self.corners(face))
    }
}
