//! Checks of the times and the numbers of steps of a flow.

use crate::error::{ArgumentError, Result, has_usable_size};

/// Most steps of equal or graded length: a million take hours and gigabytes on any mesh.
const MOST_STEPS: usize = 1_000_000;

/// Refuses numbers of steps that no flow takes.
///
/// # Errors
/// If `steps` is 0, or beyond a million.
pub(crate) fn check_steps(steps: usize) -> Result<()> {
    let rule = match steps {
        0 => "must be at least 1".to_string(),
        1..=MOST_STEPS => return Ok(()),
        _ => format!("must be at most {MOST_STEPS}"),
    };
    Err(ArgumentError::value("steps", rule, steps).into())
}

/// Refuses times that do not increase from 0.
pub(crate) fn check_times(times: &[f64]) -> Result<()> {
    if times.len() < 2 {
        return Err(ArgumentError::count(
            "times",
            "needs at least two values, 0 and an end",
            times.len(),
        )
        .into());
    }
    if times[0] != 0.0 {
        return Err(ArgumentError::value("times[0]", "must be 0", times[0]).into());
    }
    for (k, pair) in times.windows(2).enumerate() {
        if !(pair[1] > pair[0] && has_usable_size(pair[1])) {
            return Err(ArgumentError::order(
                "times",
                "must increase and stay below 1e100",
                times,
                k + 1,
            )
            .into());
        }
    }
    Ok(())
}
