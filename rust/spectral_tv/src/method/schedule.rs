//! Time nodes from the finest scale to the largest.

use crate::error::{ArgumentError, Result, has_usable_size};
use crate::flow::check_steps;

/// N + 1 times from 0 to `largest` for N = `steps`, length²: t_k = c ((1 + t_N/c)^(k/N) − 1) with
/// c = `finest`, evenly spaced at first and from about c on in log t.
///
/// # Errors
/// If `steps` is 0, 0 < `finest` < `largest` does not hold, or they are too far apart or too small
/// for steps between them.
pub fn graded_times(finest: f64, largest: f64, steps: usize) -> Result<Vec<f64>> {
    check_steps(steps)?;
    if !(0.0 < finest && finest < largest && has_usable_size(largest)) {
        return Err(ArgumentError::contradiction(
            "finest",
            &["largest"],
            format!(
                "the finest scale must be above 0 and below the largest, and that at most 1e100, \
                 but they are {finest:e} and {largest:e}"
            ),
        )
        .into());
    }
    let range = 1.0 + largest / finest;
    let time = |k: usize| finest * (range.powf(k as f64 / steps as f64) - 1.0);
    let times: Vec<f64> = (0..=steps).map(time).collect();
    let increase = times.windows(2).all(|pair| pair[0] < pair[1]);
    match increase && times[steps].is_finite() {
        true => Ok(times),
        false => Err(ArgumentError::contradiction(
            "steps",
            &["finest", "largest"],
            format!(
                "no {steps} steps of finite length lead from the finest scale, {finest:e}, to the \
                 largest, {largest:e}"
            ),
        )
        .into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_without_steps_between_them_are_refused() {
        for (finest, largest) in [(5e-324, 1e99), (1e-300, 1e100), (5e-324, 1e-323)] {
            let error = graded_times(finest, largest, 8).unwrap_err();
            assert!(error.to_string().starts_with("no 8 steps"), "{error}");
        }
        assert!(graded_times(1e-300, 1e-299, 8).is_ok());
    }
}
