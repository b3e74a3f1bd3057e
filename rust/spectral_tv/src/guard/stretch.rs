//! How far an edge may stretch.

use crate::error::{ArgumentError, Result, has_usable_size};

/// How many times its length an edge may become, where nothing else is asked for.
pub const DEFAULT_STRETCH: f64 = 2.5;

/// Refuses what is no limit of stretch.
///
/// # Errors
/// If it is not above 1, or beyond 1e100.
pub(super) fn check_stretch(stretch: f64) -> Result<()> {
    match stretch > 1.0 && has_usable_size(stretch) {
        true => Ok(()),
        false => {
            let rule = "must be above 1, and at most 1e100";
            Err(ArgumentError::value("stretch", rule, stretch).into())
        }
    }
}
