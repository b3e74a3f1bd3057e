//! Segments and eigensets.

use arbitrary::Arbitrary;
use spectral_tv::eigenset::eigenset_test;
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::method::decompose;
use spectral_tv::segmentation::cosegment;

use crate::scales::Recipe;
use crate::{assert_finite, unless_refused};

/// Segments of a mesh and itself.
#[derive(Debug, Arbitrary)]
pub struct Cosegment {
    recipe: Option<Recipe>,
    segments: u8,
    seed: u64,
}

impl Cosegment {
    pub fn run(&self, mesh: &TriangleMesh) {
        let plain = Recipe::of_segments();
        let settings = self.recipe.as_ref().unwrap_or(&plain).settings(mesh);
        let Some(split) = unless_refused(decompose(mesh, &settings)) else {
            return;
        };
        let segments = usize::from(self.segments % 16);
        let outcome = cosegment(&[&split, &split], segments, self.seed);
        let Some(labels) = unless_refused(outcome) else {
            return;
        };
        assert_eq!(labels.len(), 2);
        assert_eq!(labels[0], labels[1]);
        assert_eq!(labels[0].len(), mesh.vertex_count());
        assert!(labels[0].iter().all(|&label| label < segments));
    }
}

/// A set, tested for being an eigenset.
#[derive(Debug, Arbitrary)]
pub struct Set {
    /// One bit a vertex, repeated.
    members: u64,
}

impl Set {
    pub fn run(&self, mesh: &TriangleMesh) {
        let is_member = |v: usize| self.members >> (v % 64) & 1 == 1;
        let set: Vec<bool> = (0..mesh.vertex_count()).map(is_member).collect();
        let Some(test) = unless_refused(eigenset_test(mesh, &set)) else {
            return;
        };
        assert_finite("values", &test.values);
        let numbers = [test.area, test.perimeter, test.rate, test.spread];
        assert_finite("area, perimeter, rate and spread", &numbers);
        assert!(test.area > 0.0);
        assert_eq!(test.superset.len(), set.len());
    }
}
