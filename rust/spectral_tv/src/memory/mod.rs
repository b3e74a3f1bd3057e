//! How much memory there is, and large arrays that are refused where it does not suffice.

pub mod needs;

use std::fs;

use crate::error::{Error, Result};

/// Bytes of a number.
pub(crate) const NUMBER: u64 = size_of::<f64>() as u64;

/// Bytes that this process can still take without swapping, where the system tells: the least of
/// what Linux reckons with, and what a limit of the address space leaves. `None` elsewhere.
pub fn available() -> Option<u64> {
    // Wine shows these files to Windows programs, too, and without the limits.
    if !cfg!(target_os = "linux") {
        return None;
    }
    let free = kilobytes(&fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")?;
    let left = || {
        let limits = fs::read_to_string("/proc/self/limits").ok()?;
        let limit = limits
            .lines()
            .find_map(|line| line.strip_prefix("Max address space"))?;
        let limit: u64 = limit.split_whitespace().next()?.parse().ok()?;
        let used = kilobytes(&fs::read_to_string("/proc/self/status").ok()?, "VmSize:")?;
        Some(limit.saturating_sub(used))
    };
    Some(left().map_or(free, |left| free.min(left)))
}

/// The value, in kB, of the line that begins with `name`, in bytes.
fn kilobytes(table: &str, name: &str) -> Option<u64> {
    let line = table.lines().find_map(|line| line.strip_prefix(name))?;
    let value: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(1024 * value)
}

/// Refuses work that takes `needed` bytes if fewer are available; nothing where that is not told.
///
/// `what` begins the message, `advice` ends it.
///
/// # Errors
/// [`Error::Memory`].
pub fn check(needed: u64, what: &str, advice: &str) -> Result<()> {
    match available() {
        Some(available) if needed > available => Err(Error::Memory(format!(
            "{what} takes about {} of memory, but {} are available; {advice}",
            shown(needed),
            shown(available)
        ))),
        _ => Ok(()),
    }
}

/// `count` zeros.
///
/// # Errors
/// [`Error::Memory`] if they are not available, or cannot be had.
pub fn zeros(count: usize, what: &str, advice: &str) -> Result<Vec<f64>> {
    check((count as u64).saturating_mul(NUMBER), what, advice)?;
    checked_zeros(count, what, advice)
}

/// The same where [`check`] was asked before, for all that is needed.
///
/// # Errors
/// [`Error::Memory`] if they cannot be had.
pub(crate) fn checked_zeros(count: usize, what: &str, advice: &str) -> Result<Vec<f64>> {
    let needed = (count as u64).saturating_mul(NUMBER);
    let mut values = Vec::new();
    values.try_reserve_exact(count).map_err(|_| {
        let size = shown(needed);
        Error::Memory(format!(
            "{what} takes {size} of memory, which cannot be had; {advice}"
        ))
    })?;
    values.resize(count, 0.0);
    Ok(values)
}

/// Bytes as a text with two digits or so.
fn shown(bytes: u64) -> String {
    match bytes as f64 {
        bytes if bytes < 1e9 => format!("{:.0} MB", bytes / 1e6),
        bytes if bytes < 1e11 => format!("{:.1} GB", bytes / 1e9),
        bytes => format!("{:.0} GB", bytes / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_the_system_are_read() {
        let table = "MemTotal:  100 kB\nMemAvailable:   24567 kB\n";
        assert_eq!(kilobytes(table, "MemAvailable:"), Some(24567 * 1024));
        assert_eq!(kilobytes(table, "SwapFree:"), None);
        assert_eq!(available().is_some(), cfg!(target_os = "linux"));
    }

    #[test]
    fn what_fits_nowhere_is_refused_with_the_advice() {
        for count in [1 << 55, usize::MAX] {
            match zeros(count, "this array", "take less") {
                Err(Error::Memory(message)) => {
                    assert!(
                        message.starts_with("this array takes") && message.ends_with("take less")
                    );
                }
                other => panic!("{other:?}"),
            }
        }
        assert_eq!(zeros(3, "this array", "take less").unwrap(), [0.0; 3]);
    }
}
