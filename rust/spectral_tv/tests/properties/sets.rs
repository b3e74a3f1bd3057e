//! Segments, and sets of vertices.

use proptest::prelude::*;

use spectral_tv::eigenset::eigenset_test;
use spectral_tv::method::{Settings, decompose};
use spectral_tv::segmentation::cosegment;

use crate::random::mesh;
use crate::{STEPS, config};

proptest! {
    #![proptest_config(config())]

    #[test]
    fn segments_are_numbered_by_size(mesh in mesh(), segments in 1..8_usize, seed in any::<u64>()) {
        let settings = Settings { steps: STEPS, ..Settings::m2() };
        let split = decompose(&mesh, &settings).unwrap();
        let labels = cosegment(&[&split], segments, seed).unwrap();
        let mut areas = vec![0.0; segments];
        for (&label, area) in labels[0].iter().zip(mesh.vertex_areas()) {
            areas[label] += area;
        }
        prop_assert!(areas.is_sorted_by(|a, b| *a >= b - 1e-9), "{areas:?}");
    }

    #[test]
    fn a_set_and_its_complement_share_a_perimeter(mesh in mesh(), first in 1..30_usize) {
        let set: Vec<bool> = (0..mesh.vertex_count()).map(|v| v < first).collect();
        let complement: Vec<bool> = set.iter().map(|inside| !inside).collect();
        let test = |set: &[bool]| eigenset_test(&mesh, set).unwrap();
        let (one, other) = (test(&set), test(&complement));
        prop_assert!((one.perimeter - other.perimeter).abs() < 1e-6 * one.perimeter);
        prop_assert!((one.area + other.area - mesh.area()).abs() < 1e-9 * mesh.area());
        prop_assert!(one.superset.iter().zip(&set).all(|(outer, inner)| *outer || !inner));
    }
}
