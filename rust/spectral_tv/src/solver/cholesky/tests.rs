//! Tests of what the factorization promises.

use ndarray::{Array2, arr1, arr2};
use proptest::prelude::*;
use sprs::{CsMatI, TriMatI};

use crate::error::{Error, Result};
use crate::monitor::Monitor;
use crate::solver::Cholesky;
use crate::solver::cholesky::Symbolic;
use crate::solver::cholesky::number::Number;
use crate::solver::cholesky::supernodes::Supernodes;
use crate::solver::cholesky::units;
use crate::solver::examples::{irregular, lattice, random, system_of};

fn functions(channels: usize, size: usize) -> Array2<f64> {
    let noise = random::<1>(channels * size, 3);
    Array2::from_shape_fn((channels, size), |(c, v)| f64::from(noise[c * size + v][0]))
}

/// K x for every row x.
fn product(lower: &CsMatI<f64, u32>, x: &Array2<f64>) -> Array2<f64> {
    let mut product = Array2::zeros(x.dim());
    for channel in 0..x.nrows() {
        for (value, (row, column)) in lower.iter() {
            let (row, column) = (row as usize, column as usize);
            product[[channel, row]] += value * x[[channel, column]];
            if row != column {
                product[[channel, column]] += value * x[[channel, row]];
            }
        }
    }
    product
}

/// A factorization in parts of so many vertices, and units of so much work.
fn prepared(lower: &CsMatI<f64, u32>, smallest: Option<usize>, least_work: f64) -> Cholesky {
    let monitor = Monitor::new();
    let nodes = match smallest {
        Some(smallest) => Supernodes::by_dissection(lower, smallest, monitor.whole()),
        None => Supernodes::by_degree(lower),
    };
    let units = units::split(&nodes.unwrap(), lower, least_work, monitor.whole()).unwrap();
    Cholesky::in_units(
        std::sync::Arc::new(units.into()),
        Symbolic::default(),
        monitor.whole(),
    )
    .unwrap()
}

fn analysed<N: Number>(lower: &CsMatI<f64, u32>) -> Cholesky<N> {
    Cholesky::analyse(lower, Monitor::new().whole()).unwrap()
}

fn factorize(cholesky: &mut Cholesky, lower: &CsMatI<f64, u32>) -> Result<()> {
    cholesky.factorize(lower, Monitor::new().whole())
}

/// The largest error of solutions, relative to the largest of what is to be found.
fn error(cholesky: &mut Cholesky, lower: &CsMatI<f64, u32>, channels: usize) -> f64 {
    let expected = functions(channels, lower.cols());
    let mut solutions = product(lower, &expected);
    factorize(cholesky, lower).unwrap();
    cholesky.solve_in_place(&mut solutions);
    let error = (&solutions - &expected)
        .iter()
        .fold(0.0_f64, |max, e| max.max(e.abs()));
    error / expected.iter().fold(0.0_f64, |max, e| max.max(e.abs()))
}

#[test]
fn solutions_have_the_right_images() {
    for (lower, _) in [lattice(90, 70, 0.1), irregular(4000), lattice(1, 1, 1.0)] {
        for smallest in [None, Some(1), Some(100)] {
            for least_work in [1.0, 1e4, 1e12] {
                let mut cholesky = prepared(&lower, smallest, least_work);
                // More than are solved at once.
                for channels in [1, 3, 5] {
                    assert!(error(&mut cholesky, &lower, channels) < 1e-9);
                }
            }
        }
    }
}

#[test]
fn a_factor_serves_all_matrices_of_its_pattern() {
    let (first, _) = lattice(40, 30, 1.0);
    let mut cholesky = analysed(&first);
    assert!(error(&mut cholesky, &first, 2) < 1e-12);
    let (second, _) = lattice(40, 30, 1e-3);
    assert!(error(&mut cholesky, &second, 2) < 1e-9);
    assert!(error(&mut cholesky, &first, 2) < 1e-12);
}

/// The largest error of solutions of the matrix with these row sums, by single precision, relative to the
/// largest of what is to be found: functions about 1.
fn error_in_single(lower: &CsMatI<f64, u32>, masses: &[f64]) -> f64 {
    let expected = 1.0 + functions(3, lower.cols());
    // Difference by difference: masses are far smaller than rounding of the products.
    let mut right = &expected * &arr1(masses);
    for (value, (row, column)) in lower.iter() {
        let (row, column) = (row as usize, column as usize);
        for channel in 0..3 {
            let difference = value * (expected[[channel, column]] - expected[[channel, row]]);
            right[[channel, row]] += difference;
            right[[channel, column]] -= difference;
        }
    }
    let couplings: Vec<f64> = lower.iter().map(|(value, _)| -value).collect();
    let mut cholesky = analysed::<f32>(lower);
    let stage = Monitor::new();
    let outcome = cholesky.factorize_laplacian(masses, (&couplings, 1.0), stage.whole());
    outcome.unwrap();
    let error = cholesky.solve(right.view()) - expected;
    error.iter().fold(0.0_f64, |max, e| max.max(e.abs()))
}

#[test]
fn single_precision_keeps_masses_far_below_its_rounding() {
    for mass in [1.0, 1e-4, 1e-8, 1e-12] {
        // The first has wide fronts.
        for (lower, masses) in [lattice(120, 110, mass), lattice(300, 5, mass)] {
            assert!(error_in_single(&lower, &masses) < 1e-4);
        }
    }
}

