//! Large blocks that work frees are kept while it goes on, for what next asks for as much.
//!
//! The system hands out a page at a time, and takes pages back with a message to every processor. With
//! millions of vertices, a third of a flow's time went there.

use std::alloc::Layout;
use std::process;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::pages;

/// Bytes from which blocks are kept. Of smaller ones, the system's allocator keeps enough by itself.
const LARGE: usize = 1 << 23;
/// Sizes are multiples of one of this many parts of a power of two, so that arrays of nearly the same size
/// have the same.
const PARTS: usize = 64;
/// Bytes that are added before that: those of one number a face and of two a vertex differ by less. What is
/// added is never touched, so it takes addresses only.
const ADDED: usize = 1 << 12;
/// Most blocks that are kept at a time; further ones are freed.
const MOST: usize = 128;

/// Blocks that are free to be used again.
struct Shelf {
    blocks: [Option<Block>; MOST],
    /// Bytes of all of them.
    bytes: usize,
}

struct Block {
    start: *mut u8,
    layout: Layout,
}

// SAFETY: nobody else has the address of a block on the shelf.
#[expect(unsafe_code, reason = "a pointer is not Send by itself")]
unsafe impl Send for Block {}

/// A lock is only ever tried: in a process that was forked, it may be another's.
static SHELF: Mutex<Shelf> = Mutex::new(Shelf {
    blocks: [const { None }; MOST],
    bytes: 0,
});
/// Bytes of all large blocks in use, and the most that they were since work began.
static IN_USE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);
/// How much work goes on, and in which process.
static WORKING: AtomicUsize = AtomicUsize::new(0);
static PROCESS: AtomicUsize = AtomicUsize::new(0);

/// Blocks are kept while one of these exists. All of them are freed with the last.
///
/// Those in use and those kept are together never more than those in use were at their most. So no more
/// memory is taken than without.
#[derive(Debug)]
pub struct Reuse(());

impl Reuse {
    /// Begins to keep blocks.
    #[expect(clippy::new_without_default, reason = "it is a guard")]
    pub fn new() -> Self {
        let process = process::id() as usize;
        if PROCESS.swap(process, Ordering::Relaxed) != process {
            // What worked when this process was forked does not work here.
            WORKING.store(0, Ordering::Relaxed);
        }
        if WORKING.fetch_add(1, Ordering::Relaxed) == 0 {
            PEAK.store(IN_USE.load(Ordering::Relaxed), Ordering::Relaxed);
        }
        Self(())
    }
}

impl Drop for Reuse {
    fn drop(&mut self) {
        if WORKING.fetch_sub(1, Ordering::Relaxed) == 1 {
            free_kept(0);
        }
    }
}

/// The layout of the block that serves `layout`, if that is large.
pub(crate) fn large(layout: Layout) -> Option<Layout> {
    let size = layout.size();
    if size < LARGE || layout.align() > pages::SIZE {
        return None;
    }
    let size = size.checked_add(ADDED)?;
    let part = (1 << size.ilog2()) / PARTS;
    let size = size.checked_next_multiple_of(part)?;
    Layout::from_size_align(size, pages::SIZE).ok()
}

/// A block of a large layout, made of a kept one, and room for a new one under the peak if there is none.
pub(crate) fn take(layout: Layout) -> Option<*mut u8> {
    let kept = SHELF
        .try_lock()
        .ok()
        .and_then(|mut shelf| shelf.take(layout));
    let block = kept.and_then(|kept| kept.resized(layout.size()));
    count(None, Some(layout));
    block
}

/// Keeps a block of a large layout that nobody uses any more; whether it is kept.
pub(crate) fn keep(start: *mut u8, layout: Layout) -> bool {
    count(Some(layout), None);
    WORKING.load(Ordering::Relaxed) > 0
        && SHELF
            .try_lock()
            .is_ok_and(|mut shelf| shelf.put(Block { start, layout }))
}

/// Counts a block out, and another in, and has room for that one under the peak.
pub(crate) fn count(out: Option<Layout>, into: Option<Layout>) {
    let size = |layout: Option<Layout>| layout.map_or(0, |layout| layout.size());
    let in_use = IN_USE.fetch_add(size(into), Ordering::Relaxed) + size(into) - size(out);
    IN_USE.fetch_sub(size(out), Ordering::Relaxed);
    let peak = PEAK.fetch_max(in_use, Ordering::Relaxed).max(in_use);
    if into.is_some() {
        free_kept(peak - in_use);
    }
}

