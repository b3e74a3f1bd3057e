//! Checks the tolerance that a caller asks of an iteration.

use crate::error::{ArgumentError, Result};

/// What rounding leaves of a relative error; less cannot be asked for.
const LEAST: f64 = 1e-15;

/// Refuses a relative tolerance that is not in [1e-15, 1).
///
/// # Errors
/// [`crate::Error::Argument`].
pub fn check_tolerance(tolerance: f64) -> Result<()> {
    let refused = |rule: String| {
        ArgumentError::value("tolerance", rule, format_args!("{tolerance:?}")).into()
    };
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(refused("must be between 0 and 1".into()));
    }
    if tolerance < LEAST {
        return Err(refused(format!(
            "must be at least {LEAST:e}, which rounding leaves"
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_below_rounding_are_refused() {
        for tolerance in [1e-15, 1e-3, 0.999] {
            assert!(check_tolerance(tolerance).is_ok());
        }
        for tolerance in [3e-312, 9e-16, 0.0, -1e-3, 1.0, f64::NAN, f64::INFINITY] {
            assert!(check_tolerance(tolerance).is_err());
        }
    }
}
