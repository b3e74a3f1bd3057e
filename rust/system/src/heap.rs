//! The system's allocator, and what happens where it has nothing left.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::ration;

/// What an array of whole pages is aligned to.
const PAGE: usize = 4096;

static LARGEST_OF_PAGES: AtomicUsize = AtomicUsize::new(0);

/// The largest array of whole pages that [`Heap`] was asked for, in bytes.
pub fn largest_of_pages() -> usize {
    LARGEST_OF_PAGES.load(Ordering::Relaxed)
}

/// The system's allocator; where it has nothing left, the [`crate::Ration`]s are used up.
///
/// Rust ends the process where an allocation fails, and an allocator may not unwind. So it must not
/// fail: it is served from what was set aside, and whoever did that learns that its work has to
/// end.
pub struct Heap;

// SAFETY: every block is the system's own, asked for and given back with the layout that came.
#[expect(unsafe_code, reason = "an allocator")]
unsafe impl GlobalAlloc for Heap {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if layout.align() >= PAGE {
            LARGEST_OF_PAGES.fetch_max(layout.size(), Ordering::Relaxed);
        }
        // SAFETY: the caller's promise about the layout is passed on.
        let attempt = || unsafe { System.alloc(layout) };
        let block = attempt();
        match block.is_null() {
            true => in_need(layout.size(), attempt),
            false => block,
        }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        let attempt = || unsafe { System.alloc_zeroed(layout) };
        let block = attempt();
        match block.is_null() {
            true => in_need(layout.size(), attempt),
            false => block,
        }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above; where it fails, the block is as it was.
        let attempt = || unsafe { System.realloc(block, layout, size) };
        let moved = attempt();
        match moved.is_null() {
            true => in_need(size, attempt),
            false => moved,
        }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(block, layout) };
    }
}

/// Gives up one ration after the other until the attempt succeeds; null if none is left.
#[cold]
fn in_need(size: usize, attempt: impl Fn() -> *mut u8) -> *mut u8 {
    loop {
        let has_given_up = ration::give_up(size);
        // Without one: what another thread has given up may do.
        let block = attempt();
        if !block.is_null() || !has_given_up {
            return block;
        }
    }
}

/// Has the C library return to the system what was freed. glibc alone keeps much of it: of a
/// decomposition of 400 000 vertices a gigabyte, and the next one peaks so much higher. Where the
/// host has another allocator, there is next to nothing to return.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    glibc::malloc_trim(0);
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[expect(unsafe_code, reason = "a foreign function; any argument does")]
mod glibc {
    use std::ffi::c_int;

    unsafe extern "C" {
        pub safe fn malloc_trim(pad: usize) -> c_int;
    }
}
