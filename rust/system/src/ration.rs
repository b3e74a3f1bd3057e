//! Memory that is set aside. If the system has no more, work goes on with it to where it can end.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// Most rations at a time; further ones are not kept.
const MOST: usize = 64;

/// Bytes that are kept for those who have no ration, such as what writes an error's message.
const LITTLE: usize = 1 << 22;

/// A block that is set aside, and whom to tell when it is given up.
struct Kept {
    block: Untouched,
    is_spent: Option<Arc<AtomicBool>>,
}

/// A block that nobody writes to. It is the system's own, so that [`crate::Reuse`] does not take it for
/// memory in use.
struct Untouched {
    start: *mut u8,
    layout: Layout,
}

impl Untouched {
    /// `None` if the system does not have it.
    fn new(bytes: usize) -> Option<Self> {
        let layout = Layout::array::<u8>(bytes.max(1)).ok()?;
        // SAFETY: the layout has a byte or more.
        #[expect(unsafe_code, reason = "a block of the system's")]
        let start = unsafe { System.alloc(layout) };
        // Or the compiler takes it out, as nobody uses it.
        let start = black_box(start);
        (!start.is_null()).then_some(Self { start, layout })
    }
}

impl Drop for Untouched {
    fn drop(&mut self) {
        // SAFETY: the block is the system's, of this layout.
        #[expect(unsafe_code, reason = "a block of the system's")]
        unsafe {
            System.dealloc(self.start, self.layout);
        }
    }
}

// SAFETY: nobody else has the address.
#[expect(unsafe_code, reason = "a pointer is not Send by itself")]
unsafe impl Send for Untouched {}

/// All of them. A lock is only ever tried: in a process that was forked, it may be another's.
static KEPT: [Mutex<Option<Kept>>; MOST] = [const { Mutex::new(None) }; MOST];

/// The place of what [`keep_a_little`] keeps.
const LITTLE_PLACE: usize = 0;

thread_local! {
    /// Whether this thread can do without what it asks for.
    static CAN_DO_WITHOUT: Cell<bool> = const { Cell::new(false) };
}

/// Memory that is set aside, until it is dropped or [`crate::Heap`] has nothing else left.
///
/// No more than addresses, or a promise of the system's, until it is used.
#[derive(Debug)]
pub struct Ration {
    place: Option<usize>,
}

impl Ration {
    /// Sets `bytes` aside; `is_spent` becomes true when they are given up. `None` if the system
    /// does not have them.
    pub fn new(bytes: usize, is_spent: Arc<AtomicBool>) -> Option<Self> {
        let kept = Kept {
            block: Untouched::new(bytes)?,
            is_spent: Some(is_spent),
        };
        let place = (LITTLE_PLACE + 1..MOST).find(|&place| is_free(place));
        Some(Self {
            place: place.and_then(|place| keep(place, kept)),
        })
    }
}

impl Drop for Ration {
    fn drop(&mut self) {
        if let Some(place) = self.place
            && let Ok(mut kept) = KEPT[place].try_lock()
        {
            *kept = None;
        }
    }
}

/// Sets a little aside for all who have no ration, unless it is there; whether it could.
pub fn keep_a_little() -> bool {
    let keep_block = |block| {
        let is_spent = None;
        keep(LITTLE_PLACE, Kept { block, is_spent });
    };
    !is_free(LITTLE_PLACE) || Untouched::new(LITTLE).map(keep_block).is_some()
}

/// Whether the system promises `bytes`. It may promise more than it has.
pub fn is_promised(bytes: usize) -> bool {
    Untouched::new(bytes).is_some()
}

/// A vector with room for `count` elements; `None` if the system does not have it. No ration is
/// given up for it.
pub fn room<T>(count: usize) -> Option<Vec<T>> {
    let mut values = Vec::new();
    let before = CAN_DO_WITHOUT.replace(true);
    let outcome = values.try_reserve_exact(count);
    CAN_DO_WITHOUT.set(before);
    outcome.ok().map(|()| values)
}

/// Gives up the smallest ration of `size` bytes or more, or the largest one; whether there was one
/// to give up.
///
/// Called by the allocator: takes no memory, and does not wait.
pub(crate) fn give_up(size: usize) -> bool {
    if CAN_DO_WITHOUT.try_with(Cell::get).unwrap_or(false) {
        return false;
    }
    let size_of = |place: usize| {
        let kept = KEPT[place].try_lock().ok()?;
        kept.as_ref().map(|kept| kept.block.layout.size())
    };
    let mut best: Option<(usize, usize)> = None;
    for place in 0..MOST {
        let Some(found) = size_of(place) else {
            continue;
        };
        let is_better = match best {
            None => true,
            Some((_, best)) if best < size => found > best,
            Some((_, best)) => found >= size && found < best,
        };
        if is_better {
            best = Some((place, found));
        }
    }
    let Some((place, _)) = best else {
        return false;
    };
    let kept = KEPT[place].try_lock().ok().and_then(|mut kept| kept.take());
    if let Some(is_spent) = kept.and_then(|kept| kept.is_spent) {
        is_spent.store(true, Ordering::Relaxed);
    }
    // Even if another thread was faster: it has freed something.
    true
}

fn is_free(place: usize) -> bool {
    KEPT[place].try_lock().is_ok_and(|kept| kept.is_none())
}

/// Puts a block at a place that was free, and tells the place, unless another was faster.
fn keep(place: usize, block: Kept) -> Option<usize> {
    let mut kept = KEPT[place].try_lock().ok()?;
    match *kept {
        None => {
            *kept = Some(block);
            Some(place)
        }
        Some(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ration(bytes: usize) -> (Ration, Arc<AtomicBool>) {
        let is_spent = Arc::new(AtomicBool::new(false));
        let ration = Ration::new(bytes, Arc::clone(&is_spent));
        (ration.expect("a few bytes"), is_spent)
    }

    // One test: what is kept is the process's.
    #[test]
    fn the_smallest_that_is_enough_is_given_up_first_and_its_owner_told() {
        assert!(!give_up(1));
        let sizes = [1 << 12, 1 << 14, 1 << 13];
        let [small, large, medium] = sizes.map(ration);
        let spent = || [&small, &medium, &large].map(|(_, spent)| spent.load(Ordering::Relaxed));
        assert!(give_up(5000));
        assert_eq!(spent(), [false, true, false]);
        assert!(give_up(1 << 30));
        assert_eq!(spent(), [false, true, true]);
        assert!(keep_a_little());
        assert!(give_up(1 << 20));
        assert_eq!(spent(), [false, true, true]);
        drop(small);
        assert!(!give_up(1));

        let mut many: Vec<_> = (0..2 * MOST).map(|_| ration(16)).collect();
        many.truncate(0);
        assert!(!give_up(1));

        let nothing: Option<Vec<u64>> = room(usize::MAX);
        assert!(nothing.is_none());
        assert!(Ration::new(usize::MAX, Arc::default()).is_none());
        assert!(room::<u64>(10).is_some_and(|room| room.capacity() >= 10));
    }
}
