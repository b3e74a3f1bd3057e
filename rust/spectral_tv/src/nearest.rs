//! The points of a surface that are nearest to others.

use std::sync::Arc;

use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::error::Result;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
use crate::parallel;
use crate::thickness::scaled::{cross, difference, dot, middle, square_distance};
use crate::thickness::triangle::Triangle;

/// Bytes per triangle of a tree of them.
const TREE: u64 = 200;
/// Points between two looks whether to go on.
const AT_A_TIME: usize = 1 << 16;

/// A surface in which nearest points are looked for.
pub struct Nearest {
    /// So that the mesh's own distance from the origin takes no digits.
    middle: [f64; 3],
    corners: Arc<[[u32; 3]]>,
    tree: RTree<GeomWithData<Triangle, u32>>,
}

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The triangle that it is in.
    pub face: usize,
    /// The shares of the triangle's corners in it. They are at least 0, and their sum is 1.
    pub weights: [f64; 3],
    /// How far it is from the point it was looked for, length.
    pub distance: f64,
}

impl Place {
    /// What values at the corners of the triangle are there.
    #[must_use]
    pub fn of(&self, values: [f64; 3]) -> f64 {
        (0..3).map(|k| self.weights[k] * values[k]).sum()
    }
}

impl Nearest {
    /// Sorts the triangles of a mesh by place. Those without area belong to no surface.
    ///
    /// # Errors
    /// [`crate::Error::Memory`] if the work does not fit into what is available.
    pub fn new(mesh: &TriangleMesh) -> Result<Self> {
        Self::new_with(mesh, Monitor::new().whole())
    }

    /// [`Self::new`], watched: `stage` cancels it.
    ///
    /// # Errors
    /// As [`Self::new`], or [`crate::Error::Cancelled`].
    pub fn new_with(mesh: &TriangleMesh, stage: Stage) -> Result<Self> {
        stage.claim(
            TREE.saturating_mul(mesh.triangles().len() as u64),
            &format!("the search among {} triangles", mesh.triangles().len()),
            "take meshes of fewer triangles",
        )?;
        let middle = middle(mesh);
        let triangles = mesh.triangles().iter().enumerate();
        let triangles = triangles.filter(|(face, _)| mesh.face_areas()[*face] > 0.0);
        let located = |(face, corners): (usize, &[u32; 3])| {
            let corners =
                corners.map(|corner| difference(mesh.vertices()[corner as usize], middle));
            GeomWithData::new(Triangle(corners), face as u32)
        };
        let tree = stage.pass(|| RTree::bulk_load(triangles.map(located).collect()))?;
        let corners = Arc::clone(mesh.triangles());
        Ok(Self {
            middle,
            corners,
            tree,
        })
    }

    /// The corners of a triangle of the mesh.
    #[must_use]
    pub fn corners(&self, face: usize) -> [usize; 3] {
        self.corners[face].map(|corner| corner as usize)
    }

    /// The place that is nearest to a point; none if no triangle has an area.
    #[must_use]
    pub fn place(&self, point: [f64; 3]) -> Option<Place> {
        let point = difference(point, self.middle);
        let found = self.tree.nearest_neighbor(&point)?;
        Some(place(found, point))
    }

    /// The nearest place no farther than `farthest` from a point whose triangle faces the same way as
    /// `normal`, to within 90°. All triangles do if the normal is 0.
    #[must_use]
    pub fn facing(&self, point: [f64; 3], normal: [f64; 3], farthest: f64) -> Option<Place> {
        let point = difference(point, self.middle);
        let is_any = normal == [0.0; 3];
        let mut places = self.tree.nearest_neighbor_iter_with_distance_2(&point);
        places
            .by_ref()
            .take_while(|(_, square)| square.sqrt() <= farthest)
            .find(|(found, _)| is_any || dot(area_normal(found.geom()), normal) > 0.0)
            .map(|(found, _)| place(found, point))
    }

    /// [`Self::facing`] of many points with normals, N; `stage` tells how far it is, and cancels it.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn all_facing(
        &self,
        points: &[[f64; 3]],
        normals: &[[f64; 3]],
        farthest: f64,
        stage: Stage,
    ) -> Result<Vec<Option<Place>>> {
        let count = points.len();
        let mut places = Vec::with_capacity(count);
        while places.len() < count {
            let first = places.len();
            stage.report(first as f64 / count as f64)?;
            places.extend(parallel::values(AT_A_TIME.min(count - first), |place| {
                self.facing(points[first + place], normals[first + place], farthest)
            }));
        }
        Ok(places)
    }
}

/// Twice the area of a triangle along its normal.
fn area_normal(Triangle([a, b, c]): &Triangle) -> [f64; 3] {
    cross(difference(*b, *a), difference(*c, *a))
}

/// The point of a triangle that is nearest to `point`.
fn place(found: &GeomWithData<Triangle, u32>, point: [f64; 3]) -> Place {
    let nearest = found.geom().nearest(point);
    let [a, b, c] = found.geom().0.map(|corner| difference(corner, nearest));
    let areas = [cross(b, c), cross(c, a), cross(a, b)].map(|area| dot(area, area).sqrt());
    let total: f64 = areas.iter().sum();
    let weights = if total > 0.0 {
        areas.map(|area| area / total)
    } else {
        [1.0, 0.0, 0.0]
    };
    Place {
        face: found.data as usize,
        weights,
        distance: square_distance(nearest, point).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two parallel unit squares, the upper one facing up, the lower one, at −0.1, facing down.
    fn shell() -> TriangleMesh {
        let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]];
        let layer = |z: f64| square.map(|[x, y]| [x, y, z]);
        let vertices = [layer(0.0), layer(-0.1)].concat();
        let triangles = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]];
        TriangleMesh::new(vertices, &triangles).unwrap()
    }

    #[test]
    fn a_point_has_its_place_in_a_triangle_with_the_shares_of_its_corners() {
        let nearest = Nearest::new(&shell()).unwrap();
        let place = nearest.place([0.75, 0.5, 0.25]).unwrap();
        assert_eq!((place.face, place.distance), (0, 0.25));
        let corners = nearest.corners(place.face);
        let mesh = shell();
        for axis in 0..3 {
            let at = place.of(corners.map(|corner| mesh.vertices()[corner][axis]));
            assert!((at - [0.75, 0.5, 0.0][axis]).abs() < 1e-12);
        }
    }

    #[test]
    fn a_layer_that_faces_away_is_passed_over() {
        let nearest = Nearest::new(&shell()).unwrap();
        let below = |normal, farthest| nearest.facing([0.75, 0.25, -0.09], normal, farthest);
        assert_eq!(below([0.0; 3], 1.0).unwrap().face, 2);
        assert_eq!(below([0.1, 0.0, 1.0], 1.0).unwrap().face, 0);
        assert_eq!(below([0.1, 0.0, 1.0], 0.08), None);
    }
}
