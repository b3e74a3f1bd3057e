//! Bands, filters and what moves with a shape.

use nalgebra::{Rotation3, Vector3};
use ndarray::{Array2, Axis};
use proptest::prelude::*;

use spectral_tv::flow::{Scheme, Stepping};
use spectral_tv::image::{self, Image, decompose_image};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::method::{Decomposition, Settings, decompose};
use spectral_tv::operators::positions;
use spectral_tv::solver::Solver;
use spectral_tv::spectral::even_edges;

use crate::random::{equivariant_settings, mesh, settings, stepping};
use crate::{STEPS, config, distance};

/// A decomposition in steps of some kind, or as by default where the method has none of that kind.
pub fn split(mesh: &TriangleMesh, settings: &Settings, stepping: Stepping) -> Decomposition {
    let facts = settings.method.facts();
    let scheme = match stepping.scheme {
        Scheme::Exact if !facts.has_exact_steps() => Scheme::default(),
        scheme if facts.takes_steps() => scheme,
        _ => Scheme::default(),
    };
    let stepping = Stepping { scheme, ..stepping };
    decompose(
        mesh,
        &Settings {
            stepping,
            ..settings.clone()
        },
    )
    .unwrap()
}

/// The paper's steps.
fn lagged(solver: Solver) -> Stepping {
    Stepping {
        scheme: Scheme::Lagged,
        solver,
        ..Stepping::default()
    }
}

fn moved(mesh: &TriangleMesh, place: impl Fn(Vector3<f64>) -> Vector3<f64>) -> TriangleMesh {
    let vertices = mesh.vertices().iter().map(|&p| place(p.into()).into());
    let triangles: Vec<_> = mesh.triangles().iter().map(|t| t.map(i64::from)).collect();
    TriangleMesh::new(vertices.collect(), &triangles).unwrap()
}

fn turned(shape: &Array2<f64>, place: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Array2<f64> {
    let mut turned = shape.clone();
    for mut column in turned.axis_iter_mut(Axis(1)) {
        let point = place(Vector3::new(column[0], column[1], column[2]));
        (0..3).for_each(|axis| column[axis] = point[axis]);
    }
    turned
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn components_and_residual_are_the_shape(
        mesh in mesh(), settings in settings(), stepping in stepping(), count in 1..STEPS
    ) {
        let split = split(&mesh, &settings, stepping);
        let components = split.component_times().len();
        let edges = even_edges(split.times(), count.min(components)).unwrap();
        let bands = split.bands(&edges).unwrap();
        let sum = bands.fold(split.residual(), |sum, band| sum + band);
        prop_assert!(distance(&sum, &positions(&mesh)) < 1e-12);
        let whole = split.filter(&vec![1.0; components]).unwrap();
        prop_assert!(distance(&whole, &positions(&mesh)) < 1e-12);
    }

    #[test]
    fn filters_are_linear_in_their_gains(
        mesh in mesh(), settings in settings(), gains in prop::collection::vec(-3.0..3.0_f64, 2 * STEPS)
    ) {
        let split = split(&mesh, &settings, lagged(Solver::Auto));
        let count = split.component_times().len();
        let (a, b) = (&gains[..count], &gains[STEPS..STEPS + count]);
        let sum: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + b).collect();
        let filtered = |gains: &[f64]| split.filter(gains).unwrap() - split.residual();
        prop_assert!(distance(&(filtered(a) + filtered(b)), &filtered(&sum)) < 1e-10);
    }

    #[test]
    fn solvers_agree(mesh in mesh(), settings in settings()) {
        let direct = split(&mesh, &settings, lagged(Solver::Cholesky));
        let iterative = split(&mesh, &settings, lagged(Solver::Multigrid));
        let last = |split: &Decomposition| split.filter(&vec![0.0; split.component_times().len()]);
        let error = distance(&last(&direct).unwrap(), &last(&iterative).unwrap());
        prop_assert!(error < 1e-4, "{error:e}");
    }

    #[test]
    fn shapes_turn_move_and_grow_with_their_bands(
        mesh in mesh(), settings in equivariant_settings(), turn in prop::array::uniform3(-3.0..3.0_f64),
        shift in prop::array::uniform3(-9.0..9.0_f64), size in 1e-3..1e3_f64
    ) {
        let rotation = Rotation3::from_scaled_axis(Vector3::from(turn));
        let plain = split(&mesh, &settings, lagged(Solver::Cholesky));
        let other = moved(&mesh, |p| size * (rotation * p + Vector3::from(shift)));
        let other = split(&other, &settings, lagged(Solver::Cholesky));
        for (time, scaled) in plain.times().iter().zip(other.times()) {
            prop_assert!((scaled - size * size * time).abs() <= 1e-9 * scaled);
        }
        let edges = |split: &Decomposition| even_edges(split.times(), 1).unwrap();
        let band = plain.bands(&edges(&plain)).unwrap().next().unwrap();
        let other = other.bands(&edges(&other)).unwrap().next().unwrap() / size;
        let error = distance(&turned(&band, |d| rotation * d), &other);
        prop_assert!(error < 1e-5, "{error:e}");
    }

    #[test]
    fn images_turn_with_their_components(
        pixels in prop::collection::vec(0.0..1.0_f64, 30), stepping in stepping(), height in 0.5..20.0_f64,
        is_flat in any::<bool>()
    ) {
        let values = Array2::from_shape_vec((1, 30), pixels).unwrap();
        let across = Array2::from_shape_fn((1, 30), |(_, p)| values[[0, (p % 5) * 6 + p / 5]]);
        let end = |values: Array2<f64>, rows: usize| {
            let image = Image { values, rows, columns: 30 / rows };
            let metric = match is_flat {
                true => image::Metric::Flat,
                false => image::Metric::Surface,
            };
            let stepping = Stepping { solver: Solver::Cholesky, ..stepping };
            let settings = image::Settings { metric, height, times: None, steps: STEPS, stepping };
            let (flow, areas) = decompose_image(&image, &settings).unwrap();
            (flow.states().last().unwrap(), areas)
        };
        let ((plain, areas), (turned, other)) = (end(values, 5), end(across, 6));
        let at = |p: usize| (p % 5) * 6 + p / 5;
        for p in 0..30 {
            prop_assert!((plain[[0, at(p)]] - turned[[0, p]]).abs() < 5e-3);
            prop_assert!((areas[at(p)] - other[p]).abs() < 1e-9 * areas[at(p)]);
        }
    }
}
