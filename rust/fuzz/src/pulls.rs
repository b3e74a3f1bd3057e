//! What a deformation or a pose is held by, and where that goes.

use arbitrary::{Arbitrary, Result, Unstructured};
use ndarray::Array2;
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::operators::positions;

use crate::largest;
use crate::number::{numbers, point};

/// Some vertices, pulled anywhere.
#[derive(Debug, Arbitrary)]
pub struct Pulls {
    #[arbitrary(with = targets)]
    targets: Vec<(u8, [f64; 3])>,
    #[arbitrary(with = numbers)]
    weights: Vec<f64>,
}

fn targets(input: &mut Unstructured) -> Result<Vec<(u8, [f64; 3])>> {
    let count = input.int_in_range(0..=6)?;
    let mut one = || Ok((input.arbitrary()?, point(input)?));
    (0..count).map(|_| one()).collect()
}

impl Pulls {
    /// Indices mostly in range.
    pub fn indices(&self, mesh: &TriangleMesh) -> Vec<i64> {
        let count = mesh.vertex_count() as i64;
        let index = |index: u8| match index {
            255 => count,
            index => i64::from(index) % count,
        };
        self.targets.iter().map(|(v, _)| index(*v)).collect()
    }

    pub fn weights(&self) -> Vec<f64> {
        let given = self.weights.iter().copied();
        given
            .chain(std::iter::repeat(1.0))
            .take(self.targets.len())
            .collect()
    }

    /// The displacements asked for, times `share`.
    pub fn positions(&self, mesh: &TriangleMesh, share: f64) -> Vec<[f64; 3]> {
        let pulled = self.indices(mesh).into_iter().zip(&self.targets);
        let place = |(index, (_, target)): (i64, &(u8, [f64; 3]))| {
            let start = mesh.vertices()[index as usize];
            std::array::from_fn(|axis| start[axis] + share * (target[axis] - start[axis]))
        };
        pulled.map(place).collect()
    }

    /// That exact targets are met by those of which `is_exact` holds.
    pub fn assert_met(
        &self,
        mesh: &TriangleMesh,
        targets: &[[f64; 3]],
        displacement: &Array2<f64>,
        is_exact: impl Fn(usize) -> bool,
    ) {
        let start = positions(mesh);
        let shape: Array2<f64> = &start + displacement;
        let weights = self.weights();
        let size = largest(&start).max(largest(targets.iter().flatten()));
        let entries = self.indices(mesh).into_iter().zip(targets).zip(weights);
        for (entry, ((index, target), weight)) in entries.enumerate() {
            if weight == 1.0 && is_exact(entry) {
                let place = shape.column(index as usize);
                let error = (0..3).map(|axis| (place[axis] - target[axis]).abs());
                let error = error.fold(0.0, f64::max);
                assert!(error <= 1e-8 * size, "a target is missed by {error:e}");
            }
        }
    }
}
