//! Work in a thread of its own, which never touches Python, and the class `Job` to poll it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{mem, process, thread};

use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyType;
use spectral_tv::Error;
use spectral_tv::monitor::{Monitor, Stage};
use spectral_tv_system::{Reuse, give_back};

use crate::error::Failure;
use crate::threads::{by_itself, threads, together};

/// Work that takes longer may have taken much memory.
const LONG: Duration = Duration::from_millis(500);

/// How often a waiting call looks for Ctrl-C and reports progress.
const POLL: Duration = Duration::from_millis(30);

/// How often to look whether another thread has made an object of a result.
const BRIEFLY: Duration = Duration::from_millis(1);

/// What a thread leaves when it is done; the outer error is a panic's message.
type Outcome<T> = Result<spectral_tv::Result<T>, String>;

/// Where a thread leaves its outcome, to be taken once.
struct Outbox<T> {
    outcome: Mutex<Option<Outcome<T>>>,
    is_filled: AtomicBool,
    filled: Condvar,
}

/// Work that runs in a thread.
pub struct Task<T> {
    monitor: Arc<Monitor>,
    outbox: Arc<Outbox<T>>,
    /// The process that has the thread; not another that was forked from it.
    process: u32,
}

impl<T: Send + 'static> Task<T> {
    /// Starts `work` on threads of its own.
    pub fn start(
        work: impl FnOnce(&Monitor) -> spectral_tv::Result<T> + Send + 'static,
    ) -> Result<Self, Failure> {
        Self::spawn(|count, monitor| by_itself(count, || work(monitor)))
    }

    /// Starts `work`, which is told how many threads it has.
    fn spawn(
        work: impl FnOnce(usize, &Monitor) -> spectral_tv::Result<T> + Send + 'static,
    ) -> Result<Self, Failure> {
        let count = threads()?;
        let monitor = Arc::new(Monitor::new());
        let outbox = Arc::new(Outbox {
            outcome: Mutex::new(None),
            is_filled: AtomicBool::new(false),
            filled: Condvar::new(),
        });
        let (watched, leave) = (Arc::clone(&monitor), Arc::clone(&outbox));
        let spawned = thread::Builder::new()
            .name("spectral_tv".into())
            .spawn(move || {
                let started = Instant::now();
                let work = || {
                    let _kept = Reuse::new();
                    work(count, &watched)
                };
                let outcome = catch_unwind(AssertUnwindSafe(work));
                watched.end();
                // Nobody may be waiting any more; the outcome is then dropped.
                leave.fill(outcome.map_err(|panic| panic_message(&*panic)));
                drop(leave);
                if started.elapsed() > LONG {
                    give_back();
                }
            });
        if let Err(error) = spawned {
            let message = format!("the system gives no thread for the work: {error}");
            return Err(Error::Memory(message).into());
        }
        Ok(Self {
            monitor,
            outbox,
            process: process::id(),
        })
    }

    /// Waits without the GIL; `progress` is called with the fraction done. A signal such as
    /// Ctrl-C or an exception from `progress` cancels the work and is passed on.
    pub fn wait(&self, py: Python<'_>, progress: Option<&Bound<'_, PyAny>>) -> Result<T, Failure> {
        match self.poll(py, progress, |timeout| self.receive(timeout)) {
            Ok(outcome) => {
                let result = finish(outcome)?;
                tell(progress, 1.0)?;
                Ok(result)
            }
            Err(interruption) => {
                self.monitor.cancel();
                // The thread ends at its next check; what it made is dropped.
                while let Ok(None) = py.detach(|| self.receive(POLL)) {}
                Err(interruption)
            }
        }
    }

    /// Looks without the GIL until there is something; meanwhile tells `progress` the fraction done.
    fn poll<U: Send>(
        &self,
        py: Python<'_>,
        progress: Option<&Bound<'_, PyAny>>,
        look: impl Fn(Duration) -> Result<Option<U>, Missing> + Sync,
    ) -> Result<U, Failure> {
        if let Some(progress) = progress.filter(|progress| !progress.is_callable()) {
            let message = format!("progress must be callable, not {}", progress.repr()?);
            return Err(PyTypeError::new_err(message).into());
        }
        loop {
            if let Some(found) = py.detach(|| look(POLL))? {
                return Ok(found);
            }
            py.check_signals()?;
            tell(progress, self.monitor.fraction())?;
        }
    }

    /// The outcome, if it comes within `timeout`; it is handed out once. Who cancels does not wait
    /// for the thread to free what it took.
    fn receive(&self, timeout: Duration) -> Result<Option<Outcome<T>>, Missing> {
        let outbox = &*self.outbox;
        if self.process != process::id() {
            // Locks of the thread that is missing are not waited for.
            let is_filled = outbox.is_filled.load(Ordering::Acquire);
            let outcome = is_filled.then(|| outbox.outcome.try_lock().ok()?.take());
            return outcome.flatten().map(Some).ok_or(Missing(self.process));
        }
        let outcome = outbox
            .outcome
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let waited = outbox
            .filled
            .wait_timeout_while(outcome, timeout, |outcome| outcome.is_none());
        let (mut outcome, _) = waited.unwrap_or_else(PoisonError::into_inner);
        Ok(match outcome.take() {
            None if self.monitor.has_stopped() => Some(Ok(Err(Error::Cancelled))),
            outcome => outcome,
        })
    }
}

