//! The scratch memory of faer's matrix products, on every thread: two arrays of the size that faer
//! assumes for the processor's last cache. That is some dozens of megabytes, of which little is
//! used.
//!
//! faer makes them at the first product of a thread, and ends the process if it cannot. So every
//! thread makes them before it needs them, if there is room for all.

use std::cell::Cell;
use std::thread;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use spectral_tv_system::{largest_of_pages, room};

use crate::error::Result;
use crate::memory::check_promise;
use crate::monitor::Stage;

/// For refusals.
const WHAT: &str = "what threads take to multiply matrices";
const ADVICE: &str = "take fewer threads, or a smaller mesh";

/// Bytes of them where it is not known yet: larger than most.
const UNKNOWN: usize = 1 << 28;
/// Bytes on processors for which it has other ways.
const OTHER: usize = 1 << 24;

/// Rows of matrices whose product takes them.
const ROWS: usize = 64;

thread_local! {
    /// Whether this thread has its own.
    static IS_READY: Cell<bool> = const { Cell::new(false) };
}

/// Has every thread of this pool make its own.
///
/// # Errors
/// [`crate::Error::Memory`] if they cannot all be had, [`crate::Error::Cancelled`].
pub(super) fn prepare(stage: Stage) -> Result<()> {
    let ready = rayon::broadcast(|_| IS_READY.get());
    let missing = ready.iter().filter(|is_ready| !**is_ready).count();
    if missing > 0 {
        check(missing)?;
        rayon::broadcast(|_| multiply());
    }
    stage.check()
}

/// Refuses work on so many new threads if these cannot make their own.
///
/// # Errors
/// [`crate::Error::Memory`].
pub(super) fn check(threads: usize) -> Result<()> {
    let needed = threads.saturating_mul(bytes());
    check_promise(needed as u64, WHAT, ADVICE)
}

/// Finds out how large they are on this machine, which takes some milliseconds and a thread. To be
/// called before a process is forked that may be at it.
pub fn warm_up() {
    if room::<u8>(UNKNOWN).is_some() {
        let spawned = thread::Builder::new().spawn(multiply);
        // Where there are no threads, there is nothing to prepare for.
        let _ = spawned.map(thread::JoinHandle::join);
    }
}

fn bytes() -> usize {
    match (largest_of_pages(), cfg!(target_arch = "x86_64")) {
        (0, true) => UNKNOWN,
        (0, false) => OTHER,
        (known, _) => known,
    }
}

fn multiply() {
    let matrix = Mat::<f64>::identity(ROWS, ROWS);
    let mut product = Mat::zeros(ROWS, ROWS);
    matmul(
        &mut product,
        Accum::Replace,
        &matrix,
        &matrix,
        1.0,
        Par::Seq,
    );
    std::hint::black_box(product);
    IS_READY.set(true);
}