#[test]
fn single_precision_has_room_for_any_unit() {
    for unit in [1e-40, 1.0, 1e40] {
        let (mut lower, masses) = lattice(60, 50, 0.01);
        lower.data_mut().iter_mut().for_each(|value| *value *= unit);
        let masses: Vec<f64> = masses.iter().map(|mass| mass * unit).collect();
        assert!(error_in_single(&lower, &masses) < 1e-5);
    }
}

#[test]
fn threads_make_no_difference() {
    let (lower, masses) = lattice(150, 140, 1e-3);
    let couplings: Vec<f64> = lower.iter().map(|(value, _)| -value).collect();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let mut cholesky = analysed(&lower);
            assert!(cholesky.units.units.len() > 4);
            factorize(&mut cholesky, &lower).unwrap();
            let mut solutions = functions(3, masses.len());
            cholesky.solve_in_place(&mut solutions);
            let (mut single, stage) = (analysed::<f32>(&lower), Monitor::new());
            let outcome = single.factorize_laplacian(&masses, (&couplings, 1.0), stage.whole());
            outcome.unwrap();
            (single.solve(solutions.view()), solutions)
        })
    };
    assert_eq!(with(1), with(4));
}

#[test]
fn many_parts_that_are_not_coupled_are_one_system() {
    // Chains of 1 to 40 vertices, their vertices far apart in the order.
    let size = 820;
    let mut edges = Vec::new();
    let mut start = 0;
    let place = |vertex: usize| (vertex * 37) % size;
    for length in 1..=40 {
        for vertex in start..start + length - 1 {
            edges.push((place(vertex), place(vertex + 1), 1.0));
        }
        start += length;
    }
    let (lower, _) = system_of(size, &edges, vec![0.1; size]);
    for smallest in [None, Some(1), Some(30)] {
        for least_work in [1.0, 1e9] {
            let mut cholesky = prepared(&lower, smallest, least_work);
            assert!(error(&mut cholesky, &lower, 3) < 1e-12);
        }
    }
}

#[test]
fn dissection_saves_work_on_an_even_closed_mesh() {
    let (size, mut edges) = (130, Vec::new());
    for i in 0..size {
        for j in 0..size {
            let (down, right) = ((i + 1) % size, (j + 1) % size);
            for end in [down * size + j, i * size + right, down * size + right] {
                edges.push((i * size + j, end, 1.0));
            }
        }
    }
    let (lower, _) = system_of(size * size, &edges, vec![1.0; size * size]);
    let by_degree = Supernodes::by_degree(&lower).unwrap();
    let dissected = Supernodes::by_dissection(&lower, 400, Monitor::new().whole()).unwrap();
    let work = |nodes: &Supernodes| -> f64 { (0..nodes.len()).map(|node| nodes.work(node)).sum() };
    assert!(work(&dissected) < 0.65 * work(&by_degree));
}

#[test]
fn cancelling_ends_analysis_and_factorization() {
    let (lower, _) = lattice(150, 140, 1.0);
    let mut cholesky = analysed(&lower);
    let monitor = Monitor::new();
    monitor.cancel();
    let stage = monitor.whole();
    assert_eq!(
        Cholesky::<f64>::analyse(&lower, stage).err(),
        Some(Error::Cancelled)
    );
    assert_eq!(cholesky.factorize(&lower, stage), Err(Error::Cancelled));
    // It can be used as before.
    assert!(error(&mut cholesky, &lower, 1) < 1e-9);
}

#[test]
fn a_singular_matrix_is_mended_and_an_indefinite_one_refused() {
    let lower = |off_diagonal: f64| {
        let mut matrix = TriMatI::new((2, 2));
        matrix.add_triplet(0, 0, 1.0);
        matrix.add_triplet(1, 0, off_diagonal);
        matrix.add_triplet(1, 1, 1.0);
        matrix.to_csc::<u32>()
    };
    let mut cholesky = analysed(&lower(-1.0));
    factorize(&mut cholesky, &lower(-1.0)).unwrap();
    let mut solution = arr2(&[[1.0, -1.0]]);
    cholesky.solve_in_place(&mut solution);
    assert!((solution[[0, 0]] - solution[[0, 1]] - 1.0).abs() < 1e-6);

    assert!(factorize(&mut cholesky, &lower(-2.0)).is_err());
    assert!(factorize(&mut cholesky, &lower(f64::NAN)).is_err());
}

proptest! {
    #[test]
    fn any_pattern_is_solved(
        size in 1_usize..60,
        ends in proptest::collection::vec((0_usize..60, 0_usize..60, 0.01..10.0), 0..150),
        smallest in prop_oneof![Just(None), Just(Some(1)), Just(Some(8))],
        least_work in prop_oneof![Just(1.0), Just(300.0), Just(1e9)],
    ) {
        let edges: Vec<_> = ends
            .into_iter()
            .map(|(i, j, coupling)| (i % size, j % size, coupling))
            .filter(|(i, j, _)| i != j)
            .collect();
        let (lower, _) = system_of(size, &edges, vec![0.5; size]);
        let mut cholesky = prepared(&lower, smallest, least_work);
        prop_assert!(error(&mut cholesky, &lower, 2) < 1e-11);
    }
}
