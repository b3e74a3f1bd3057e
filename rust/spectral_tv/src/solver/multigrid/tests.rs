//! Tests of what the solver as a whole promises.

use std::sync::Arc;

use ndarray::Array2;
use sprs::CsMatI;

use crate::error::Error;
use crate::graph::Graph;
use crate::monitor::Monitor;
use crate::solver::multigrid::examples::{couplings_of, irregular, lattice, random, system_of};
use crate::solver::{Cholesky, Demand, LinearSolver, Multigrid, Solver, Symbolic};

fn graph_of(lower: &CsMatI<f64, u32>) -> Arc<Graph> {
    Arc::new(Graph::new(lower, Monitor::new().whole()).unwrap())
}

fn functions(channels: usize, size: usize) -> Array2<f64> {
    let noise = random::<4>(channels * size, 9);
    Array2::from_shape_fn((channels, size), |(c, v)| {
        f64::from(noise[c * size + v][0]) + (v as f64 / size as f64).sin()
    })
}

fn solved(
    (lower, masses): &(CsMatI<f64, u32>, Vec<f64>),
    right: &Array2<f64>,
    guess: Option<&Array2<f64>>,
) -> Array2<f64> {
    let monitor = Monitor::new();
    let mut solver = Multigrid::analyse(graph_of(lower), monitor.whole()).unwrap();
    let values = (&*couplings_of(lower), 1.0);
    solver.set_matrix(masses, values, monitor.whole()).unwrap();
    solver
        .solve(right.view(), guess.cloned(), 1e-6, monitor.whole())
        .unwrap()
}

fn factorized(lower: &CsMatI<f64, u32>, right: &Array2<f64>) -> Array2<f64> {
    let monitor = Monitor::new();
    let mut cholesky: Cholesky = Cholesky::analyse(lower, monitor.whole()).unwrap();
    cholesky.factorize(lower, monitor.whole()).unwrap();
    let mut solution = right.clone();
    cholesky.solve_in_place(&mut solution);
    solution
}

fn largest(values: &Array2<f64>) -> f64 {
    values.iter().fold(0.0, |max, value| max.max(value.abs()))
}

#[test]
fn solutions_are_those_of_the_factorization() {
    for system in [
        lattice(120, 110, 1e-2),
        lattice(50, 40, 10.0),
        irregular(5000),
    ] {
        for channels in [1, 3, 6] {
            let right = functions(channels, system.1.len());
            let expected = factorized(&system.0, &right);
            let difference = solved(&system, &right, None) - &expected;
            assert!(largest(&difference) < 1e-5 * largest(&expected));
        }
    }
}

#[test]
fn a_guess_changes_nothing_however_bad() {
    let system = lattice(60, 70, 1e-2);
    let right = functions(3, system.1.len());
    let expected = factorized(&system.0, &right);
    let close = &expected * 1.01;
    let wrong = functions(3, system.1.len()) * (100.0 * largest(&expected));
    for guess in [&expected, &close, &wrong, &Array2::zeros(right.dim())] {
        let difference = solved(&system, &right, Some(guess)) - &expected;
        assert!(largest(&difference) < 1e-5 * largest(&expected));
    }
}

#[test]
fn threads_make_no_difference() {
    let system = lattice(160, 150, 1e-3);
    let right = functions(3, system.1.len());
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| solved(&system, &right, None))
    };
    let one = with(1);
    for threads in [2, 3, 8] {
        assert_eq!(one, with(threads));
    }
}

#[test]
fn matrices_may_change_beyond_recognition() {
    let monitor = Monitor::new();
    let (lower, masses) = lattice(70, 60, 100.0);
    let mut solver = Multigrid::analyse(graph_of(&lower), monitor.whole()).unwrap();
    let right = functions(2, masses.len());
    for mass in [100.0, 1.0, 1e-2, 1e-4, 50.0] {
        let (lower, masses) = lattice(70, 60, mass);
        let values = (&*couplings_of(&lower), 1.0);
        solver.set_matrix(&masses, values, monitor.whole()).unwrap();
        let solution = solver
            .solve(right.view(), None, 1e-6, monitor.whole())
            .unwrap();
        let expected = factorized(&lower, &right);
        assert!(largest(&(solution - &expected)) < 1e-5 * largest(&expected));
    }
}

#[test]
fn what_does_not_converge_is_factorized() {
    // Definite by a hair: couplings of both signs, so large that single precision is lost.
    let masses = vec![1.0; 400];
    let edges: Vec<_> = (1..400)
        .map(|i| (i - 1, i, if i % 2 == 0 { 1e9 } else { -0.2 }))
        .collect();
    let (lower, masses) = system_of(400, &edges, masses);
    let monitor = Monitor::new();
    let demand = Demand {
        solutions: 1,
        channels: 1,
    };
    let (choice, symbolic) = (Solver::Multigrid, Symbolic::default());
    let stage = monitor.whole();
    let mut solver =
        LinearSolver::new(&graph_of(&lower), &symbolic, choice, demand, stage).unwrap();
    solver
        .set_matrix(&masses, couplings_of(&lower), 1.0, monitor.whole())
        .unwrap();
    let right = functions(1, 400);
    let solution = solver.solve(&right, None, 1e-6, monitor.whole()).unwrap();
    let expected = factorized(&lower, &right);
    assert!(largest(&(solution - &expected)) < 1e-5 * largest(&expected));
}

#[test]
fn cancelling_ends_every_stage() {
    let (lower, masses) = lattice(40, 40, 1e-2);
    let monitor = Monitor::new();
    let mut solver = Multigrid::analyse(graph_of(&lower), monitor.whole()).unwrap();
    let couplings = couplings_of(&lower);
    let values = (&*couplings, 1.0);
    solver.set_matrix(&masses, values, monitor.whole()).unwrap();
    monitor.cancel();
    let stage = monitor.whole();
    let right = functions(1, masses.len());
    assert_eq!(
        solver.solve(right.view(), None, 1e-6, stage),
        Err(Error::Cancelled)
    );
    assert_eq!(
        solver.set_matrix(&masses, values, stage),
        Err(Error::Cancelled)
    );
    assert!(matches!(
        Multigrid::analyse(graph_of(&lower), stage),
        Err(Error::Cancelled)
    ));
}