/// Frees kept blocks until they are no more than `most` bytes; whether there was one.
pub(crate) fn free_kept(most: usize) -> bool {
    let mut has_freed = false;
    while let Some(block) = SHELF
        .try_lock()
        .ok()
        .and_then(|mut shelf| shelf.give_up(most))
    {
        // SAFETY: it is a block of this layout, and no longer on the shelf.
        #[expect(unsafe_code, reason = "it goes back to the allocator that it is from")]
        unsafe {
            pages::dealloc(block.start, block.layout);
        }
        has_freed = true;
    }
    has_freed
}

impl Block {
    /// A block of this size; `None` if the system does not have it.
    fn resized(self, size: usize) -> Option<*mut u8> {
        if self.layout.size() == size {
            return Some(self.start);
        }
        // SAFETY: it is a block of this layout, and no longer on the shelf.
        #[expect(unsafe_code, reason = "the allocator that it is from moves its pages")]
        unsafe {
            let moved = pages::realloc(self.start, self.layout, size);
            if moved.is_null() {
                pages::dealloc(self.start, self.layout);
            }
            (!moved.is_null()).then_some(moved)
        }
    }
}

impl Shelf {
    /// A block of this size. Or else the next larger one, or the next smaller one: the system has fewer pages
    /// to find for it than for a new one.
    fn take(&mut self, layout: Layout) -> Option<Block> {
        let size = layout.size();
        let rank = |block: &Block| {
            let kept = block.layout.size();
            let fits = kept == size || pages::CAN_RESIZE;
            fits.then_some((kept < size, kept.abs_diff(size)))
        };
        let blocks = self.blocks.iter_mut().filter(|block| block.is_some());
        let ranked = blocks.filter_map(|block| Some((block.as_ref().and_then(rank)?, block)));
        let (_, best) = ranked.min_by_key(|(rank, _)| *rank)?;
        let block = best.take()?;
        self.bytes -= block.layout.size();
        Some(block)
    }

    fn put(&mut self, block: Block) -> bool {
        let Some(place) = self.blocks.iter_mut().find(|place| place.is_none()) else {
            return false;
        };
        self.bytes += block.layout.size();
        *place = Some(block);
        true
    }

    /// A block, if there are more than `most` bytes.
    fn give_up(&mut self, most: usize) -> Option<Block> {
        if self.bytes <= most {
            return None;
        }
        let block = self.blocks.iter_mut().find_map(Option::take)?;
        self.bytes -= block.layout.size();
        Some(block)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Heap;

    #[global_allocator]
    static HEAP: Heap = Heap;

    fn kept() -> usize {
        SHELF.lock().expect("nobody panics with it").bytes
    }

    fn filled(blocks: usize) -> Vec<u8> {
        vec![7; blocks * LARGE]
    }

    // One test: what is kept is the process's.
    #[test]
    fn freed_blocks_serve_again_while_work_goes_on_and_no_more_than_the_peak_is_taken() {
        drop(filled(1));
        assert_eq!(kept(), 0);
        let (work, other) = (Reuse::new(), Reuse::new());
        let block = filled(2);
        let place = block.as_ptr();
        drop(block);
        assert!(kept() >= 2 * LARGE);

        let zeros = vec![0_u8; 2 * LARGE];
        assert_eq!((zeros.as_ptr(), kept()), (place, 0));
        assert!(zeros.iter().all(|&byte| byte == 0));
        drop(zeros);

        // With their contents blocks grow out of what is kept, and shrink.
        let mut grown: Vec<u8> = (0..LARGE + 1).map(|k| k as u8).collect();
        grown.extend(filled(1));
        grown.shrink_to_fit();
        assert!(
            grown[..=LARGE]
                .iter()
                .enumerate()
                .all(|(k, &byte)| byte == k as u8)
        );
        grown.truncate(10);
        grown.shrink_to_fit();
        assert_eq!(grown, [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);

        // Other sizes: in use and kept are never more than were in use at a time.
        drop([filled(1), filled(3), filled(2)]);
        let peak = || PEAK.load(Ordering::Relaxed);
        let first = peak();
        for sizes in [[1, 1, 1], [4, 1, 1], [2, 2, 2], [5, 1, 0]] {
            let blocks = sizes.map(filled);
            assert!(IN_USE.load(Ordering::Relaxed) + kept() <= peak());
            for (block, size) in blocks.iter().zip(sizes) {
                assert!(block.len() == size * LARGE && block.iter().all(|&byte| byte == 7));
            }
        }
        assert!(peak() - first < LARGE / 10);
        if pages::CAN_RESIZE {
            assert!(kept() > 5 * LARGE);
        }
        assert!(free_kept(0));
        assert!(!free_kept(0));

        drop(filled(1));
        drop(work);
        assert!(kept() > 0);
        drop(other);
        assert_eq!(kept(), 0);
    }
}
