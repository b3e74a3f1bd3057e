//! Default time nodes.

use crate::error::{Error, Result};
use crate::method::Method;

/// Ratio of the last time to the first: three decades hold skin detail to whole limbs.
const RANGE: f64 = 1e3;

/// 0 and `steps` times equally spaced in log t over three decades, length².
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
    let last = area * last_relative_time(method);
    let nodes = (1..=steps).map(|k| match steps {
        1 => last,
        _ => last * RANGE.powf((k as f64 - steps as f64) / (steps as f64 - 1.0)),
    });
    Ok(std::iter::once(0.0).chain(nodes).collect())
}

fn last_relative_time(method: &Method) -> f64 {
    match method {
        Method::Heat | Method::Naive | Method::ShapeTv => 2e-2,
        Method::ConformalLaplace { .. } => 3e-2,
        Method::DirectionalTv { .. } => 1e-3,
    }
}
