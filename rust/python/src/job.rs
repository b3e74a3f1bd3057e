//! Work in a thread of its own, which never touches Python, and the class `Job` to poll it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;
use spectral_tv::monitor::Monitor;

use crate::error::Failure;
use crate::heap;

/// Work that takes longer may have taken much memory.
const LONG: Duration = Duration::from_millis(500);

/// How often a waiting call looks for Ctrl-C and reports progress.
const POLL: Duration = Duration::from_millis(30);

/// What a thread sends when it is done; the outer error is a panic's message.
type Outcome<T> = Result<spectral_tv::Result<T>, String>;

/// Work that runs in a thread.
pub struct Task<T> {
    monitor: Arc<Monitor>,
    outcome: Mutex<Receiver<Outcome<T>>>,
}

impl<T: Send + 'static> Task<T> {
    /// Starts `work`.
    pub fn start(
        work: impl FnOnce(&Monitor) -> spectral_tv::Result<T> + Send + 'static,
    ) -> PyResult<Self> {
        let monitor = Arc::new(Monitor::new());
        let (sender, outcome) = channel();
        let watched = Arc::clone(&monitor);
        thread::Builder::new()
            .name("spectral_tv".into())
            .spawn(move || {
                let started = Instant::now();
                let result = catch_unwind(AssertUnwindSafe(|| by_itself(|| work(&watched))));
                // Nobody may be waiting any more; the result is then dropped.
                let _ = sender.send(result.map_err(|panic| panic_message(&*panic)));
                if started.elapsed() > LONG {
                    heap::give_back();
                }
            })?;
        Ok(Self {
            monitor,
            outcome: Mutex::new(outcome),
        })
    }

    /// Waits without the GIL; `progress` is called with the fraction done. A signal such as
    /// Ctrl-C or an exception from `progress` cancels the work and is passed on.
    pub fn wait(&self, py: Python<'_>, progress: Option<&Bound<'_, PyAny>>) -> Result<T, Failure> {
        if let Some(progress) = progress.filter(|progress| !progress.is_callable()) {
            self.monitor.cancel();
            let message = format!("progress must be callable, not {}", progress.repr()?);
            return Err(PyTypeError::new_err(message).into());
        }
        loop {
            let outcome = py.detach(|| self.receive(POLL));
            if let Some(outcome) = outcome {
                let result = finish(outcome)?;
                if let Some(progress) = progress {
                    progress.call1((1.0,))?;
                }
                return Ok(result);
            }
            let interruption = py.check_signals().and_then(|()| match progress {
                Some(progress) => progress.call1((self.monitor.fraction(),)).map(drop),
                None => Ok(()),
            });
            if let Err(interruption) = interruption {
                self.monitor.cancel();
                // The thread ends at its next check; what it made is dropped.
                while py.detach(|| self.receive(POLL)).is_none() {}
                return Err(interruption.into());
            }
        }
    }

    /// The outcome, if it comes within `timeout`; it is handed out once. Who cancels does not wait
    /// for the thread to free what it took.
    fn receive(&self, timeout: Duration) -> Option<Outcome<T>> {
        let receiver = self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        match receiver.recv_timeout(timeout) {
            Ok(outcome) => Some(outcome),
            Err(RecvTimeoutError::Timeout) if self.monitor.has_stopped() => {
                Some(Ok(Err(spectral_tv::Error::Cancelled)))
            }
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => Some(Err("the result was taken before".into())),
        }
    }
}

/// Does `work` on threads of its own. In a pool that works share, a thread that waits for a part of
/// one takes up another from its start, and the first could not even be cancelled until that ends.
/// All that is not shared out runs on one of them: another's allocator would not have what M3's
/// base, for one, has freed for its flow.
fn by_itself<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = ThreadPoolBuilder::new().thread_name(|_| "spectral_tv".into());
    match pool.build() {
        Ok(pool) => pool.install(work),
        // The system gives no more threads; the shared ones still do.
        Err(_) => work(),
    }
}

/// Short work without the GIL, a panic in it turned into an exception as in a [`Task`].
pub fn guarded<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> spectral_tv::Result<T> + Send,
) -> Result<T, Failure> {
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
pub type Convert = Box<dyn FnOnce(Python<'_>) -> PyResult<Py<PyAny>> + Send>;

/// Long work that runs in a thread of its own.
///
/// Made by the functions whose names begin with `start_`. A job that is no longer referred to
/// cancels its work.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Job {
    task: Task<Convert>,
    state: Mutex<State>,
}

enum State {
    Running,
    Finished(Convert),
    Failed(PyErr),
    Delivered(Py<PyAny>),
}

impl Job {
    pub fn new(task: Task<Convert>) -> Self {
        Self {
            task,
            state: Mutex::new(State::Running),
        }
    }

    /// Moves a result that has arrived from the thread to here.
    fn collect(&self, state: &mut State) {
        if let State::Running = state
            && let Some(outcome) = self.task.receive(Duration::ZERO)
        {
            *state = match finish(outcome) {
                Ok(convert) => State::Finished(convert),
                Err(failure) => State::Failed(failure.into()),
            };
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Job {
    /// The fraction of the work done, in [0, 1].
    #[getter]
    fn progress(&self) -> f64 {
        self.task.monitor.fraction()
    }

    /// Whether the work has ended: with a result, an error, or by cancellation.
    #[getter]
    fn done(&self) -> bool {
        let mut state = self.lock();
        self.collect(&mut state);
        !matches!(*state, State::Running)
    }

    /// Asks the work to stop; returns at once. Does nothing once it has ended.
    fn cancel(&self) {
        self.task.monitor.cancel();
    }

    /// Waits for the result and returns it; the same object every time.
    ///
    /// Raises
    /// ------
    /// Cancelled
    ///     If the job was cancelled before it finished.
    /// MeshError
    ///     If the work was refused.
    fn result(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        while !self.done() {
            py.detach(|| thread::sleep(Duration::from_millis(1)));
            py.check_signals()?;
        }
        let mut state = self.lock();
        *state = match std::mem::replace(&mut *state, State::Running) {
            State::Finished(convert) => match convert(py) {
                Ok(object) => State::Delivered(object),
                Err(error) => State::Failed(error),
            },
            other => other,
        };
        match &*state {
            State::Delivered(object) => Ok(object.clone_ref(py)),
            State::Failed(error) => Err(error.clone_ref(py)),
            State::Running | State::Finished(_) => unreachable!("done above"),
        }
    }
}

impl Drop for Job {
    fn drop(&mut self) {
        self.task.monitor.cancel();
    }
}
