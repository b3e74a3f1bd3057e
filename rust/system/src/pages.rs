//! Where large blocks come from: on Linux pages of their own, which it moves to a block of another size without
//! copying them; elsewhere the system's allocator.

use std::alloc::Layout;

/// Bytes of a page. Blocks are aligned to it.
pub(crate) const SIZE: usize = 4096;
/// Whether blocks can get another size at little cost.
pub(crate) const CAN_RESIZE: bool = cfg!(target_os = "linux");

#[cfg(target_os = "linux")]
#[expect(unsafe_code, reason = "foreign functions")]
mod source {
    use super::*;
    use std::ptr;

    pub unsafe fn alloc_zeroed(layout: Layout) -> *mut u8 {
        let (access, kind) = (
            libc::PROT_READ | libc::PROT_WRITE,
            libc::MAP_PRIVATE | libc::MAP_ANONYMOUS,
        );
        // SAFETY: it asks for new pages.
        block(unsafe { libc::mmap(ptr::null_mut(), layout.size(), access, kind, -1, 0) })
    }

    /// The same: pages are zeros at first.
    pub unsafe fn alloc(layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise is passed on.
        unsafe { alloc_zeroed(layout) }
    }

    pub unsafe fn realloc(start: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller promises that these pages are a block's.
        block(unsafe { libc::mremap(start.cast(), layout.size(), size, libc::MREMAP_MAYMOVE) })
    }

    pub unsafe fn dealloc(start: *mut u8, layout: Layout) {
        // SAFETY: as above. It fails only where a block is cut out of others and there are too many of them;
        // nothing can be done then.
        unsafe { libc::munmap(start.cast(), layout.size()) };
    }

    fn block(start: *mut libc::c_void) -> *mut u8 {
        match start == libc::MAP_FAILED {
            true => ptr::null_mut(),
            false => start.cast(),
        }
    }
}

#[cfg(not(target_os = "linux"))]
#[expect(unsafe_code, reason = "an allocator")]
mod source {
    use super::*;
    use std::alloc::{GlobalAlloc, System};

    pub unsafe fn alloc_zeroed(layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc_zeroed(layout) }
    }

    pub unsafe fn alloc(layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    pub unsafe fn realloc(start: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        unsafe { System.realloc(start, layout, size) }
    }

    pub unsafe fn dealloc(start: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(start, layout) };
    }
}

pub(crate) use source::{alloc, alloc_zeroed, dealloc, realloc};
