//! Hierarchies for the tests of this module.

use std::sync::Arc;

use ndarray::Array2;
use sprs::CsMatI;

use crate::graph::Graph;
use crate::monitor::Monitor;
pub use crate::solver::examples::{irregular, lattice, random, system_of};
use crate::solver::multigrid::hierarchy::Hierarchy;
use crate::solver::multigrid::matrix::{Lanes, Matrix};
use crate::solver::multigrid::ordering::Ordering;
use crate::solver::multigrid::system;

/// The hierarchy of a system.
pub fn hierarchy_of(lower: &CsMatI<f64, u32>, masses: &[f64]) -> Hierarchy {
    let monitor = Monitor::new();
    let graph = Arc::new(Graph::new(lower, monitor.whole()).unwrap());
    let ordering = Ordering::breadth_first(graph, monitor.whole()).unwrap();
    let mut matrix = system::pattern(&ordering, monitor.whole()).unwrap();
    system::refresh(&mut matrix, &ordering, masses, (&couplings_of(lower), 1.0));
    let mut hierarchy = Hierarchy::unset(matrix);
    hierarchy.coarsen(monitor.whole()).unwrap();
    hierarchy
}

/// The couplings of a matrix with the lower triangle `lower`.
pub fn couplings_of(lower: &CsMatI<f64, u32>) -> Vec<f64> {
    lower.data().iter().map(|value| -value).collect()
}

/// The inner product of two vectors.
pub fn dot(x: &[Lanes<1>], y: &[Lanes<1>]) -> f64 {
    let products = x
        .iter()
        .zip(y)
        .map(|(x, y)| f64::from(x[0]) * f64::from(y[0]));
    products.sum()
}

/// All entries of a matrix.
pub fn dense(matrix: &Matrix) -> Array2<f64> {
    let mut dense = Array2::zeros((matrix.size(), matrix.size()));
    for row in 0..matrix.size() {
        dense[[row, row]] += f64::from(matrix.masses[row]);
        for octet in matrix.row(row) {
            for (column, coupling) in octet.columns.iter().zip(octet.couplings) {
                dense[[row, row]] += f64::from(coupling);
                dense[[row, *column as usize]] -= f64::from(coupling);
            }
        }
    }
    dense
}
