//! Converts a system between its owner's order and precision and those of the levels.

use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;

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
    let rows = (0..ordering.size()).map(|place| {
        let mut row = Vec::new();
        ordering.sorted_row(place, &mut row);
        row.into_iter().map(|(other, _)| other)
    });
    Matrix::with_pattern(rows, stage)
}

/// Takes the matrix diag(`masses`) + `tau` L with the off-diagonal entries −`couplings` of L, all
/// divided by the mean mass, which is returned: single precision then has room to both sides.
pub(super) fn refresh(
    matrix: &mut Matrix,
    ordering: &Ordering,
    masses: &[f64],
    (couplings, tau): (&[f64], f64),
) -> f64 {
    let scale = masses.iter().sum::<f64>() / masses.len() as f64;
    let (chunk, starts) = (matrix.chunk(), &matrix.starts);
    let parts = split_at_rows(&mut matrix.octets, starts, chunk);
    let parts = parts
        .into_par_iter()
        .zip(matrix.masses.par_chunks_mut(chunk));
    parts
        .enumerate()
        .with_max_len(1)
        .for_each(|(part, (octets, row_sums))| {
            let first = part * chunk;
            let mut sorted = Vec::new();
            for (offset, row_sum) in row_sums.iter_mut().enumerate() {
                let row = first + offset;
                *row_sum = (masses[ordering.vertex_at(row)] / scale) as f32;
                let octets = &mut octets[(starts[row] - starts[first]) as usize..];
                ordering.sorted_row(row, &mut sorted);
                for (octet, neighbours) in octets.iter_mut().zip(sorted.chunks(8)) {
                    for (coupling, (_, entry)) in octet.couplings.iter_mut().zip(neighbours) {
                        *coupling = (tau * couplings[*entry as usize] / scale) as f32;
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
    let chunks = lanes.par_chunks_mut(chunk).enumerate();
    chunks.with_max_len(1).for_each(|(part, lanes)| {
        for (place, lanes) in (part * chunk..).zip(lanes) {
            let vertex = ordering.vertex_at(place);
            *lanes = [0.0; L];
            for (lane, channel) in lanes.iter_mut().zip(&channels) {
                *lane = (factor * channel[vertex]) as f32;
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
    parallel::columns_mut(&mut rows).for_each(|(first, mut rows)| {
        for (vertex, mut column) in (first..).zip(rows.columns_mut()) {
            let lanes = &lanes[ordering.place_of(vertex)];
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
