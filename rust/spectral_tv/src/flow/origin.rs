//! Flows of functions far from 0, such as the positions of a scan in the coordinates of a map.
//!
//! A constant takes no part in a flow. If it is left in, all that is computed loses digits to it.

use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};

/// How many times its distance from 0 has to be larger than a function's variation for it to be
/// flowed apart from its middle. No digit of it is lost then.
const FAR: f64 = 4.0;

/// The constant, (C), that `values` (C, V) are flowed apart from: 0 for a channel that is not far
/// from 0.
pub(super) fn origin_of(values: ArrayView2<f64>) -> Array1<f64> {
    let origin = |channel: ArrayView1<f64>| {
        let range = channel
            .iter()
            .fold([f64::MAX, f64::MIN], |[least, most], &x| {
                [least.min(x), most.max(x)]
            });
        let [middle, half] = [0.5 * (range[1] + range[0]), 0.5 * (range[1] - range[0])];
        match middle.abs() > FAR * half {
            true => middle,
            false => 0.0,
        }
    };
    values.map_axis(Axis(1), origin)
}

/// `values` (C, V) less a constant, (C).
pub(crate) fn without(mut values: Array2<f64>, origin: &Array1<f64>) -> Array2<f64> {
    for (mut channel, &origin) in values.rows_mut().into_iter().zip(origin) {
        if origin != 0.0 {
            channel -= origin;
        }
    }
    values
}
