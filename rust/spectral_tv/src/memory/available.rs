//! The memory that is available: what the system has free, within the limits of this process and of
//! its container.

/// Bytes that this process can still take without swapping, where the system tells: the least of
/// what is free on the machine, what the limits of its address space and of its data leave, and
/// what those of its control groups do, such as a container's.
#[cfg(target_os = "linux")]
pub fn available() -> Option<u64> {
    linux::available()
}

/// Bytes that this process can still take without swapping, where the system tells.
#[cfg(not(target_os = "linux"))]
pub fn available() -> Option<u64> {
    spectral_tv_system::free_memory()
}

#[cfg(target_os = "linux")]
mod linux {
    use std::fs;

    use crate::memory::control_groups;

    /// The limits of a process in `/proc/self/limits`, and the entries of `status` that they limit.
    const LIMITS: [(&str, &str); 2] = [
        ("Max address space", "VmSize:"),
        ("Max data size", "VmData:"),
    ];

    pub fn available() -> Option<u64> {
        let free = kilobytes(&read("/proc/meminfo")?, "MemAvailable:")?;
        let limits = read("/proc/self/limits").unwrap_or_default();
        let status = read("/proc/self/status").unwrap_or_default();
        let left = LIMITS
            .iter()
            .filter_map(|(name, used)| left(&limits, name, &status, used));
        let groups = read("/proc/self/cgroup").zip(read("/proc/self/mountinfo"));
        let of_groups = groups.and_then(|(groups, mounts)| control_groups::left(&groups, &mounts));
        left.chain(of_groups).chain([free]).min()
    }

    fn read(path: &str) -> Option<String> {
        fs::read_to_string(path).ok()
    }

    /// What a limit of the table `limits` leaves of it, in bytes; `None` where there is none.
    fn left(limits: &str, name: &str, status: &str, used: &str) -> Option<u64> {
        let limit = limits.lines().find_map(|line| line.strip_prefix(name))?;
        let limit: u64 = limit.split_whitespace().next()?.parse().ok()?;
        Some(limit.saturating_sub(kilobytes(status, used)?))
    }

    /// The value, in kB, of the line that begins with `name`, in bytes.
    fn kilobytes(table: &str, name: &str) -> Option<u64> {
        let line = table.lines().find_map(|line| line.strip_prefix(name))?;
        let value: u64 = line.split_whitespace().next()?.parse().ok()?;
        Some(1024 * value)
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn tables_of_the_system_are_read() {
            let table = "MemTotal:  100 kB\nMemAvailable:   24567 kB\n";
            assert_eq!(kilobytes(table, "MemAvailable:"), Some(24567 * 1024));
            assert_eq!(kilobytes(table, "SwapFree:"), None);
            let limits = "Max data size  5000  unlimited  bytes\n\
                          Max address space  unlimited  unlimited  bytes\n";
            let status = "VmSize:\t 4 kB\nVmData:\t 3 kB\n";
            let [space, data] = LIMITS.map(|(name, used)| left(limits, name, status, used));
            assert_eq!((space, data), (None, Some(5000 - 3 * 1024)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_system_that_is_supported_tells() {
        let known = cfg!(any(target_os = "linux", target_os = "macos", windows));
        assert_eq!(available().is_some(), known);
    }
}
