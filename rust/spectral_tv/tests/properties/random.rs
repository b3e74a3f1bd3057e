//! Meshes, functions and settings made at random.

use ndarray::Array2;
use proptest::prelude::*;

use spectral_tv::Named;
use spectral_tv::flow::{Scheme, Stepping};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::method::{Method, Settings};
use spectral_tv::solver::Solver;

use crate::{GAP, STEPS};

/// A torus of 6 by 9 vertices or an open sheet of 7 by 7, its vertices moved at random.
pub fn mesh() -> impl Strategy<Value = TriangleMesh> {
    let noise = prop::collection::vec(-0.2..0.2_f64, 3 * 54);
    (any::<bool>(), noise).prop_map(|(is_closed, noise)| {
        let (rows, columns) = if is_closed { (6, 9) } else { (7, 7) };
        let vertices = (0..rows * columns).map(|v| {
            let (row, column) = ((v / columns) as f64, (v % columns) as f64);
            let place = match is_closed {
                true => {
                    let (sin, cos) = (std::f64::consts::TAU * row / 6.0).sin_cos();
                    let turn = std::f64::consts::TAU * column / 9.0;
                    let radius = 2.0 + cos;
                    [radius * turn.cos(), radius * turn.sin(), sin]
                }
                false => [column, row, 0.0],
            };
            std::array::from_fn(|axis| place[axis] + noise[3 * v + axis])
        });
        let lacking = usize::from(!is_closed);
        let triangles = (0..rows - lacking).flat_map(|row| {
            (0..columns - lacking).flat_map(move |column| {
                let at = |r: usize, c: usize| ((r % rows) * columns + c % columns) as i64;
                let (a, b) = (at(row, column), at(row, column + 1));
                let (c, d) = (at(row + 1, column + 1), at(row + 1, column));
                [[a, b, c], [a, c, d]]
            })
        });
        TriangleMesh::new(vertices.collect(), &triangles.collect::<Vec<_>>()).unwrap()
    })
}

/// A function with 1 to 3 channels on any of the meshes; only the first V values count.
pub fn values() -> impl Strategy<Value = Vec<Vec<f64>>> {
    prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, 54), 1..=3)
}

pub fn on(mesh: &TriangleMesh, values: &[Vec<f64>]) -> Array2<f64> {
    Array2::from_shape_fn((values.len(), mesh.vertex_count()), |(c, v)| values[c][v])
}

pub fn stepping() -> impl Strategy<Value = Stepping> {
    let schemes = prop::sample::select(vec![Scheme::Lagged, Scheme::Extrapolated, Scheme::Exact]);
    let solvers = prop::sample::select(vec![Solver::Cholesky, Solver::Single, Solver::Multigrid]);
    (schemes, solvers).prop_map(|(scheme, solver)| Stepping {
        scheme,
        tolerance: GAP,
        solver,
    })
}

/// The settings of any method, with steps as by default.
pub fn settings() -> impl Strategy<Value = Settings> {
    let methods = prop::sample::select(Method::NAMES);
    (methods, 1..=3_u32).prop_map(|((method, _), p)| {
        let mut settings = Settings {
            steps: STEPS,
            ..method.into()
        };
        match method {
            Method::ConformalLaplace => settings.p = p,
            Method::LaplaceBeltrami => settings.eigenpairs = 12,
            _ => {}
        }
        settings
    })
}

/// The settings of methods that do not know where the axes are.
pub fn equivariant_settings() -> impl Strategy<Value = Settings> {
    settings().prop_filter("flows each axis alone", |settings| {
        settings.method != Method::Naive
    })
}
