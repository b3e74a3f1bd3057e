//! How many threads work has, and the threads themselves.
//!
//! Nothing here relies on rayon's pool for the whole process. After a fork that pool has no
//! threads, and whoever asks it for anything waits for ever.

use std::cell::Cell;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::{env, mem, process, thread};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{Failure, refused};
use crate::parameters;

/// The package's own variable, and that of the library it shares work by.
const OWN: &str = "SPECTRAL_TV_THREADS";
const RAYON: &str = "RAYON_NUM_THREADS";

/// How often to try for a lock that is never held for long.
const TRIALS: usize = 1000;

/// What `set_threads` was given; 0 for nothing.
static ASKED: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// What `use_threads` was given in this thread; 0 for nothing.
    static ASKED_HERE: Cell<usize> = const { Cell::new(0) };
}

/// Sets how many threads each call and each job has from now on.
///
/// Results do not depend on it.
///
/// Parameters
/// ----------
/// count : int or None
///     At least 1. None: the environment variable SPECTRAL_TV_THREADS; where that is not set,
///     RAYON_NUM_THREADS; or as many as there are processors that this process may use.
///
/// Raises
/// ------
/// MeshError
///     If count is 0, or more than can be.
#[pyfunction]
pub fn set_threads(
    #[pyo3(from_py_with = parameters::count)] count: Option<usize>,
) -> Result<(), Failure> {
    ASKED.store(checked("count", count)?, Ordering::Relaxed);
    Ok(())
}

/// How many threads the next call has, or the next job that is started here.
///
/// Raises
/// ------
/// MeshError
///     If the environment variable SPECTRAL_TV_THREADS is set to anything but such a number.
#[pyfunction]
pub fn threads() -> Result<usize, Failure> {
    let asked = [ASKED_HERE.get(), ASKED.load(Ordering::Relaxed)];
    if let Some(count) = asked.into_iter().find(|&count| count > 0) {
        return Ok(count);
    }
    if let Some(text) = env::var_os(OWN).filter(|text| !text.is_empty()) {
        let count = text.to_str().and_then(|text| text.trim().parse().ok());
        return match count {
            Some(count) => checked(OWN, Some(count)),
            None => Err(refusal(OWN, &format!("{:?}", text.to_string_lossy()))),
        };
    }
    let given = env::var(RAYON).ok().and_then(|text| text.parse().ok());
    Ok(match given {
        Some(count) if count > 0 => count,
        _ => thread::available_parallelism().map_or(1, NonZero::get),
    })
}

/// Has this thread's calls use another number of threads, and tells what it was; None for that of
/// all threads.
#[pyfunction]
pub fn _use_threads(
    #[pyo3(from_py_with = parameters::count)] count: Option<usize>,
) -> Result<Option<usize>, Failure> {
    let before = ASKED_HERE.replace(checked("count", count)?);
    Ok((before > 0).then_some(before))
}

/// The number, 0 for none.
fn checked(name: &str, count: Option<usize>) -> Result<usize, Failure> {
    match count {
        None => Ok(0),
        Some(count) if (1..=rayon::max_num_threads()).contains(&count) => Ok(count),
        Some(count) => Err(refusal(name, &count.to_string())),
    }
}

fn refusal(name: &str, found: &str) -> Failure {
    let most = rayon::max_num_threads();
    refused(format!(
        "{name} must be a number of threads, from 1 to {most}, not {found}"
    ))
}

/// Does long `work` on threads of its own.
///
/// In a pool that several works share, a thread that waits for a part of one work takes up another
/// work from its start. The first could not even be cancelled until the other ends.
///
/// All that is not shared out runs on one of the threads, so that its allocator reuses what has
/// been freed: M3's flow, for example, takes the memory of M3's base.
pub fn by_itself<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    match pool(count, "spectral_tv") {
        Some(pool) => pool.install(work),
        None => alone(work),
    }
}

/// Does short `work` on threads that all of this process's share.
pub fn together<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    match shared(count) {
        Some(shared) => shared.pool.install(work),
        None => by_itself(count, work),
    }
}

/// So many threads of a name; fewer if the system gives no more; `None` if it gives none.
fn pool(mut count: usize, name: &'static str) -> Option<ThreadPool> {
    while count > 0 {
        let threads = ThreadPoolBuilder::new().num_threads(count);
        match threads.thread_name(move |_| name.into()).build() {
            Ok(pool) => return Some(pool),
            Err(_) => count /= 2,
        }
    }
    None
}

/// Does `work` on this thread alone, as a pool of one.
fn alone<T>(work: impl FnOnce() -> T) -> T {
    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    // Where it fails, this thread is in a pool already. It stays in this one.
    mem::forget(pool.build());
    work()
}

/// Threads, and the process that they are in.
struct Shared {
    process: u32,
    count: usize,
    pool: ThreadPool,
}

static SHARED: Mutex<Option<Arc<Shared>>> = Mutex::new(None);

/// The threads that short works of this process share.
fn shared(count: usize) -> Option<Arc<Shared>> {
    let process = process::id();
    let is_right = |found: &Shared| (found.process, found.count) == (process, count);
    let found = (*lock(&SHARED)?).clone();
    if let Some(found) = found.filter(|found| is_right(found)) {
        return Some(found);
    }
    let pool = pool(count, "spectral_shared")?;
    let new = Arc::new(Shared {
        process,
        count,
        pool,
    });
    let former = lock(&SHARED)?.replace(Arc::clone(&new));
    // Those of the process that this one was forked from are not here: nobody could end them.
    if former
        .as_ref()
        .is_some_and(|former| former.process != process)
    {
        mem::forget(former);
    }
    Some(new)
}

/// A lock that is held for moments only; `None` if it is not to be had: in a process that was forked
/// at such a moment its holder is missing.
fn lock<T>(mutex: &Mutex<T>) -> Option<MutexGuard<'_, T>> {
    for _ in 0..TRIALS {
        if let Ok(guard) = mutex.try_lock() {
            return Some(guard);
        }
        thread::yield_now();
    }
    None
}
