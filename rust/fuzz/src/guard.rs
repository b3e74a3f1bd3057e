//! Folds, clamped displacements and faces that cross.

use arbitrary::Arbitrary;
use ndarray::Array2;
use spectral_tv::guard::{folds, safe_displacement, self_intersections};
use spectral_tv::mesh::TriangleMesh;

use crate::number::{number, numbers};
use crate::{assert_finite, unless_refused};

/// A displacement.
#[derive(Debug, Arbitrary)]
pub struct Shift {
    /// Its coordinates, repeated.
    #[arbitrary(with = numbers)]
    values: Vec<f64>,
    #[arbitrary(with = number)]
    stretch: f64,
}

impl Shift {
    pub fn run(&self, mesh: &TriangleMesh) {
        let count = mesh.vertex_count();
        let value = |k: usize| self.values.get(k % self.values.len().max(1)).copied();
        let displacement = Array2::from_shape_fn((3, count), |(axis, v)| {
            value(3 * v + axis).unwrap_or_default()
        });
        if let Some(crossing) = unless_refused(self_intersections(mesh, Some(displacement.view())))
        {
            assert!(crossing.is_sorted() && crossing.iter().all(|&f| f < mesh.triangles().len()));
        }
        let Some(found) = unless_refused(folds(mesh, displacement.view(), self.stretch)) else {
            return;
        };
        assert!(found.safe_gain > 0.0 && found.largest_stretch.is_finite());
        let outcome = safe_displacement(mesh, displacement.view(), self.stretch);
        let Some(safe) = unless_refused(outcome) else {
            return;
        };
        assert_finite("displacement", &safe.displacement);
        assert!((0.0..=1.0 + 1e-12).contains(&safe.kept));
        let after = folds(mesh, safe.displacement.view(), self.stretch).expect("it is finite");
        assert!(after.safe_gain >= 1.0 && after.flipped.is_empty() && after.stretched.is_empty());
    }
}
