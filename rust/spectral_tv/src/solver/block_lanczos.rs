//! The largest eigenpairs of a symmetric operator, by block Lanczos iteration.
//!
//! Symmetric shapes have multiple eigenvalues, and blocks find all vectors of each. The basis is
//! kept orthogonal to rounding. faer's Krylov–Schur iteration, which goes vector by vector, can
//! neither be watched nor interrupted.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use faer::{Mat, Side};
use fastrand::Rng;
use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, ArrayView2, Axis, Slice};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::monitor::Stage;
use crate::parallel;
use crate::solver::scratch;

/// Vectors that are iterated together; more than any finite symmetry group makes equal.
const BLOCK: usize = 8;
/// Residual ‖A x − θ x‖ of a pair, relative to θ.
const TOLERANCE: f64 = 1e-9;
/// Norm of a vector, relative to the operator's, that is put down to rounding.
const ROUNDING: f64 = 1e-13;
/// How often a wait looks whether to go on.
const POLL: Duration = Duration::from_millis(10);

/// A symmetric operator on vectors of one size.
pub trait Operator {
    /// Number of components of a vector.
    fn size(&self) -> usize;

    /// Dimension of the space that [`Self::project`] projects onto.
    fn dimension(&self) -> usize;

    /// Projects every row of `block` onto an invariant space.
    fn project(&self, block: &mut Array2<f64>);

    /// Replaces every row x of `block` by A x.
    ///
    /// # Errors
    /// If A cannot be applied, or the monitor was cancelled.
    fn apply(&mut self, block: &mut Array2<f64>, stage: Stage) -> Result<()>;
}

/// The `count` largest eigenvalues of `operator` on the space that it projects onto, falling,
/// and their orthonormal eigenvectors, (count, size).
///
/// # Errors
/// If the operator fails, or the monitor was cancelled.
///
/// # Panics
/// If the space has fewer dimensions than `count`.
pub fn largest_eigenpairs(
    operator: &mut impl Operator,
    count: usize,
    stage: Stage,
) -> Result<(Vec<f64>, Array2<f64>)> {
    let (size, dimension) = (operator.size(), operator.dimension());
    assert!(count <= dimension, "more eigenpairs than dimensions");
    if count == 0 {
        return Ok((Vec::new(), Array2::zeros((0, size))));
    }
    let mut rng = Rng::with_seed(0);
    let mut basis = Array2::zeros((0, size));
    let mut block = Array2::zeros((0, size));
    fill(
        &mut block,
        operator,
        basis.view(),
        BLOCK.min(dimension),
        &mut rng,
    );
    // The operator in the basis: block tridiagonal, its columns as they were found.
    let mut matrix = Array2::<f64>::zeros((0, 0));
    let mut next_check = (count + (count / 2).max(2 * BLOCK)).min(dimension);
    let expected = 2 * next_check;
    loop {
        let width = block.nrows();
        append(&mut basis, &block);
        let found = basis.nrows();
        stage.report(0.9 * (found as f64 / expected as f64).min(1.0))?;
        operator.apply(&mut block, stage)?;
        operator.project(&mut block);
        let along = take_out(basis.view(), &mut block, stage)?;
        matrix = enlarged(&matrix, &along);
        let scale = matrix
            .diag()
            .iter()
            .fold(0.0_f64, |most, d| most.max(d.abs()));
        let mut coupling = orthonormalize(&mut block, ROUNDING * scale);
        take_out(basis.view(), &mut block, stage)?;
        coupling = orthonormalize(&mut block, 0.5).dot(&coupling);
        // With the whole space in the basis its matrix is all of the operator.
        let is_whole = found == dimension;
        if is_whole || found >= next_check {
            let (values, vectors) = ritz_pairs(&matrix, count, stage)?;
            let last = vectors.slice_axis(Axis(0), Slice::from(found - width..));
            let residuals = coupling.dot(&last);
            let mut pairs = values.iter().zip(residuals.columns());
            if is_whole || pairs.all(|(v, r)| r.dot(&r).sqrt() <= TOLERANCE * v.abs()) {
                let vectors = combined(vectors.view(), basis.view(), stage)?;
                return Ok((values, vectors));
            }
            next_check = (found + (found / 5).max(BLOCK)).min(dimension);
        }
        let missing = BLOCK.min(dimension - found);
        fill(&mut block, operator, basis.view(), missing, &mut rng);
    }
}

