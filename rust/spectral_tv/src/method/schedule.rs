//! Default time nodes.

use crate::error::{Error, Result};
use crate::method::Method;

/// Where the spacing of the times turns from uniform to logarithmic, relative to the last time.
/// Three decades of scale, skin detail to whole limbs, then have steps enough, and the first
/// step, which has no history to extrapolate, is short.
const ONSET: f64 = 1.5e-3;

/// N + 1 times from 0 for N = `steps`, length²: t_k = c ((1 + t_N/c)^(k/N) − 1).
///
/// They end at a fraction of the surface `area` that depends on the method, so one filter means
/// the same on every pose and size.
///
/// # Errors
/// If `steps` is 0.
pub fn default_times(method: &Method, area: f64, steps: usize) -> Result<Vec<f64>> {
    if steps == 0 {
        return Err(Error::Argument("steps must be at least 1".into()));
    }
    let onset = ONSET * area * last_relative_time(method);
    let time = |k: usize| onset * ((1.0 + 1.0 / ONSET).powf(k as f64 / steps as f64) - 1.0);
    Ok((0..=steps).map(time).collect())
}

fn last_relative_time(method: &Method) -> f64 {
    match method {
        Method::Heat | Method::Naive | Method::ShapeTv => 2e-2,
        Method::ConformalLaplace { .. } => 3e-2,
        Method::DirectionalTv { .. } => 1e-3,
    }
}
