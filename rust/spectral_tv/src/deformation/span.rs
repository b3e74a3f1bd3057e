//! The directions that the targets of a deformation span, often a single one.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use ndarray::Array2;

use crate::deformation::constraints::Targets;

/// Extents below this, relative to the largest, are rounding.
const FLAT: f64 = 1e-9;

/// The affine space that the displacements asked for span, with orthonormal axes.
///
/// A displacement of least energy lies in it, as its other components only add to |∇d|. Where
/// one handle is shifted the problem is then that of a scalar, whose Newton systems can be
/// factorized themselves.
pub(super) struct Span {
    centre: Vector3<f64>,
    axes: Vec<Vector3<f64>>,
}

impl Span {
    /// The span of what is asked for at the vertices that `is_asked` holds for.
    pub fn new(targets: &Targets, is_asked: impl Fn(usize) -> bool) -> Self {
        let centre = Vector3::from(targets.centre);
        let asked: Vec<Vector3<f64>> = (0..targets.displacements.ncols())
            .filter(|&vertex| is_asked(vertex))
            .map(|vertex| column(&targets.displacements, vertex) - centre)
            .collect();
        let covariance: Matrix3<f64> = asked.iter().map(|offset| offset * offset.transpose()).sum();
        let eigen = SymmetricEigen::new(covariance);
        let mut axes: Vec<(f64, Vector3<f64>)> = (0..3)
            .map(|index| {
                let axis: Vector3<f64> = eigen.eigenvectors.column(index).into();
                let extents = asked.iter().map(|offset| offset.dot(&axis).abs());
                (extents.fold(0.0, f64::max), axis)
            })
            .collect();
        axes.sort_by(|a, b| b.0.total_cmp(&a.0));
        let largest = axes[0].0;
        axes.retain(|&(extent, _)| extent >= FLAT * largest);
        Self {
            centre,
            axes: axes.into_iter().map(|(_, axis)| axis).collect(),
        }
    }

    /// The targets in the coordinates of the span.
    pub fn reduced(&self, targets: &Targets) -> Targets {
        Targets {
            displacements: self.coordinates(&targets.displacements),
            springs: targets.springs.clone(),
            centre: [0.0; 3],
            radius: targets.radius,
        }
    }

    /// Displacements (3, V) in the coordinates of the span, (C, V).
    pub fn coordinates(&self, displacements: &Array2<f64>) -> Array2<f64> {
        let shape = (self.axes.len(), displacements.ncols());
        Array2::from_shape_fn(shape, |(axis, vertex)| {
            self.axes[axis].dot(&(column(displacements, vertex) - self.centre))
        })
    }

    /// The displacements (3, V) of `coordinates` (C, V).
    pub fn displacements(&self, coordinates: &Array2<f64>) -> Array2<f64> {
        Array2::from_shape_fn((3, coordinates.ncols()), |(component, vertex)| {
            let along = self.axes.iter().zip(coordinates.column(vertex));
            self.centre[component] + along.map(|(axis, x)| axis[component] * x).sum::<f64>()
        })
    }
}

fn column(values: &Array2<f64>, vertex: usize) -> Vector3<f64> {
    Vector3::new(
        values[[0, vertex]],
        values[[1, vertex]],
        values[[2, vertex]],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn targets(displacements: &[[f64; 3]], centre: [f64; 3]) -> Targets {
        Targets {
            displacements: Array2::from_shape_fn((3, displacements.len()), |(axis, vertex)| {
                displacements[vertex][axis]
            }),
            springs: vec![0.0; displacements.len()],
            centre,
            radius: 1.0,
        }
    }

    #[test]
    fn its_coordinates_are_as_many_as_the_directions_and_keep_distances() {
        let cases = [
            (vec![[0.0; 3], [1.0, 2.0, -2.0]], [0.5, 1.0, -1.0], 1),
            (
                vec![[0.0; 3], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]],
                [0.0; 3],
                2,
            ),
            (
                vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]],
                [0.1; 3],
                3,
            ),
        ];
        for (asked, centre, rank) in cases {
            let targets = targets(&asked, centre);
            let span = Span::new(&targets, |_| true);
            let coordinates = span.coordinates(&targets.displacements);
            assert_eq!(coordinates.nrows(), rank);
            let back = span.displacements(&coordinates);
            for (value, expected) in back.iter().zip(&targets.displacements) {
                assert!((value - expected).abs() < 1e-14);
            }
        }
    }
}
