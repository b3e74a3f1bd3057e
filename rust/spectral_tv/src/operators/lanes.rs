//! Channels side by side at every vertex, so that a pass over faces or edges finds all of them
//! where it finds one.

use ndarray::{ArrayView2, Axis};
use rayon::prelude::*;

/// The values of up to `L` channels at one vertex.
pub(super) type Lanes<const L: usize> = [f64; L];

/// Channels of which passes take care at once, if there are several.
pub(super) const WIDTH: usize = 4;

/// Vertices that are worth handing to another thread.
const CHUNK: usize = 1 << 13;

/// `values` (at most L, V) vertex by vertex; lanes beyond the channels are 0.
pub(super) fn side_by_side<const L: usize>(values: ArrayView2<f64>) -> Vec<Lanes<L>> {
    let values = values.as_standard_layout();
    let channels: Vec<&[f64]> = values
        .rows()
        .into_iter()
        .filter_map(|r| r.to_slice())
        .collect();
    let vertices = (0..values.len_of(Axis(1))).into_par_iter();
    let lanes = vertices.with_min_len(CHUNK).map(|vertex| {
        let mut lanes = [0.0; L];
        for (lane, channel) in lanes.iter_mut().zip(&channels) {
            *lane = channel[vertex];
        }
        lanes
    });
    lanes.collect()
}
