//! Folds, safe displacements and crossing faces.

use nalgebra::{Rotation3, Vector3};
use ndarray::Array2;
use proptest::prelude::*;

use spectral_tv::guard::{DEFAULT_STRETCH, folds, safe_displacement, self_intersections};
use spectral_tv::mesh::TriangleMesh;

use crate::config;
use crate::random::{mesh, on};

/// A displacement of any of the meshes.
fn displacement() -> impl Strategy<Value = Vec<Vec<f64>>> {
    (-2.0..1.0_f64).prop_flat_map(|size| {
        let size = 10.0_f64.powf(size);
        prop::collection::vec(prop::collection::vec(-size..size, 54), 3)
    })
}

/// The mesh with its vertices elsewhere.
fn placed(mesh: &TriangleMesh, place: impl Fn(Vector3<f64>) -> Vector3<f64>) -> TriangleMesh {
    let vertices = mesh.vertices().iter().map(|&p| place(p.into()).into());
    let triangles: Vec<_> = mesh.triangles().iter().map(|t| t.map(i64::from)).collect();
    TriangleMesh::new(vertices.collect(), &triangles).unwrap()
}

fn turned(displacement: &Array2<f64>, turn: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Array2<f64> {
    let mut turned = displacement.clone();
    for mut column in turned.columns_mut() {
        let vector = turn(Vector3::new(column[0], column[1], column[2]));
        (0..3).for_each(|axis| column[axis] = vector[axis]);
    }
    turned
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn below_the_safe_gain_nothing_folds_and_at_it_something_nearly_does(
        mesh in mesh(), values in displacement(), share in 0.0..1.0_f64, stretch in 1.1..4.0_f64
    ) {
        let displacement = on(&mesh, &values);
        let gain = folds(&mesh, displacement.view(), stretch).unwrap().safe_gain;
        prop_assert!(gain > 0.0 && gain.is_finite());
        let below = folds(&mesh, (share * gain * &displacement).view(), stretch).unwrap();
        prop_assert!(below.flipped.is_empty() && below.stretched.is_empty());
        prop_assert!(below.largest_stretch <= stretch);
        let at = folds(&mesh, (gain * &displacement).view(), stretch).unwrap();
        prop_assert!((at.safe_gain - 1.0).abs() < 1e-9);
    }

    #[test]
    fn safe_displacements_are_safe_shares(
        mesh in mesh(), values in displacement(), stretch in 1.1..4.0_f64
    ) {
        let displacement = on(&mesh, &values);
        let safe = safe_displacement(&mesh, displacement.view(), stretch).unwrap();
        let found = folds(&mesh, safe.displacement.view(), stretch).unwrap();
        prop_assert!(found.safe_gain >= 1.0);
        prop_assert!(found.flipped.is_empty() && found.stretched.is_empty());
        for (v, &share) in safe.shares.iter().enumerate() {
            prop_assert!((0.0..=1.0).contains(&share));
            for axis in 0..3 {
                prop_assert_eq!(safe.displacement[[axis, v]], share * displacement[[axis, v]]);
            }
        }
        let again = safe_displacement(&mesh, safe.displacement.view(), stretch).unwrap();
        prop_assert_eq!(again.displacement, safe.displacement);
    }

    #[test]
    fn size_and_place_make_no_difference(
        mesh in mesh(), values in displacement(), exponent in -6..6_i32,
        axis in prop::array::uniform3(-3.0..3.0_f64), away in prop::array::uniform3(-9.0..9.0_f64)
    ) {
        let displacement = on(&mesh, &values);
        let size = 10.0_f64.powi(exponent);
        let rotation = Rotation3::new(Vector3::from(axis));
        let moved = placed(&mesh, |p| size * (rotation * p + Vector3::from(away)));
        let carried = turned(&displacement, |d| size * (rotation * d));
        let expected = folds(&mesh, displacement.view(), DEFAULT_STRETCH).unwrap();
        let found = folds(&moved, carried.view(), DEFAULT_STRETCH).unwrap();
        prop_assert_eq!(&found.flipped, &expected.flipped);
        prop_assert_eq!(&found.stretched, &expected.stretched);
        prop_assert!((found.safe_gain / expected.safe_gain - 1.0).abs() < 1e-9);
        prop_assert!((found.largest_stretch / expected.largest_stretch - 1.0).abs() < 1e-9);
        let crossing = self_intersections(&mesh, Some(displacement.view())).unwrap();
        let carried = self_intersections(&moved, Some(carried.view())).unwrap();
        prop_assert_eq!(carried, crossing);
    }

    #[test]
    fn crossing_faces_are_those_of_the_displaced_mesh(mesh in mesh(), values in displacement()) {
        let displacement = on(&mesh, &values);
        let column = |v: usize| Vector3::from_fn(|axis, _| displacement[[axis, v]]);
        let vertices = mesh.vertices().iter().enumerate();
        let vertices = vertices.map(|(v, &p)| (Vector3::from(p) + column(v)).into());
        let triangles: Vec<_> = mesh.triangles().iter().map(|t| t.map(i64::from)).collect();
        let displaced = TriangleMesh::new(vertices.collect(), &triangles).unwrap();
        prop_assert_eq!(
            self_intersections(&mesh, Some(displacement.view())).unwrap(),
            self_intersections(&displaced, None).unwrap()
        );
        // Its faces the other way round, and in another order.
        let count = triangles.len();
        let reversed: Vec<_> = triangles.iter().rev().map(|&[a, b, c]| [b, a, c]).collect();
        let other = TriangleMesh::new(displaced.vertices().to_vec(), &reversed).unwrap();
        let mut found = self_intersections(&other, None).unwrap();
        found.iter_mut().for_each(|face| *face = count - 1 - *face);
        found.reverse();
        prop_assert_eq!(found, self_intersections(&displaced, None).unwrap());
    }
}
