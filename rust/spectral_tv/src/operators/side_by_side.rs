//! Stores the channels of a function side by side at every vertex, so that one pass over faces or
//! edges reads all of them together.

use std::borrow::Cow;

use ndarray::{ArrayView2, Axis};

use crate::parallel;

/// The values of up to `L` channels at one vertex.
pub(super) type Lanes<const L: usize> = [f64; L];

/// Channels of which passes take care at once, if there are several.
pub(super) const WIDTH: usize = 4;

/// A function (C, V), vertex by vertex: made once for all that is asked of it.
#[derive(Debug)]
pub enum SideBySide<'a> {
    /// A single channel is so already.
    One(Cow<'a, [Lanes<1>]>),
    /// Four channels in each block; lanes beyond the last of all `channels` are 0.
    Several {
        /// Number of channels C.
        channels: usize,
        /// The lanes of all vertices, V each.
        blocks: Vec<Vec<Lanes<WIDTH>>>,
    },
}

impl<'a> From<ArrayView2<'a, f64>> for SideBySide<'a> {
    fn from(values: ArrayView2<'a, f64>) -> Self {
        if values.nrows() != 1 {
            let blocks = values.axis_chunks_iter(Axis(0), WIDTH);
            return Self::Several {
                channels: values.nrows(),
                blocks: blocks.map(lanes).collect(),
            };
        }
        let channel = values.index_axis_move(Axis(0), 0);
        Self::One(match channel.to_slice() {
            Some(channel) => Cow::Borrowed(channel.as_chunks().0),
            None => channel.iter().map(|&value| [value]).collect(),
        })
    }
}

impl SideBySide<'_> {
    /// Number of channels C.
    pub fn channel_count(&self) -> usize {
        match self {
            Self::One(_) => 1,
            Self::Several { channels, .. } => *channels,
        }
    }
}

/// `values` of at most four channels.
fn lanes(values: ArrayView2<f64>) -> Vec<Lanes<WIDTH>> {
    let values = values.as_standard_layout();
    let rows = values.rows().into_iter();
    let channels: Vec<&[f64]> = rows.filter_map(|row| row.to_slice()).collect();
    parallel::values(values.ncols(), |vertex| {
        let mut lanes = [0.0; WIDTH];
        for (lane, channel) in lanes.iter_mut().zip(&channels) {
            *lane = channel[vertex];
        }
        lanes
    })
}
