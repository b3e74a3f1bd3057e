//! What a caller may ask of an iteration.

use crate::error::{Error, Result};

/// Refuses a relative tolerance that is not in (0, 1).
///
/// # Errors
/// [`Error::Argument`].
pub fn check_tolerance(tolerance: f64) -> Result<()> {
    if tolerance > 0.0 && tolerance < 1.0 {
        return Ok(());
    }
    Err(Error::Argument(format!(
        "tolerance must be between 0 and 1, not {tolerance:?}"
    )))
}
