//! What the mathematics promises, for meshes, functions and settings made at random.
//!
//! A few cases each, always the same; `PROPTEST_CASES=5000` tries as many, new ones every time.

use nalgebra::{Rotation3, Vector3};
use ndarray::{Array2, Axis};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use spectral_tv::deformation::{self, Algorithm, Constraints, Deformation, deform};
use spectral_tv::eigenset::eigenset_test;
use spectral_tv::flow::{Eigenpairs, TotalVariation, Trajectory, Weights, proximal_flow};
use spectral_tv::image::{self, Image, decompose_image};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::method::{
    Base, Decomposition, Method, Metric, Scheme, Settings, Steps, decompose, graded_times, run_flow,
};
use spectral_tv::monitor::Monitor;
use spectral_tv::operators::{Discretization, positions};
use spectral_tv::segmentation::cosegment;
use spectral_tv::solver::Solver;
use spectral_tv::spectral::{SpectralTransform, even_edges};

/// Gap of exact steps, relative to Δt TV.
const GAP: f64 = 1e-6;
const STEPS: usize = 6;

fn config() -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").ok();
    let cases = cases.and_then(|cases| cases.parse().ok());
    ProptestConfig {
        cases: cases.unwrap_or(24),
        rng_seed: cases.map_or(RngSeed::Fixed(7), |_| RngSeed::Random),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// A torus of 6 by 9 vertices or an open sheet of 7 by 7, its vertices moved at random.
fn mesh() -> impl Strategy<Value = TriangleMesh> {
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
fn values() -> impl Strategy<Value = Vec<Vec<f64>>> {
    prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, 54), 1..=3)
}

fn on(mesh: &TriangleMesh, values: &[Vec<f64>]) -> Array2<f64> {
    Array2::from_shape_fn((values.len(), mesh.vertex_count()), |(c, v)| values[c][v])
}

fn scheme() -> impl Strategy<Value = Scheme> {
    prop_oneof![
        Just(Scheme::SemiImplicit(Weights::Lagged)),
        Just(Scheme::SemiImplicit(Weights::Extrapolated)),
        Just(Scheme::Exact { tolerance: GAP }),
    ]
}

fn solver() -> impl Strategy<Value = Solver> {
    prop_oneof![Just(Solver::Cholesky), Just(Solver::Multigrid)]
}

fn method() -> impl Strategy<Value = Method> {
    prop_oneof![
        Just(Method::Heat),
        Just(Method::Naive),
        Just(Method::ShapeTv),
        (1..=3_u32).prop_map(|p| Method::ConformalLaplace { p }),
        Just(Method::DirectionalTv {
            base: Base::default(),
            metric: Metric::Surface
        }),
        Just(Method::LaplaceBeltrami { eigenpairs: 12 }),
        Just(Method::Displacement {
            base: Base::default()
        }),
    ]
}

/// Methods that do not know where the axes are.
fn equivariant_method() -> impl Strategy<Value = Method> {
    method().prop_filter("flows each axis alone", |method| *method != Method::Naive)
}

fn split(mesh: &TriangleMesh, method: &Method, scheme: Scheme, solver: Solver) -> Decomposition {
    let is_tv = matches!(
        method,
        Method::Naive | Method::ShapeTv | Method::DirectionalTv { .. }
    );
    let settings = Settings {
        method: method.clone(),
        times: None,
        steps: Steps::Count(STEPS),
        scheme: match is_tv {
            true => scheme,
            false => Scheme::SemiImplicit(Weights::Extrapolated),
        },
        solver,
    };
    decompose(mesh, &settings, Monitor::new().whole()).unwrap()
}

fn operators(mesh: &TriangleMesh) -> Discretization {
    Discretization::new(mesh, Monitor::new().whole()).unwrap()
}

/// The TV flow up to about the extinction of functions of the size of 1.
fn flow(mesh: &TriangleMesh, values: &Array2<f64>, scheme: Scheme, solver: Solver) -> Trajectory {
    let operators = operators(mesh);
    let times = graded_times(1e-3, 1.0, STEPS).unwrap();
    let law = TotalVariation::starting_at(&operators, values.view()).unwrap();
    let monitor = Monitor::new();
    let (values, stage) = (values.clone(), monitor.whole());
    run_flow(&operators, &law, scheme, values, &times, solver, stage).unwrap()
}

