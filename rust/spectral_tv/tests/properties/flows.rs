//! Flows of functions, and eigenfunctions.

use ndarray::Array2;
use proptest::prelude::*;

use spectral_tv::discretization::{Discretization, Elements};
use spectral_tv::flow::{Eigenpairs, Operator, Scheme, Stepping, Trajectory, flow as flow_of};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::method::graded_times;
use spectral_tv::spectral::SpectralTransform;

use crate::random::{mesh, on, stepping, values};
use crate::{GAP, STEPS, config, distance};

/// The TV flow up to about the extinction of functions of the size of 1.
fn flow(mesh: &TriangleMesh, values: &Array2<f64>, stepping: Stepping) -> Trajectory {
    flow_on(Elements::Vertices, mesh, values, stepping)
}

fn flow_on(
    elements: Elements,
    mesh: &TriangleMesh,
    values: &Array2<f64>,
    stepping: Stepping,
) -> Trajectory {
    let times = graded_times(1e-3, 1.0, STEPS).unwrap();
    let (values, law) = (values.clone(), Operator::TotalVariation);
    flow_of(mesh, values, &times, law, elements, stepping).unwrap()
}

/// The elements that such steps can be taken on.
fn elements(stepping: Stepping) -> Vec<Elements> {
    match stepping.scheme {
        Scheme::Exact => vec![Elements::Vertices, Elements::Edges],
        _ => vec![Elements::Vertices],
    }
}

/// ‖u‖ over the surface.
fn norm(values: &Array2<f64>, masses: &[f64]) -> f64 {
    let squares = |row: ndarray::ArrayView1<f64>| {
        let terms = row
            .iter()
            .zip(masses)
            .map(|(value, mass)| mass * value * value);
        terms.sum::<f64>()
    };
    values.rows().into_iter().map(squares).sum::<f64>().sqrt()
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn total_variation_never_grows(
        mesh in mesh(), values in values(), stepping in stepping()
    ) {
        for elements in elements(stepping) {
            let flow = flow_on(elements, &mesh, &on(&mesh, &values), stepping);
            let start = flow.total_variation[0];
            for pair in flow.total_variation.windows(2) {
                prop_assert!(pair[1] <= pair[0] + 1e-5 * start, "{:?}", flow.total_variation);
            }
        }
    }

    #[test]
    fn the_mean_is_kept(
        mesh in mesh(), values in values(), stepping in stepping()
    ) {
        for elements in elements(stepping) {
            let flow = flow_on(elements, &mesh, &on(&mesh, &values), stepping);
            let ones = vec![1.0; mesh.vertex_count()];
            let means = flow.mean(&ones, mesh.vertex_areas()).unwrap();
            for row in means.rows() {
                for (mean, first) in row.iter().zip(means.row(0)) {
                    prop_assert!((mean - first).abs() < 1e-5, "{means}");
                }
            }
        }
    }

    #[test]
    fn scaling_a_function_scales_its_time(
        mesh in mesh(), values in values(), stepping in stepping(), factor in prop_oneof![-4.0..-0.1_f64, 0.1..4.0_f64]
    ) {
        let values = on(&mesh, &values);
        let run = |factor: f64| {
            let times: Vec<f64> = [0.0, 0.02, 0.05, 0.2].map(|t| factor.abs() * t).into();
            let law = Operator::TotalVariation;
            flow_of(&mesh, factor * &values, &times, law, Elements::Vertices, stepping).unwrap()
        };
        let (flow, scaled) = (run(1.0), run(factor));
        for (state, scaled) in flow.states().zip(scaled.states()) {
            // As near as two solutions to the same gap are.
            prop_assert!(distance(&(factor * state), &scaled) < 2e-2 * factor.abs());
        }
    }

    #[test]
    fn exact_steps_bring_functions_nearer_to_each_other(
        mesh in mesh(), (one, other) in (values(), values())
    ) {
        let channels = one.len().min(other.len());
        let (one, other) = (on(&mesh, &one[..channels]), on(&mesh, &other[..channels]));
        let operators = Discretization::new(&mesh).unwrap();
        let times = [0.0, 0.05, 0.2, 0.5];
        let exact = Stepping { scheme: Scheme::Exact, tolerance: GAP, ..Stepping::default() };
        let run = |values: &Array2<f64>| {
            let (values, law) = (values.clone(), Operator::TotalVariation);
            flow_of(&mesh, values, &times, law, Elements::Vertices, exact).unwrap()
        };
        let (first, second) = (run(&one), run(&other));
        // A gap of g moves the minimiser of ½‖u − f‖² + Δt TV(u) by at most √(2 g).
        let gap = |flow: &Trajectory| (2.0 * GAP * 0.3 * flow.total_variation[0]).sqrt();
        let slack = 1e-9 + gap(&first) + gap(&second);
        let pairs = first.states().zip(second.states());
        let apart: Vec<f64> = pairs.map(|(a, b)| norm(&(a - b), operators.masses())).collect();
        for pair in apart.windows(2) {
            prop_assert!(pair[1] <= pair[0] + slack, "{apart:?}");
        }
    }

    #[test]
    fn spectral_components_of_shifted_functions_are_the_same(
        mesh in mesh(), values in values(), shift in -5.0..5.0_f64
    ) {
        let values = on(&mesh, &values);
        let stepping = Stepping::default();
        let transform =
            |values: &Array2<f64>| SpectralTransform::new(flow(&mesh, values, stepping));
        let (plain, shifted) = (transform(&values), transform(&(&values + shift)));
        for k in 0..plain.component_times().len() {
            prop_assert!(distance(&plain.component(k), &shifted.component(k)) < 1e-6);
        }
        prop_assert!(distance(&(plain.residual() + shift), &shifted.residual()) < 1e-6);
    }

    #[test]
    fn eigenpairs_are_orthonormal_and_ordered(mesh in mesh(), count in 1..20_usize) {
        let operators = Discretization::new(&mesh).unwrap();
        let pairs = Eigenpairs::lowest(&mesh, &operators, count).unwrap();
        prop_assert_eq!(pairs.eigenvalues.len(), count);
        prop_assert!(pairs.eigenvalues.is_sorted());
        prop_assert!(pairs.eigenvalues[0].abs() < 1e-9);
        let functions = &pairs.eigenfunctions;
        let masses = ndarray::aview1(operators.masses());
        let products = (functions * &masses).dot(&functions.t());
        prop_assert!(distance(&products, &Array2::eye(count)) < 1e-8);
    }
}
