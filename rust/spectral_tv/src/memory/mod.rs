//! How much memory there is. Large arrays are refused if it does not suffice.

mod available;
#[cfg(target_os = "linux")]
mod control_groups;
pub mod needs;

use spectral_tv_system::{is_promised, room};

pub use available::available;

use crate::error::{Error, Result};

/// Bytes of a number.
pub(crate) const NUMBER: u64 = size_of::<f64>() as u64;

/// Refuses work that takes `needed` bytes if fewer are available; nothing where that is not told.
///
/// `what` begins the message, `advice` ends it.
///
/// # Errors
/// [`Error::Memory`].
pub(crate) fn check(needed: u64, what: &str, advice: &str) -> Result<()> {
    match available() {
        Some(available) if needed > available => Err(Error::Memory(format!(
            "{what} takes about {} of memory, but {} are available; {advice}",
            shown(needed),
            shown(available)
        ))),
        _ => Ok(()),
    }
}

/// Refuses work that takes `needed` bytes if the system does not promise them. It may promise more
/// than it has.
///
/// # Errors
/// [`Error::Memory`].
pub(crate) fn check_promise(needed: u64, what: &str, advice: &str) -> Result<()> {
    match usize::try_from(needed).is_ok_and(is_promised) {
        true => Ok(()),
        false => Err(refusal(needed, what, advice)),
    }
}

/// The message where the system does not give `needed` bytes.
pub(crate) fn refusal(needed: u64, what: &str, advice: &str) -> Error {
    Error::Memory(format!(
        "{what} takes about {} of memory, which cannot be had; {advice}",
        shown(needed)
    ))
}

/// A vector with room for `count` elements, to be filled and no more.
///
/// # Errors
/// [`Error::Memory`] if it cannot be had.
pub fn vector<T>(count: usize, what: &str, advice: &str) -> Result<Vec<T>> {
    let needed = (count as u64).saturating_mul(size_of::<T>() as u64);
    room(count).ok_or_else(|| refusal(needed, what, advice))
}

/// `count` zeros.
///
/// # Errors
/// [`Error::Memory`] if they cannot be had.
pub fn zeros<N: Clone + Default>(count: usize, what: &str, advice: &str) -> Result<Vec<N>> {
    let mut values = vector(count, what, advice)?;
    values.resize(count, N::default());
    Ok(values)
}

/// Bytes as a text with two digits or so.
fn shown(bytes: u64) -> String {
    match bytes as f64 {
        bytes if bytes < 5e5 => format!("{:.0} kB", bytes / 1e3),
        bytes if bytes < 1e9 => format!("{:.0} MB", bytes / 1e6),
        bytes if bytes < 1e11 => format!("{:.1} GB", bytes / 1e9),
        bytes => format!("{:.0} GB", bytes / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fits_nowhere_is_refused_with_the_advice() {
        let refused = |outcome: Result<()>| match outcome {
            Err(Error::Memory(message)) => {
                assert!(message.starts_with("this array takes") && message.ends_with("take less"));
            }
            other => panic!("{other:?}"),
        };
        for count in [1 << 55, usize::MAX] {
            refused(zeros::<f64>(count, "this array", "take less").map(drop));
            refused(check(count as u64, "this array", "take less"));
            refused(check_promise(count as u64, "this array", "take less"));
        }
        assert_eq!(
            zeros::<f64>(3, "this array", "take less").unwrap(),
            [0.0; 3]
        );
        check(3, "this array", "take less").unwrap();
        check_promise(3, "this array", "take less").unwrap();
    }
}
