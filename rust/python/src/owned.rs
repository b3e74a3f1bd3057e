//! What keeps a state between calls: one thread of one process works on it at a time.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use std::{process, thread};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use spectral_tv::monitor::Stage;

/// What keeps a state between calls, and the process whose thread is at work on it.
///
/// A fork copies a lock that another thread holds, but not the thread: nobody would ever unlock it.
pub struct Owned<T> {
    /// 0 for nobody.
    owner: AtomicU32,
    inner: Mutex<T>,
}

/// How often to look whether other work has ended.
const POLL: Duration = Duration::from_millis(1);

impl<T: Send + 'static> Owned<T> {
    pub fn new(inner: T) -> Self {
        Self {
            owner: AtomicU32::new(0),
            inner: Mutex::new(inner),
        }
    }

    /// Refuses where work on it is in another process, and will not end in this one.
    fn check(&self) -> PyResult<()> {
        let owner = self.owner.load(Ordering::Acquire);
        match owner == 0 || owner == process::id() {
            true => Ok(()),
            false => Err(PyRuntimeError::new_err(format!(
                "process {owner}, of which this one is a fork, was at work on this object at the \
                 time; make a new one here"
            ))),
        }
    }

    /// Takes it unless other work has.
    fn try_take(self: &Arc<Self>) -> Option<Taken<T>> {
        let (from, to) = (Ordering::AcqRel, Ordering::Relaxed);
        let taken = self.owner.compare_exchange(0, process::id(), from, to);
        taken.is_ok().then(|| Taken(Arc::clone(self)))
    }

    /// Takes it once other work has ended; Ctrl-C ends the wait.
    pub fn take(self: &Arc<Self>, py: Python<'_>) -> PyResult<Taken<T>> {
        loop {
            self.check()?;
            if let Some(taken) = self.try_take() {
                return Ok(taken);
            }
            py.check_signals()?;
            py.detach(|| thread::sleep(POLL));
        }
    }

    /// The same for a job, from when it starts; where other work is still at it, once that has ended.
    pub fn take_for_job(
        self: &Arc<Self>,
    ) -> PyResult<impl FnOnce(Stage) -> spectral_tv::Result<Taken<T>> + use<T>> {
        self.check()?;
        let (owned, mut taken) = (Arc::clone(self), self.try_take());
        Ok(move |stage: Stage| {
            loop {
                if let Some(taken) = taken {
                    return Ok(taken);
                }
                stage.check()?;
                thread::sleep(POLL);
                taken = owned.try_take();
            }
        })
    }
}

/// One that nobody else is at work on, until this is dropped.
pub struct Taken<T>(Arc<Owned<T>>);

impl<T> Taken<T> {
    pub fn get(&self) -> MutexGuard<'_, T> {
        // A panic leaves it in a state that the next solution overwrites.
        let inner = self.0.inner.lock();
        inner.unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T> Drop for Taken<T> {
    fn drop(&mut self) {
        self.0.owner.store(0, Ordering::Release);
    }
}
