//! Converts a system between its owner's order and precision and those of the levels.

use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;
use sprs::CsMatI;

use crate::error::Result;
use crate::monitor::Stage;
use crate::parallel;
use crate::solver::multigrid::matrix::{Lanes, Matrix, chunk_length, split_at_rows};
use crate::solver::multigrid::ordering::Ordering;

/// The finest matrix, without values.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(super) fn pattern(ordering: &Ordering, stage: Stage) -> Result<Matrix> {
    let bounds = ordering.starts.windows(2);
    let rows = bounds.map(|bound| &ordering.neighbours[bound[0] as usize..bound[1] as usize]);
    Matrix::with_pattern(rows, stage)
}

/// Takes the values of the matrix with the lower triangle `lower` and the row sums `masses`, all
/// divided by the mean mass, which is returned: single precision then has room to both sides.
pub(super) fn refresh(
    matrix: &mut Matrix,
    ordering: &Ordering,
    lower: &CsMatI<f64, u32>,
    masses: &[f64],
) -> f64 {
    let scale = masses.iter().sum::<f64>() / masses.len() as f64;
    let (chunk, starts) = (matrix.chunk(), &matrix.starts);
    let parts = split_at_rows(&mut matrix.octets, starts, chunk);
    let parts = parts
        .into_par_iter()
        .zip(matrix.masses.par_chunks_mut(chunk));
    let values = lower.data();
    parts
        .enumerate()
        .with_max_len(1)
        .for_each(|(part, (octets, row_sums))| {
            let first = part * chunk;
            for (offset, row_sum) in row_sums.iter_mut().enumerate() {
                let row = first + offset;
                *row_sum = (masses[ordering.order[row] as usize] / scale) as f32;
                let octets = &mut octets[(starts[row] - starts[first]) as usize..];
                let entries = ordering.starts[row] as usize..ordering.starts[row + 1] as usize;
                for (octet, entries) in octets.iter_mut().zip(ordering.entries[entries].chunks(8)) {
                    for (coupling, entry) in octet.couplings.iter_mut().zip(entries) {
                        *coupling = (-values[*entry as usize] / scale) as f32;
                    }
                }
            }
        });
    scale
}

/// `lanes` ← the channels of `values` (at most L, V) in the order of the levels, times `factor`;
/// lanes beyond them are 0.
pub(super) fn gather<const L: usize>(
    ordering: &Ordering,
    values: ArrayView2<f64>,
    factor: f64,
    lanes: &mut [Lanes<L>],
) {
    let channels: Vec<_> = values.rows().into_iter().collect();
    let chunk = chunk_length(lanes.len());
    let chunks = lanes
        .par_chunks_mut(chunk)
        .zip(ordering.order.par_chunks(chunk));
    chunks.with_max_len(1).for_each(|(lanes, order)| {
        for (lanes, &vertex) in lanes.iter_mut().zip(order) {
            *lanes = [0.0; L];
            for (lane, channel) in lanes.iter_mut().zip(&channels) {
                *lane = (factor * channel[vertex as usize]) as f32;
            }
        }
    });
}

/// The reverse of [`gather`]: `lanes` over `factor`, as rows `first` and following of `values`.
pub(super) fn scatter<const L: usize>(
    ordering: &Ordering,
    lanes: &[Lanes<L>],
    factor: f64,
    values: &mut Array2<f64>,
    first: usize,
) {
    let (_, rows) = values.view_mut().split_at(Axis(0), first);
    let count = L.min(rows.nrows());
    let (mut rows, _) = rows.split_at(Axis(0), count);
    parallel::columns_mut(&mut rows).for_each(|(vertex, mut rows)| {
        let places = &ordering.places[vertex..];
        for (mut column, &place) in rows.columns_mut().into_iter().zip(places) {
            let lanes = &lanes[place as usize];
            for (value, lane) in column.iter_mut().zip(lanes) {
                *value = f64::from(*lane) / factor;
            }
        }
    });
}

/// The largest magnitude in `values` (C, V).
pub(super) fn largest(values: ArrayView2<f64>) -> f64 {
    parallel::largest(values.ncols(), |vertices| {
        let part = parallel::columns(values, vertices);
        part.fold(0.0_f64, |max, value| max.max(value.abs()))
    })
}
