//! The system's allocator, and what happens where it has nothing left.

use std::alloc::{GlobalAlloc, Layout, System};
use std::ptr;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::{pages, ration, reuse};

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

// SAFETY: a block is asked for and given back with one layout, by [`pages`] that of [`reuse::large`] for large
// ones, and by the system that which came for others.
#[expect(unsafe_code, reason = "an allocator")]
unsafe impl GlobalAlloc for Heap {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if layout.align() >= pages::SIZE {
            LARGEST_OF_PAGES.fetch_max(layout.size(), Ordering::Relaxed);
        }
        let Some(large) = reuse::large(layout) else {
            // SAFETY: the caller's promise about the layout is passed on.
            return or_in_need(layout.size(), || unsafe { System.alloc(layout) });
        };
        // SAFETY: as above.
        let new = || unsafe { pages::alloc(large) };
        reuse::take(large).unwrap_or_else(|| counted(large, or_in_need(large.size(), new)))
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        let Some(large) = reuse::large(layout) else {
            // SAFETY: as above.
            return or_in_need(layout.size(), || unsafe { System.alloc_zeroed(layout) });
        };
        // SAFETY: as above.
        let new = || unsafe { pages::alloc_zeroed(large) };
        match reuse::take(large) {
            Some(block) => {
                // SAFETY: the block has at least this size.
                unsafe { block.write_bytes(0, layout.size()) };
                block
            }
            None => counted(large, or_in_need(large.size(), new)),
        }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller promises that it is a layout.
        let wanted = unsafe { Layout::from_size_align_unchecked(size, layout.align()) };
        match (reuse::large(layout), reuse::large(wanted)) {
            (None, None) => {
                // SAFETY: as above; where it fails, the block is as it was.
                or_in_need(size, || unsafe { System.realloc(block, layout, size) })
            }
            (Some(before), Some(after)) if before == after => block,
            (Some(before), Some(after)) => {
                let size = after.size();
                // SAFETY: as above.
                let moved = or_in_need(size, || unsafe { pages::realloc(block, before, size) });
                if !moved.is_null() {
                    reuse::count(Some(before), Some(after));
                }
                moved
            }
            _ => {
                // SAFETY: the new block is another one, and both have what is copied.
                unsafe {
                    let moved = self.alloc(wanted);
                    if !moved.is_null() {
                        let common = layout.size().min(size);
                        ptr::copy_nonoverlapping(block, moved, common);
                        self.dealloc(block, layout);
                    }
                    moved
                }
            }
        }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller gives back what it had from here, with its layout.
        unsafe {
            match reuse::large(layout) {
                None => System.dealloc(block, layout),
                Some(large) if reuse::keep(block, large) => {}
                Some(large) => pages::dealloc(block, large),
            }
        }
    }
}

/// The outcome of the attempt, which is made again as long as something is given up for it.
fn or_in_need(size: usize, attempt: impl Fn() -> *mut u8) -> *mut u8 {
    let block = attempt();
    match block.is_null() {
        true => in_need(size, attempt),
        false => block,
    }
}

/// A new block, which is counted out again if there is none.
fn counted(layout: Layout, block: *mut u8) -> *mut u8 {
    if block.is_null() {
        reuse::count(Some(layout), None);
    }
    block
}

/// Gives up kept blocks, then one ration after the other, until the attempt succeeds; null if none is left.
#[cold]
fn in_need(size: usize, attempt: impl Fn() -> *mut u8) -> *mut u8 {
    loop {
        let has_given_up = reuse::free_kept(0) || ration::give_up(size);
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
