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

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    const CORNERS: [[f64; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    const SIDES: [[i64; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    /// Two tetrahedra, the second moved from the place of the first.
    fn two(by: [f64; 3]) -> TriangleMesh {
        let moved = CORNERS.map(|p| std::array::from_fn(|axis| p[axis] + by[axis]));
        let sides = SIDES
            .iter()
            .chain(&SIDES)
            .zip([0; 4].into_iter().chain([4; 4]));
        let triangles: Vec<_> = sides.map(|(side, first)| side.map(|v| v + first)).collect();
        TriangleMesh::new([CORNERS, moved].concat(), &triangles).unwrap()
    }

    fn found(by: [f64; 3]) -> Vec<usize> {
        self_intersections(&two(by), None).unwrap()
    }

    #[test]
    fn tetrahedra_cross_where_they_interpenetrate() {
        assert_eq!(found([3.0, 0.0, 0.0]), []);
        // The tip of the first is above the base of the second, inside.
        assert_eq!(found([-0.1, -0.1, 0.5]), [1, 2, 3, 4]);
        let mesh = two([3.0, 0.0, 0.0]);
        let back = Array2::from_shape_fn((3, 8), |(axis, v)| match v < 4 {
            true => 0.0,
            false => [-3.1, -0.1, 0.5][axis],
        });
        assert_eq!(
            self_intersections(&mesh, Some(back.view())).unwrap(),
            [1, 2, 3, 4]
        );
    }

    #[test]
    fn touching_is_not_crossing() {
        // At a corner, at the tip, and with a corner on the middle of an edge.
        assert_eq!(found([1.0, 0.0, 0.0]), []);
        assert_eq!(found([0.0, 0.0, 1.0]), []);
        assert_eq!(found([0.5, 0.5, 0.0]), []);
        // The same again lies on itself.
        assert_eq!(found([0.0; 3]), [0, 1, 2, 3, 4, 5, 6, 7]);
        // A face on a face, with a part in common.
        assert_eq!(found([0.5, 0.25, 0.0]), [0, 2, 4, 5, 7]);
    }

    #[test]
    fn faces_that_share_a_corner_or_an_edge_cross_beyond_it() {
        let mesh = |vertices: &[[f64; 3]], triangles: &[[i64; 3]]| {
            let mesh = TriangleMesh::new(vertices.to_vec(), triangles).unwrap();
            self_intersections(&mesh, None).unwrap()
        };
        let flat = [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.]];
        let with = |more: &[[f64; 3]]| [&flat, more].concat();
        // Through the face from its corner, and beside it.
        let through = with(&[[1., 1., 1.], [1., 1., -1.]]);
        assert_eq!(mesh(&through, &[[0, 1, 2], [0, 3, 4]]), [0, 1]);
        let beside = with(&[[-1., -1., 1.], [-1., -1., -1.]]);
        assert_eq!(mesh(&beside, &[[0, 1, 2], [0, 3, 4]]), []);
        // Folded onto the face along an edge, and away from it.
        assert_eq!(
            mesh(&with(&[[0.5, 0.5, 0.]]), &[[0, 1, 2], [1, 0, 3]]),
            [0, 1]
        );
        assert_eq!(mesh(&with(&[[0.5, -0.5, 0.]]), &[[0, 1, 2], [1, 0, 3]]), []);
        assert_eq!(
            mesh(&with(&[[0.5, 0.5, 1e-300]]), &[[0, 1, 2], [1, 0, 3]]),
            []
        );
        // Without area.
        assert_eq!(
            mesh(
                &with(&[[1., 1., 1.], [0.5, 0.5, 0.], [0., 0., -1.]]),
                &[[0, 1, 2], [3, 4, 5]]
            ),
            []
        );
    }

    #[test]
    fn there_are_as_many_in_many_slabs() {
        let count = 30_000;
        let mut random = fastrand::Rng::with_seed(5);
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        let mut expected = Vec::new();
        for pair in 0..count {
            // Every other pair interpenetrates. A sheet passes through two sides of the first of each.
            let x = f64::from(random.u32(0..1_000_000)) + 1e7 * f64::from(pair);
            let apart = if pair % 2 == 0 { 0.5 } else { 1.5 };
            for (tetrahedron, up) in [0.0, apart].into_iter().enumerate() {
                let first = vertices.len() as i64;
                let shift = 0.1 * tetrahedron as f64;
                vertices.extend(CORNERS.map(|[a, b, c]| [x + a - shift, b - shift, c + up]));
                triangles.extend(SIDES.map(|side| side.map(|v| v + first)));
            }
            let crossing: &[usize] = if pair % 2 == 0 {
                &[1, 2, 3, 4]
            } else {
                &[2, 3]
            };
            expected.extend(crossing.iter().map(|face| 8 * pair as usize + face));
        }
        let first = vertices.len() as i64;
        let end = 1e7 * f64::from(count);
        vertices.extend([[-1.0, 0.2, 0.2], [end, 0.2, 0.2], [-1.0, 9.0, 0.2]]);
        triangles.push([first, first + 1, first + 2]);
        let mesh = TriangleMesh::new(vertices, &triangles).unwrap();
        expected.push(8 * count as usize);
        assert_eq!(self_intersections(&mesh, None).unwrap(), expected);
    }
}
