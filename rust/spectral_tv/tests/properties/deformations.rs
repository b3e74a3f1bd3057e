//! Deformations.

use proptest::prelude::*;

use spectral_tv::Named;
use spectral_tv::deformation::{self, Algorithm, Constraints, Deformation, deform};
use spectral_tv::mesh::TriangleMesh;

use crate::random::mesh;
use crate::{GAP, config};

/// The shape with vertices 0 and 1 held and 40 pulled.
fn bent(mesh: &TriangleMesh, pull: [f64; 3], algorithm: Algorithm) -> Deformation {
    let constraints = Constraints::new(mesh, &[0, 1, 40], None).unwrap();
    let mut targets = [0, 1, 40].map(|v: usize| mesh.vertices()[v]);
    (0..3).for_each(|axis| targets[2][axis] += pull[axis]);
    let settings = deformation::Settings {
        algorithm,
        softness: 0.0,
        tolerance: GAP,
    };
    deform(mesh, constraints, &targets, settings).unwrap()
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn no_deformation_stretches_less_than_the_convex_one(
        mesh in mesh(), pull in prop::array::uniform3(-3.0..3.0_f64),
        (algorithm, _) in prop::sample::select(Algorithm::NAMES)
    ) {
        let least = bent(&mesh, pull, Algorithm::Convex);
        let other = bent(&mesh, pull, algorithm);
        prop_assert!((1.0 - GAP) * least.total_variation <= other.total_variation * (1.0 + 1e-9));
        // Both certificates bound the same optimum from below.
        let bound = |bent: &Deformation| (1.0 - bent.gap) * bent.total_variation;
        prop_assert!(bound(&other) <= least.total_variation * (1.0 + 1e-9));
        let error = (0..3).map(|axis| (least.displacement[[axis, 40]] - pull[axis]).abs());
        prop_assert!(error.fold(0.0, f64::max) < 1e-12);
    }

    #[test]
    fn deformations_grow_with_the_pull(
        mesh in mesh(), pull in prop::array::uniform3(-3.0..3.0_f64), factor in 0.01..50.0_f64
    ) {
        let plain = bent(&mesh, pull, Algorithm::Convex).total_variation;
        let scaled = bent(&mesh, pull.map(|x| factor * x), Algorithm::Convex).total_variation;
        prop_assert!((scaled - factor * plain).abs() <= 1e-5 * scaled);
    }
}
