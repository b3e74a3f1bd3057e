//! How much memory is free, by the functions of systems that have no file to read it from.

/// Bytes that are free, or could be freed without losing anything but time. `None` where this
/// system is not known, or has files that tell: Linux.
pub fn free_memory() -> Option<u64> {
    system::free_memory()
}

#[cfg(windows)]
#[expect(unsafe_code, reason = "a foreign function")]
mod system {
    /// MEMORYSTATUSEX of the Windows API.
    #[repr(C)]
    #[derive(Default)]
    struct MemoryStatus {
        length: u32,
        load: u32,
        total_physical: u64,
        free_physical: u64,
        total_page_file: u64,
        free_page_file: u64,
        total_virtual: u64,
        free_virtual: u64,
        free_extended_virtual: u64,
    }

    #[link(name = "kernel32")]
    unsafe extern "system" {
        fn GlobalMemoryStatusEx(status: *mut MemoryStatus) -> i32;
    }

    pub fn free_memory() -> Option<u64> {
        let mut status = MemoryStatus {
            length: size_of::<MemoryStatus>() as u32,
            ..MemoryStatus::default()
        };
        // SAFETY: it fills in a structure of the length that it says.
        let succeeded = unsafe { GlobalMemoryStatusEx(&raw mut status) } != 0;
        // The page file's is what the system still promises to this process, whether there is
        // memory for it or not.
        succeeded.then(|| {
            let free = status.free_physical.min(status.free_page_file);
            free.min(status.free_virtual)
        })
    }
}

#[cfg(target_os = "macos")]
#[expect(unsafe_code, reason = "foreign functions")]
mod system {
    use std::mem::MaybeUninit;

    pub fn free_memory() -> Option<u64> {
        let mut statistics = MaybeUninit::<libc::vm_statistics64>::zeroed();
        let mut count = libc::HOST_VM_INFO64_COUNT;
        // SAFETY: it fills in at most `count` integers, which the structure has room for; zeros
        // are valid numbers.
        let (outcome, statistics) = unsafe {
            #[expect(
                deprecated,
                reason = "what it moved to is another crate, for one function"
            )]
            let host = libc::mach_host_self();
            let into = statistics.as_mut_ptr().cast();
            let outcome = libc::host_statistics64(host, libc::HOST_VM_INFO64, into, &raw mut count);
            (outcome, statistics.assume_init())
        };
        // SAFETY: any argument does.
        let page = u64::try_from(unsafe { libc::sysconf(libc::_SC_PAGESIZE) }).ok()?;
        // Those that are kept for files count among the inactive ones.
        let pages = u64::from(statistics.free_count) + u64::from(statistics.inactive_count);
        (outcome == libc::KERN_SUCCESS).then_some(page * pages)
    }
}

#[cfg(not(any(windows, target_os = "macos")))]
mod system {
    pub fn free_memory() -> Option<u64> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_free_is_known_where_it_has_to_be_asked_for() {
        let free = free_memory();
        assert_eq!(free.is_some(), cfg!(any(windows, target_os = "macos")));
        assert!(free.is_none_or(|bytes| bytes > 1 << 20));
    }
}
