//! Default time nodes.

use std::f64::consts::PI;

use crate::error::{ArgumentError, Result, has_usable_size};
use crate::flow::check_steps;
use crate::method::Method;

/// N + 1 times from 0 for N = `steps`, length²: t_k = c ((1 + t_N/c)^(k/N) − 1), evenly spaced
/// at first and from about c on in log t.
///
/// c and t_N are fractions of the surface `area` that depend on the method, so one filter means
/// the same on every pose and size.
///
/// # Errors
/// If `steps` is 0.
pub fn default_times(method: &Method, area: f64, steps: usize) -> Result<Vec<f64>> {
    let (finest, largest) = relative_scales(method);
    graded_times(area * finest, area * largest, steps)
}

/// N + 1 times from 0 to `largest` for N = `steps`, length²: evenly spaced at first and from
/// about `finest` on in log t.
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

/// c and t_N relative to the area, as [`default_times`] takes them: from the skin to the largest
/// feature that the method is for. The flow ends while the body still stands, so that the residual
/// is one.
pub fn relative_scales(method: &Method) -> (f64, f64) {
    match method {
        Method::Heat | Method::Naive | Method::ShapeTv => (1e-5, 3e-3),
        // Weyl's law: the K-th eigenvalue of a surface is near 4πK/area.
        Method::LaplaceBeltrami { eigenpairs } => {
            let finest = 1.0 / (4.0 * PI * *eigenpairs as f64);
            (finest, (8.0 * finest).max(3e-3))
        }
        Method::ConformalLaplace { .. } => (1.5e-5, 1e-2),
        Method::DirectionalTv { .. } | Method::Displacement { .. } => (1.5e-5, 1e-3),
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
