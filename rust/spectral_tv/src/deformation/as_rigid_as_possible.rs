//! As-rigid-as-possible deformation, for comparison (Sorkine and Alexa 2007, "As-Rigid-As-Possible
//! Surface Modeling").
//!
//! The energy is that of Chao et al. 2010, "A Simple Geometric Model for Elastic Deformations"
//! ("spokes and rims"). It stays positive with obtuse triangles.

use nalgebra::{Matrix3, Rotation3, Vector3};
use ndarray::Array2;

use crate::deformation::problem::{Problem, Task};
use crate::deformation::quadratic::{Quadratic, Stiffness, dirichlet_springs, harmonic};
use crate::deformation::rotation::nearest_rotation;
use crate::error::Result;
use crate::operators::{element_stiffness, positions};

const MOST_ITERATIONS: usize = 200;

/// Alternates between the rotations that fit the neighbourhood of every vertex best and the
/// positions that fit these rotations best, from the harmonic deformation, until no vertex moves
/// by more than the tolerance of the spread of the displacements. Returns d (3, V) and the number
/// of iterations.
pub(super) fn as_rigid_as_possible(task: Task) -> Result<(Array2<f64>, usize)> {
    let (problem, stage) = (task.problem, task.stage);
    let positions = &positions(task.mesh);
    let weights = vec![1.0; problem.operators.gradient().face_areas().len()];
    let stiffness = Stiffness::membrane(&problem, &weights);
    let curvature = stiffness.apply(positions);
    let springs = dirichlet_springs(&problem);
    let mut quadratic = Quadratic::new(problem, stiffness, springs, stage)?;
    let (mut state, _) = harmonic(task)?;
    let mut rotations = vec![Rotation3::identity(); positions.ncols()];
    for iteration in 0..MOST_ITERATIONS {
        stage.report(iteration as f64 / MOST_ITERATIONS as f64)?;
        fit_rotations(&problem, positions, &state, &mut rotations);
        let last = state.clone();
        quadratic.minimise(
            &mut state,
            &(rotated(&problem, positions, &rotations) - &curvature),
        );
        let moved = (&state - &last)
            .iter()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        if moved <= task.tolerance * problem.targets.spread() {
            return Ok((state, iteration + 1));
        }
    }
    Ok((state, MOST_ITERATIONS))
}

/// The edges of a face: their corners and cotangent weights.
fn edges(problem: &Problem, face: usize) -> [(usize, usize, f64); 3] {
    let gradient = problem.operators.gradient();
    let [i, j, k] = gradient.triangles()[face].map(|corner| corner as usize);
    let [a, b, c] = element_stiffness(&gradient.hats(face), gradient.face_areas()[face]);
    [(j, k, -a), (k, i, -b), (i, j, -c)]
}

/// The rotation nearest to Σ w (p′_i − p′_j)(p_i − p_j)ᵀ over the edges of all faces around every
/// vertex.
fn fit_rotations(
    problem: &Problem,
    positions: &Array2<f64>,
    state: &Array2<f64>,
    rotations: &mut [Rotation3<f64>],
) {
    let triangles = problem.operators.gradient().triangles();
    let mut covariances = vec![Matrix3::zeros(); rotations.len()];
    let mut scales = vec![0.0; rotations.len()];
    for (face, corners) in triangles.iter().enumerate() {
        let mut covariance = Matrix3::zeros();
        let mut scale = 0.0;
        for (i, j, weight) in edges(problem, face) {
            let edge = difference(positions, i, j);
            covariance += (edge + difference(state, i, j)) * edge.transpose() * weight;
            scale += weight * edge.norm_squared();
        }
        for &corner in corners {
            covariances[corner as usize] += covariance;
            scales[corner as usize] += scale;
        }
    }
    for ((rotation, covariance), scale) in rotations.iter_mut().zip(covariances).zip(scales) {
        if scale > 0.0 {
            *rotation = nearest_rotation(covariance, rotation);
        }
    }
}

/// Σ w R (p_i − p_j) over the edges of all faces around every vertex i, R the mean of the
/// rotations at a face's corners, (3, V).
fn rotated(
    problem: &Problem,
    positions: &Array2<f64>,
    rotations: &[Rotation3<f64>],
) -> Array2<f64> {
    let mut forces = Array2::zeros(positions.dim());
    for (face, corners) in problem.operators.gradient().triangles().iter().enumerate() {
        let mut rotation = Matrix3::zeros();
        for &corner in corners {
            rotation += rotations[corner as usize].matrix() / 3.0;
        }
        for (i, j, weight) in edges(problem, face) {
            let force = rotation * difference(positions, i, j) * weight;
            for axis in 0..3 {
                forces[[axis, i]] += force[axis];
                forces[[axis, j]] -= force[axis];
            }
        }
    }
    forces
}

fn difference(values: &Array2<f64>, i: usize, j: usize) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| values[[axis, i]] - values[[axis, j]])
}