fn tell(progress: Option<&Bound<'_, PyAny>>, fraction: f64) -> PyResult<()> {
    match progress {
        Some(progress) => progress.call1((fraction,)).map(drop),
        None => Ok(()),
    }
}

impl<T> Outbox<T> {
    fn fill(&self, outcome: Outcome<T>) {
        *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
        self.is_filled.store(true, Ordering::Release);
        self.filled.notify_all();
    }
}

/// The thread is in another process, of this number: a fork copies none.
struct Missing(u32);

impl From<Missing> for Failure {
    fn from(Missing(process): Missing) -> Self {
        let message = format!(
            "the work was started in process {process}, of which this one is a fork, and goes on \
             there alone: start it anew here"
        );
        PyRuntimeError::new_err(message).into()
    }
}

/// Short work without the GIL, a panic in it turned into an exception as in a [`Task`].
pub fn guarded<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(Stage) -> spectral_tv::Result<T> + Send,
) -> Result<T, Failure> {
    let count = threads()?;
    let work = || together(count, || work(Monitor::new().whole()));
    let outcome = py.detach(|| catch_unwind(AssertUnwindSafe(work)));
    finish(outcome.map_err(|panic| panic_message(&*panic)))
}

fn finish<T>(outcome: Outcome<T>) -> Result<T, Failure> {
    match outcome {
        Ok(result) => Ok(result?),
        Err(panic) => {
            let message = format!("internal error in spectral_tv: {panic}");
            Err(PyRuntimeError::new_err(message).into())
        }
    }
}

fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "panic".to_owned())
}

/// Turns what a thread made into a Python object, once the GIL is held again.
type Convert = Box<dyn FnOnce(Python<'_>) -> PyResult<Py<PyAny>> + Send>;

fn conversion<T: Send + 'static>(
    result: T,
    convert: impl for<'py> FnOnce(Python<'py>, T) -> Result<Bound<'py, PyAny>, Failure> + Send + 'static,
) -> Convert {
    Box::new(move |py| Ok(convert(py, result)?.unbind()))
}

/// Long work that runs in a thread of its own.
///
/// Made by the functions whose names begin with `start_`. A job that is no longer referred to
/// cancels its work. In a process that was forked from the one that started it, a job has its
/// result if it had it at the fork; otherwise it raises RuntimeError. A job cannot be pickled, but
/// its result can.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Job {
    task: Task<Convert>,
    state: Mutex<State>,
}

enum State {
    Running,
    Finished(Convert),
    /// A thread of this process is making an object of the result.
    Taken(u32),
    Failed(PyErr),
    Delivered(Py<PyAny>),
}