fn distance(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
    (a - b).iter().fold(0.0, |most, x| most.max(x.abs()))
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
        mesh in mesh(), method in method(), scheme in scheme(), solver in solver(), count in 1..STEPS
    ) {
        let split = split(&mesh, &method, scheme, solver);
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
        mesh in mesh(), method in method(), gains in prop::collection::vec(-3.0..3.0_f64, 2 * STEPS)
    ) {
        let split = split(&mesh, &method, Scheme::SemiImplicit(Weights::Lagged), Solver::Auto);
        let count = split.component_times().len();
        let (a, b) = (&gains[..count], &gains[STEPS..STEPS + count]);
        let sum: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + b).collect();
        let filtered = |gains: &[f64]| split.filter(gains).unwrap() - split.residual();
        prop_assert!(distance(&(filtered(a) + filtered(b)), &filtered(&sum)) < 1e-10);
    }

    #[test]
    fn total_variation_never_grows(
        mesh in mesh(), values in values(), scheme in scheme(), solver in solver()
    ) {
        let flow = flow(&mesh, &on(&mesh, &values), scheme, solver);
        let start = flow.total_variation[0];
        for pair in flow.total_variation.windows(2) {
            prop_assert!(pair[1] <= pair[0] + 1e-5 * start, "{:?}", flow.total_variation);
        }
    }

    #[test]
    fn the_mean_is_kept(
        mesh in mesh(), values in values(), scheme in scheme(), solver in solver()
    ) {
        let flow = flow(&mesh, &on(&mesh, &values), scheme, solver);
        let ones = vec![1.0; mesh.vertex_count()];
        let means = flow.mean(&ones, mesh.vertex_areas()).unwrap();
        for row in means.rows() {
            for (mean, first) in row.iter().zip(means.row(0)) {
                prop_assert!((mean - first).abs() < 1e-5, "{means}");
            }
        }
    }

    #[test]
    fn solvers_agree(mesh in mesh(), method in method()) {
        let scheme = Scheme::SemiImplicit(Weights::Lagged);
        let direct = split(&mesh, &method, scheme, Solver::Cholesky);
        let iterative = split(&mesh, &method, scheme, Solver::Multigrid);
        let last = |split: &Decomposition| split.filter(&vec![0.0; split.component_times().len()]);
        let error = distance(&last(&direct).unwrap(), &last(&iterative).unwrap());
        prop_assert!(error < 1e-4, "{error:e}");
    }

    #[test]
    fn shapes_turn_move_and_grow_with_their_bands(
        mesh in mesh(), method in equivariant_method(), turn in prop::array::uniform3(-3.0..3.0_f64),
        shift in prop::array::uniform3(-9.0..9.0_f64), size in 1e-3..1e3_f64
    ) {
        let rotation = Rotation3::from_scaled_axis(Vector3::from(turn));
        let scheme = Scheme::SemiImplicit(Weights::Lagged);
        let plain = split(&mesh, &method, scheme, Solver::Cholesky);
        let other = moved(&mesh, |p| size * (rotation * p + Vector3::from(shift)));
        let other = split(&other, &method, scheme, Solver::Cholesky);
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
    fn scaling_a_function_scales_its_time(
        mesh in mesh(), values in values(), scheme in scheme(), factor in prop_oneof![-4.0..-0.1_f64, 0.1..4.0_f64]
    ) {
        let operators = operators(&mesh);
        let values = on(&mesh, &values);
        let run = |factor: f64| {
            let values = factor * &values;
            let times: Vec<f64> = [0.0, 0.02, 0.05, 0.2].map(|t| factor.abs() * t).into();
            let law = TotalVariation::starting_at(&operators, values.view()).unwrap();
            let monitor = Monitor::new();
            let (solver, stage) = (Solver::Cholesky, monitor.whole());
            run_flow(&operators, &law, scheme, values, &times, solver, stage).unwrap()
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
        let (operators, monitor) = (operators(&mesh), Monitor::new());
        let times = [0.0, 0.05, 0.2, 0.5];
        let run = |values: &Array2<f64>| {
            proximal_flow(&operators, GAP, values.clone(), &times, monitor.whole()).unwrap()
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
        let scheme = Scheme::SemiImplicit(Weights::Extrapolated);
        let transform = |values: &Array2<f64>| {
            SpectralTransform::new(flow(&mesh, values, scheme, Solver::Cholesky))
        };
        let (plain, shifted) = (transform(&values), transform(&(&values + shift)));
        for k in 0..plain.component_times().len() {
            prop_assert!(distance(&plain.component(k), &shifted.component(k)) < 1e-6);
        }
        prop_assert!(distance(&(plain.residual() + shift), &shifted.residual()) < 1e-6);
    }

    #[test]
    fn eigenpairs_are_orthonormal_and_ordered(mesh in mesh(), count in 1..20_usize) {
        let (operators, monitor) = (operators(&mesh), Monitor::new());
        let pairs = Eigenpairs::lowest(&mesh, &operators, count, monitor.whole()).unwrap();
        prop_assert_eq!(pairs.eigenvalues.len(), count);
        prop_assert!(pairs.eigenvalues.is_sorted());
        prop_assert!(pairs.eigenvalues[0].abs() < 1e-9);
        let functions = &pairs.eigenfunctions;
        let masses = ndarray::aview1(operators.masses());
        let products = (functions * &masses).dot(&functions.t());
        prop_assert!(distance(&products, &Array2::eye(count)) < 1e-8);
    }

    #[test]
    fn no_deformation_stretches_less_than_the_convex_one(
        mesh in mesh(), pull in prop::array::uniform3(-3.0..3.0_f64),
        algorithm in prop_oneof![
            Just(Algorithm::Paper), Just(Algorithm::Harmonic),
            Just(Algorithm::Biharmonic), Just(Algorithm::AsRigidAsPossible)
        ]
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

    #[test]
    fn segments_are_numbered_by_size(mesh in mesh(), segments in 1..8_usize, seed in any::<u64>()) {
        let method = Method::ConformalLaplace { p: 3 };
        let scheme = Scheme::SemiImplicit(Weights::Extrapolated);
        let split = split(&mesh, &method, scheme, Solver::Auto);
        let labels = cosegment(&[&split], segments, seed, Monitor::new().whole()).unwrap();
        let mut areas = vec![0.0; segments];
        for (&label, area) in labels[0].iter().zip(mesh.vertex_areas()) {
            areas[label] += area;
        }
        prop_assert!(areas.is_sorted_by(|a, b| *a >= b - 1e-9), "{areas:?}");
    }

    #[test]
    fn a_set_and_its_complement_share_a_perimeter(mesh in mesh(), first in 1..30_usize) {
        let set: Vec<bool> = (0..mesh.vertex_count()).map(|v| v < first).collect();
        let complement: Vec<bool> = set.iter().map(|inside| !inside).collect();
        let test = |set: &[bool]| eigenset_test(&mesh, set, Monitor::new().whole()).unwrap();
        let (one, other) = (test(&set), test(&complement));
        prop_assert!((one.perimeter - other.perimeter).abs() < 1e-6 * one.perimeter);
        prop_assert!((one.area + other.area - mesh.area()).abs() < 1e-9 * mesh.area());
        prop_assert!(one.superset.iter().zip(&set).all(|(outer, inner)| *outer || !inner));
    }

    #[test]
    fn images_turn_with_their_components(
        pixels in prop::collection::vec(0.0..1.0_f64, 30), scheme in scheme(), height in 0.5..20.0_f64,
        is_flat in any::<bool>()
    ) {
        let values = Array2::from_shape_vec((1, 30), pixels).unwrap();
        let across = Array2::from_shape_fn((1, 30), |(_, p)| values[[0, (p % 5) * 6 + p / 5]]);
        let end = |values: Array2<f64>, rows: usize| {
            let image = Image { values, rows, columns: 30 / rows };
            let settings = image::Settings {
                metric: match is_flat {
                    true => image::Metric::Flat,
                    false => image::Metric::Surface { height },
                },
                times: None,
                steps: STEPS,
                scheme,
                solver: Solver::Cholesky,
            };
            let (flow, areas) = decompose_image(&image, &settings, Monitor::new().whole()).unwrap();
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
    let monitor = Monitor::new();
    deform(mesh, constraints, &targets, settings, monitor.whole()).unwrap()
}
