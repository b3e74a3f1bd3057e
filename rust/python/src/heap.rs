//! Memory that finished work has freed, for the system to have back.

/// Has the C library return to the system what was freed. glibc alone keeps much of it: of a
/// decomposition of 400 000 vertices a gigabyte, and the next one peaks so much higher. Where the
/// host has another allocator, there is next to nothing to return.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    glibc::malloc_trim(0);
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[expect(unsafe_code, reason = "the one foreign function; any argument does")]
mod glibc {
    use std::ffi::c_int;

    unsafe extern "C" {
        pub safe fn malloc_trim(pad: usize) -> c_int;
    }
}