impl Job {
    /// Starts `work` in a thread; `convert` makes of its result what Python gets.
    pub fn start<T: Send + 'static>(
        work: impl FnOnce(Stage) -> spectral_tv::Result<T> + Send + 'static,
        convert: impl for<'py> FnOnce(Python<'py>, T) -> Result<Bound<'py, PyAny>, Failure>
        + Send
        + 'static,
    ) -> Result<Self, Failure> {
        Ok(Self::of(Task::start(move |monitor| {
            Ok(conversion(work(monitor.whole())?, convert))
        })?))
    }

    /// Starts short `work` on the threads that all short works share, with what `take` gives once
    /// it is free: none of those threads may wait for it, as the work that has it needs them.
    pub fn start_short<H: Send, T: Send + 'static>(
        take: impl FnOnce(Stage) -> spectral_tv::Result<H> + Send + 'static,
        work: impl FnOnce(H, Stage) -> spectral_tv::Result<T> + Send + 'static,
        convert: impl for<'py> FnOnce(Python<'py>, T) -> Result<Bound<'py, PyAny>, Failure>
        + Send
        + 'static,
    ) -> Result<Self, Failure> {
        Ok(Self::of(Task::spawn(move |count, monitor| {
            let taken = take(monitor.whole())?;
            let result = together(count, || work(taken, monitor.whole()))?;
            Ok(conversion(result, convert))
        })?))
    }

    fn of(task: Task<Convert>) -> Self {
        Self {
            task,
            state: Mutex::new(State::Running),
        }
    }

    /// Moves a result that has arrived from the thread to here; whether the work has ended.
    fn collect(&self, timeout: Duration) -> Result<bool, Missing> {
        if matches!(*self.lock()?, State::Running) {
            let Some(outcome) = self.task.receive(timeout)? else {
                return Ok(false);
            };
            *self.lock()? = match finish(outcome) {
                Ok(convert) => State::Finished(convert),
                Err(failure) => State::Failed(failure.into()),
            };
        }
        Ok(true)
    }

    /// The state of work that has ended, for one thread at a time, which puts another in its place.
    fn take(&self, timeout: Duration) -> Result<Option<State>, Missing> {
        if !self.collect(timeout)? {
            return Ok(None);
        }
        let mut state = self.lock()?;
        match *state {
            State::Taken(process) if process != process::id() => Err(Missing(process)),
            State::Taken(_) => {
                drop(state);
                thread::sleep(BRIEFLY);
                Ok(None)
            }
            _ => Ok(Some(mem::replace(&mut *state, State::Taken(process::id())))),
        }
    }

    /// Puts a state in place of the one that was taken.
    fn put(&self, state: State) -> Result<(), Missing> {
        *self.lock()? = state;
        Ok(())
    }

    /// Not to be waited for with the GIL, which its holder may want.
    fn lock(&self) -> Result<MutexGuard<'_, State>, Missing> {
        match self.task.process == process::id() {
            true => Ok(self.state.lock().unwrap_or_else(PoisonError::into_inner)),
            false => self
                .state
                .try_lock()
                .map_err(|_| Missing(self.task.process)),
        }
    }
}

#[pymethods]
impl Job {
    /// The fraction of the work done, in [0, 1].
    #[getter]
    fn progress(&self, py: Python<'_>) -> Result<f64, Failure> {
        self.done(py)?;
        Ok(self.task.monitor.fraction())
    }

    /// Whether the work has ended: with a result, an error, or by cancellation.
    #[getter]
    fn done(&self, py: Python<'_>) -> Result<bool, Failure> {
        Ok(py.detach(|| self.collect(Duration::ZERO))?)
    }

    /// Asks the work to stop; returns at once. Does nothing once it has ended.
    fn cancel(&self, py: Python<'_>) -> Result<(), Failure> {
        self.done(py)?;
        self.task.monitor.cancel();
        Ok(())
    }

    /// Waits for the result and returns it; the same object every time.
    ///
    /// Parameters
    /// ----------
    /// progress : callable, optional
    ///     Called with the fraction done. An exception it raises is passed on, and the work goes on.
    ///
    /// Raises
    /// ------
    /// Cancelled
    ///     If the job was cancelled before it finished.
    /// MeshError
    ///     If the work was refused.
    /// MemoryError
    ///     If it took more than is available.
    #[pyo3(signature = (progress = None))]
    fn result(
        &self,
        py: Python<'_>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Result<Py<PyAny>, Failure> {
        let taken = self.task.poll(py, progress, |timeout| self.take(timeout))?;
        let state = match taken {
            State::Finished(convert) => match convert(py) {
                Ok(object) => State::Delivered(object),
                Err(error) => State::Failed(error),
            },
            state => state,
        };
        let result = match &state {
            State::Delivered(object) => Ok(object.clone_ref(py)),
            State::Failed(error) => Err(error.clone_ref(py)),
            State::Running | State::Finished(_) | State::Taken(_) => {
                unreachable!("not to be taken")
            }
        };
        py.detach(|| self.put(state))?;
        let result = result?;
        tell(progress, 1.0)?;
        Ok(result)
    }

    /// Waits for the result of a job that nobody else has: a signal such as Ctrl-C or an exception
    /// from `progress` ends the work, and is passed on.
    pub fn _wait(
        &self,
        py: Python<'_>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Result<Py<PyAny>, Failure> {
        Ok(self.task.wait(py, progress)?(py)?)
    }

    /// `Job[T]`, for annotations: the type of the result.
    #[classmethod]
    fn __class_getitem__(
        class: &Bound<'_, PyType>,
        item: &Bound<'_, PyAny>,
    ) -> PyResult<Py<PyAny>> {
        let alias = class.py().import("types")?.getattr("GenericAlias")?;
        Ok(alias.call1((class, item))?.unbind())
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a Job cannot be pickled or copied: its threads are in this process; take its result(), \
             or start it where it is wanted",
        ))
    }
}

impl Drop for Job {
    fn drop(&mut self) {
        self.task.monitor.cancel();
    }
}