/// Adds random vectors, orthonormal to `basis` and `block`, until `block` has `count` rows.
fn fill(
    block: &mut Array2<f64>,
    operator: &impl Operator,
    basis: ArrayView2<f64>,
    count: usize,
    rng: &mut Rng,
) {
    while block.nrows() < count {
        let mut row = Array2::from_shape_fn((1, block.ncols()), |_| rng.f64() - 0.5);
        operator.project(&mut row);
        for _ in 0..3 {
            for basis in [basis, block.view()] {
                let along = basis.dot(&row.t());
                row -= &along.t().dot(&basis);
            }
            row /= row.iter().map(|x| x * x).sum::<f64>().sqrt();
        }
        append(block, &row);
    }
}

fn append(rows: &mut Array2<f64>, more: &Array2<f64>) {
    rows.append(Axis(0), more.view())
        .expect("rows have one length");
}

/// Takes the components along the orthonormal rows of `basis` (m, V) out of the rows of `block`
/// (b, V) and returns them, (m, b).
fn take_out(basis: ArrayView2<f64>, block: &mut Array2<f64>, stage: Stage) -> Result<Array2<f64>> {
    let shape = (basis.nrows(), block.nrows());
    let products = || {
        parallel::parts(basis.ncols(), |part| {
            let [basis, block] =
                [basis, block.view()].map(|rows| parallel::columns(rows, part.clone()));
            basis.dot(&block.t())
        })
    };
    let parts = stage.pass(products)?;
    // One after the other, so that results do not depend on the threads.
    let along = parts
        .iter()
        .fold(Array2::zeros(shape), |sum, part| sum + part);
    stage.pass(|| {
        parallel::columns_mut(&mut block.view_mut()).for_each(|(first, mut block)| {
            let basis = parallel::columns(basis, first..first + block.ncols());
            general_mat_mul(-1.0, &along.t(), &basis, 1.0, &mut block);
        });
    })?;
    Ok(along)
}

/// Makes the rows of `block` (b, V) orthonormal, leaving out those that depend on the ones
/// before to a norm of `negligible`; returns what they were made of, (rows kept, b).
fn orthonormalize(block: &mut Array2<f64>, negligible: f64) -> Array2<f64> {
    let width = block.nrows();
    let mut kept = Array2::zeros((0, block.ncols()));
    let mut coupling = Array2::zeros((0, width));
    for (index, row) in block.rows().into_iter().enumerate() {
        let mut row = row.to_owned().insert_axis(Axis(0));
        for _ in 0..2 {
            let along = kept.dot(&row.t());
            row -= &along.t().dot(&kept);
            let mut column = coupling.column_mut(index);
            column += &along.column(0);
        }
        let norm = row.iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm > negligible {
            row /= norm;
            append(&mut kept, &row);
            let mut unit = Array2::zeros((1, width));
            unit[[0, index]] = norm;
            append(&mut coupling, &unit);
        }
    }
    *block = kept;
    coupling
}

/// `matrix` (m, m) with the new columns `along` (m + b, b), and the same as rows.
fn enlarged(matrix: &Array2<f64>, along: &Array2<f64>) -> Array2<f64> {
    let (size, before) = (along.nrows(), matrix.nrows());
    Array2::from_shape_fn((size, size), |(i, j)| match (i < before, j < before) {
        (true, true) => matrix[[i, j]],
        (_, false) => along[[i, j - before]],
        (false, true) => along[[j, i - before]],
    })
}

