//! Thickness that goes on from one frame of a moving shape to the next without a jump.
//!
//! The largest ball at a vertex is another one after the least motion, and it is measured at samples. So
//! thickness that is measured anew in each frame flickers, and with it all that is cut by it.

use crate::error::Result;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
use crate::nearest::Nearest;
use crate::parallel;
use crate::thickness::thickness_with;

/// How much of the logarithm of what is measured in a frame counts where vertices do not stay.
const RENEWAL: f64 = 0.1;
/// Meshes of equally many vertices keep these if so many of their triangles stay. Quads may be split
/// along their other diagonal meanwhile.
const KEPT: f64 = 0.5;
/// Vertices between two looks whether to go on.
const AT_A_TIME: usize = 1 << 16;

/// The thickness of the shape at every vertex, V, length, where `before` is the same shape a moment
/// earlier.
///
/// A vertex that stays keeps the thickness that it had. Otherwise it has mostly that of the nearest point
/// of `before`, unless that is farther away than the shape is thick, and a share of its own.
///
/// # Errors
/// As [`super::thickness`].
pub fn thickness_after(mesh: &TriangleMesh, before: &TriangleMesh) -> Result<Vec<f64>> {
    thickness_after_with(mesh, before, Monitor::new().whole())
}

/// [`thickness_after`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`thickness_after`], or [`crate::Error::Cancelled`].
pub fn thickness_after_with(
    mesh: &TriangleMesh,
    before: &TriangleMesh,
    stage: Stage,
) -> Result<Vec<f64>> {
    let is_kept = keeps_vertices(mesh, before);
    let former = thickness_with(before, stage.stage(0.0, if is_kept { 1.0 } else { 0.4 }))?;
    if is_kept {
        return Ok(former.to_vec());
    }
    let own = thickness_with(mesh, stage.stage(0.4, 0.8))?;
    let nearest = Nearest::new_with(before, stage)?;
    let mut radii = Vec::with_capacity(own.len());
    while radii.len() < own.len() {
        let first = radii.len();
        stage.report(0.8 + 0.2 * first as f64 / own.len() as f64)?;
        radii.extend(parallel::values(
            AT_A_TIME.min(own.len() - first),
            |place| {
                let vertex = first + place;
                followed(&nearest, former, mesh.vertices()[vertex], own[vertex])
            },
        ));
    }
    Ok(radii)
}

/// Whether two meshes have the same vertices at other places.
fn keeps_vertices(mesh: &TriangleMesh, before: &TriangleMesh) -> bool {
    let (own, former) = (mesh.triangles(), before.triangles());
    let same = own
        .iter()
        .zip(former.iter())
        .filter(|(a, b)| a == b)
        .count();
    mesh.vertex_count() == before.vertex_count()
        && same as f64 >= KEPT * own.len().max(former.len()) as f64
}

/// The thickness at a point that goes on from the `former` one of the nearest point, where it is `own`
/// now.
fn followed(nearest: &Nearest, former: &[f64], point: [f64; 3], own: f64) -> f64 {
    let Some(place) = nearest.place(point) else {
        return own;
    };
    let former = place.of(nearest.corners(place.face).map(|corner| former[corner]));
    if own <= 0.0 || former <= 0.0 {
        return own;
    }
    let away = (place.distance / own).powi(2);
    let share = 1.0 - (1.0 - RENEWAL) * (-away).exp();
    (share * own.ln() + (1.0 - share) * former.ln()).exp()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::thickness::thickness;

    /// The unit sphere as rings of `count` vertices.
    fn sphere(count: i64) -> TriangleMesh {
        let angle = |k: i64, whole: f64| whole * k as f64 / count as f64;
        let place = |ring: i64, k: i64| {
            let (polar, around) = (angle(ring, PI), angle(k, 2.0 * PI));
            [
                polar.sin() * around.cos(),
                polar.sin() * around.sin(),
                polar.cos(),
            ]
        };
        let vertices = (0..=count).flat_map(|ring| (0..count).map(move |k| place(ring, k)));
        let corner = |ring: i64, k: i64| ring * count + k % count;
        let quad = |ring: i64, k: i64| {
            let [a, b] = [corner(ring, k), corner(ring, k + 1)];
            [[a, a + count, b + count], [a, b + count, b]]
        };
        let triangles: Vec<_> = (0..count)
            .flat_map(|ring| (0..count).flat_map(move |k| quad(ring, k)))
            .collect();
        TriangleMesh::new(vertices.collect(), &triangles).unwrap()
    }

    fn moved(mesh: &TriangleMesh, place: impl Fn([f64; 3]) -> [f64; 3]) -> TriangleMesh {
        let vertices = mesh.vertices().iter().map(|point| place(*point)).collect();
        let triangles: Vec<_> = mesh.triangles().iter().map(|t| t.map(i64::from)).collect();
        TriangleMesh::new(vertices, &triangles).unwrap()
    }

    #[test]
    fn vertices_that_stay_keep_their_thickness() {
        let before = sphere(16);
        let mesh = moved(&before, |[x, y, z]| [x, y, 1.5 * z]);
        let found = thickness_after(&mesh, &before).unwrap();
        assert_eq!(found, thickness(&before).unwrap());
    }

    #[test]
    fn other_vertices_of_the_same_shape_have_nearly_what_was_there() {
        let before = sphere(16);
        let given: Vec<f64> = before.vertices().iter().map(|p| 2.0 + p[2]).collect();
        let before = before.with_thickness(given).unwrap();
        let mesh = sphere(24);
        let found = thickness_after(&mesh, &before).unwrap();
        let own = thickness(&mesh).unwrap();
        for (vertex, point) in mesh.vertices().iter().enumerate() {
            let wanted = f64::powf(2.0 + point[2], 1.0 - RENEWAL) * own[vertex].powf(RENEWAL);
            assert!((found[vertex] / wanted - 1.0).abs() < 0.05, "{found:?}");
        }
    }

    #[test]
    fn what_is_far_from_the_shape_before_has_its_own_thickness() {
        let before = sphere(16);
        let mesh = moved(&sphere(24), |[x, y, z]| [0.1 * x + 5.0, 0.1 * y, 0.1 * z]);
        let found = thickness_after(&mesh, &before).unwrap();
        let own = thickness(&mesh).unwrap();
        assert!(
            found
                .iter()
                .zip(own)
                .all(|(a, b)| (a / b - 1.0).abs() < 1e-6)
        );
    }
}
