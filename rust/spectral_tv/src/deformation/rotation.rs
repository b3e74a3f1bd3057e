//! The rotation that best fits given vectors to others.

use nalgebra::{Matrix3, Matrix4, Quaternion, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};

/// How much the rotation that is known counts: where only a line or a point is to be turned, it
/// decides.
const INERTIA: f64 = 1e-9;
/// A handful is what it takes.
const MOST_ITERATIONS: usize = 1000;

/// The R of largest tr(Rᵀ m), for m = Σ a′ aᵀ over arms a to be turned to a′, and of those the
/// one nearest to `known`: as a quaternion, the eigenvector of the largest eigenvalue of a
/// symmetric matrix (Horn 1987, "Closed-form solution of absolute orientation using unit
/// quaternions"). Unlike an iteration on rotations it ends whatever the rank of m.
pub(crate) fn nearest_rotation(covariance: Matrix3<f64>, known: &Rotation3<f64>) -> Rotation3<f64> {
    let size = covariance.amax().max(f64::MIN_POSITIVE);
    let m = covariance / size + known.matrix() * INERTIA;
    let trace = m.trace();
    let twist = Vector3::new(
        m[(2, 1)] - m[(1, 2)],
        m[(0, 2)] - m[(2, 0)],
        m[(1, 0)] - m[(0, 1)],
    );
    let block = m + m.transpose() - Matrix3::identity() * trace;
    let symmetric = Matrix4::from_fn(|i, j| match (i, j) {
        (0, 0) => trace,
        (0, axis) | (axis, 0) => twist[axis - 1],
        (i, j) => block[(i - 1, j - 1)],
    });
    let Some(eigen) = SymmetricEigen::try_new(symmetric, f64::EPSILON, MOST_ITERATIONS) else {
        return *known;
    };
    let largest = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    let quaternion = Quaternion::new(largest[0], largest[1], largest[2], largest[3]);
    UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_found_whatever_the_rank_and_the_size() {
        let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.8);
        let none = Rotation3::identity();
        let stretch = Matrix3::new(2.0, 0.3, 0.1, 0.3, 1.0, -0.2, 0.1, -0.2, 0.7);
        for size in [1e-100, 1.0, 1e100] {
            let found = nearest_rotation(turn.matrix() * stretch * size, &none);
            assert!((found.matrix() - turn.matrix()).norm() < 1e-8);
            // Of rank one: what it does to the first axis is all that is asked.
            let line = turn.matrix() * Matrix3::from_diagonal(&Vector3::x()) * size;
            let found = nearest_rotation(line, &none);
            assert!((found.matrix().column(0) - turn.matrix().column(0)).norm() < 1e-8);
        }
        let last = nearest_rotation(Matrix3::zeros(), &turn);
        assert!((last.matrix() - turn.matrix()).norm() < 1e-12);
    }
}