/// The `count` largest eigenvalues of a symmetric matrix (m, m), falling, and their
/// eigenvectors as columns, (m, count).
///
/// Takes long for large matrices and cannot be interrupted, so it has a thread of its own, which
/// is left to itself once the monitor was cancelled.
fn ritz_pairs(matrix: &Array2<f64>, count: usize, stage: Stage) -> Result<(Vec<f64>, Array2<f64>)> {
    let size = matrix.nrows();
    // faer's tolerances are absolute.
    let scale = matrix
        .iter()
        .fold(f64::MIN_POSITIVE, |most, entry| most.max(entry.abs()));
    let dense = Mat::from_fn(size, size, |i, j| matrix[[i, j]] / scale);
    scratch::check(1)?;
    let (sender, receiver) = channel();
    let spawned = thread::Builder::new()
        .name("spectral_tv".into())
        .spawn(move || sender.send(dense.self_adjoint_eigen(Side::Lower)));
    if let Err(error) = spawned {
        return Err(Error::Memory(format!("no thread for eigenpairs: {error}")));
    }
    let pairs = loop {
        stage.check()?;
        match receiver.recv_timeout(POLL) {
            Err(RecvTimeoutError::Timeout) => {}
            Ok(Ok(pairs)) => break pairs,
            Ok(Err(error)) => return Err(Error::Solver(format!("no eigenpairs: {error:?}"))),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Error::Solver("no eigenpairs".into()));
            }
        }
    };
    let (values, vectors) = (pairs.S().column_vector(), pairs.U());
    let falling = |k: usize| size - 1 - k;
    Ok((
        (0..count).map(|k| scale * values[falling(k)]).collect(),
        Array2::from_shape_fn((size, count), |(i, k)| vectors[(i, falling(k))]),
    ))
}

/// The rows of `basis` (m, V) combined by the columns of `weights` (m, K), (K, V).
fn combined(weights: ArrayView2<f64>, basis: ArrayView2<f64>, stage: Stage) -> Result<Array2<f64>> {
    let mut rows = Array2::zeros((weights.ncols(), basis.ncols()));
    parallel::columns_mut(&mut rows.view_mut()).try_for_each(|(first, mut rows)| {
        let basis = parallel::columns(basis, first..first + rows.ncols());
        stage.pass(|| general_mat_mul(1.0, &weights.t(), &basis, 0.0, &mut rows))
    })?;
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Monitor;

    /// A diagonal matrix, on the vectors whose first component is 0.
    struct Diagonal(Vec<f64>);

    impl Operator for Diagonal {
        fn size(&self) -> usize {
            self.0.len()
        }

        fn dimension(&self) -> usize {
            self.0.len() - 1
        }

        fn project(&self, block: &mut Array2<f64>) {
            block.column_mut(0).fill(0.0);
        }

        fn apply(&mut self, block: &mut Array2<f64>, _stage: Stage) -> Result<()> {
            for (mut column, value) in block.columns_mut().into_iter().zip(&self.0) {
                column *= *value;
            }
            Ok(())
        }
    }

    fn check(diagonal: &[f64], count: usize) {
        let mut operator = Diagonal(diagonal.to_vec());
        let monitor = Monitor::new();
        let (values, vectors) = largest_eigenpairs(&mut operator, count, monitor.whole()).unwrap();
        let mut expected = diagonal[1..].to_vec();
        expected.sort_by(|a, b| b.total_cmp(a));
        for (value, expected) in values.iter().zip(&expected) {
            assert!((value - expected).abs() <= 1e-12 * expected.abs());
        }
        let products = vectors.dot(&vectors.t());
        for ((i, j), product) in products.indexed_iter() {
            assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
        }
        for (value, vector) in values.iter().zip(vectors.rows()) {
            for (component, entry) in vector.iter().zip(diagonal) {
                assert!((component * (entry - value)).abs() <= 2e-9 * value);
            }
            assert_eq!(vector[0], 0.0);
        }
    }

    #[test]
    fn multiple_eigenvalues_are_found_as_often_as_they_occur() {
        let diagonal: Vec<f64> = (0..400).map(|k| 1.0 / (1 + k / 6) as f64).collect();
        check(&diagonal, 40);
    }

    #[test]
    fn the_unit_does_not_matter() {
        for unit in [1e-18, 1e14] {
            let diagonal: Vec<f64> = (0..400).map(|k| unit / (1 + k / 2) as f64).collect();
            check(&diagonal, 40);
        }
    }

    #[test]
    fn all_eigenpairs_of_a_small_operator_are_found() {
        let diagonal: Vec<f64> = (1..=30).map(f64::from).collect();
        for count in [0, 1, 12, 29] {
            check(&diagonal, count);
        }
        check(&[7.0; 20], 19);
    }

    #[test]
    fn a_cancelled_monitor_ends_it() {
        let mut operator = Diagonal((1..=300).map(f64::from).collect());
        let monitor = Monitor::new();
        monitor.cancel();
        let result = largest_eigenpairs(&mut operator, 100, monitor.whole());
        assert_eq!(result.unwrap_err(), Error::Cancelled);
    }
}
