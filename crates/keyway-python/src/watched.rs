//! Long calls: they release the interpreter, can be stopped by Ctrl-C, and report their progress.

use crate::errors::warn;
use keyway_sim::episode::EpisodeObserver;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::fmt::Display;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Interval between two checks of the signals.
const LOOK: Duration = Duration::from_millis(50);

/// Callback during long calls.
pub(crate) struct Progress(Py<PyAny>);

impl<'py> FromPyObject<'_, 'py> for Progress {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr =
        pyo3::type_hint_identifier!("keyway.typing", "Progress");

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if object.is_callable() {
            return Ok(Self(object.to_owned().unbind()));
        }
        let got = crate::values::described(&object);
        let text = format!("expected a function of two numbers, done and expected, got {got}");
        Err(pyo3::exceptions::PyTypeError::new_err(text))
    }
}

/// Progress of a call, and the request to stop it.
#[derive(Default)]
pub(crate) struct Watch {
    done: AtomicU64,
    /// 0 while it is unknown.
    expected: AtomicU64,
    is_stopped: AtomicBool,
    /// Warnings about likely mistakes that are not issued yet.
    warnings: Mutex<Vec<String>>,
}

impl Watch {
    /// Counts one more of `expected` as done.
    pub(crate) fn advance(&self, expected: u64) {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.expected.store(expected, Ordering::Relaxed);
    }

    fn warnings(&self) -> MutexGuard<'_, Vec<String>> {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sets the progress; true stops the work.
    pub(crate) fn is_stopped_at(&self, done: u64, expected: u64) -> bool {
        self.done.store(done, Ordering::Relaxed);
        self.expected.store(expected, Ordering::Relaxed);
        self.is_stopped()
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    /// Waits for the result; an exception raised meanwhile stops the work.
    fn wait<R>(&self, receiver: &Receiver<R>, progress: Option<&Progress>) -> PyResult<R> {
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok(result) => return Ok(result),
                Err(RecvTimeoutError::Timeout) => {
                    self.look(progress).inspect_err(|_| {
                        self.is_stopped.store(true, Ordering::Relaxed);
                    })?;
                }
                // The work has panicked, and its thread has printed the message.
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PyRuntimeError::new_err("the work ended without a result"));
                }
            }
        }
    }

    /// Lets Python handle its signals, issues warnings, and calls the callback; an exception
    /// stops the call.
    fn look(&self, progress: Option<&Progress>) -> PyResult<()> {
        Python::attach(|py| {
            py.check_signals()?;
            let warnings = std::mem::take(&mut *self.warnings());
            warnings.iter().try_for_each(|warning| warn(py, warning))?;
            if let Some(Progress(progress)) = progress {
                let expected = Some(self.expected.load(Ordering::Relaxed)).filter(|&all| all > 0);
                progress.call1(py, (self.done.load(Ordering::Relaxed), expected))?;
            }
            Ok(())
        })
    }
}

impl keyway_lab::progress::Progress for Watch {
    fn expect(&self, answers: usize) {
        self.expected.fetch_add(answers as u64, Ordering::Relaxed);
    }

    fn answered(&self) -> ControlFlow<()> {
        self.done.fetch_add(1, Ordering::Relaxed);
        if self.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn warned(&self, warning: &dyn Display) {
        self.warnings().push(warning.to_string());
    }
}

/// Observer that counts the cycles of a run.
pub(crate) struct Cycles<'a>(pub(crate) &'a Watch);

impl EpisodeObserver for Cycles<'_> {
    fn decided(&mut self, _cycle: &keyway_sim::episode::Cycle<'_>) {
        self.0.advance(0);
    }

    fn gives_up(&self) -> bool {
        self.0.is_stopped()
    }
}

/// Runs long work in a thread of its own. The calling thread waits without holding the
/// interpreter; it checks for signals and calls `progress(done, expected)` twenty times a second
/// and at the end. An exception in either stops the work and is raised at once: work that does
/// not check for a stop continues to its end, and its result is dropped.
pub(crate) fn watched<R: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Progress>,
    work: impl FnOnce(&Watch) -> R + Send + 'static,
) -> PyResult<R> {
    let watch = Arc::new(Watch::default());
    let receiver = started(&watch, work)?;
    let result = py.detach({
        let watch = Arc::clone(&watch);
        move || watch.wait(&receiver, progress)
    })?;
    watch.look(progress)?;
    Ok(result)
}

/// The same for work that writes files: after a stop, the call waits until the files are
/// consistent. A second stop does not wait.
pub(crate) fn watched_to_its_end<R: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Progress>,
    work: impl FnOnce(&Watch) -> R + Send + 'static,
) -> PyResult<R> {
    let watch = Arc::new(Watch::default());
    let receiver = started(&watch, work)?;
    let result = py.detach({
        let watch = Arc::clone(&watch);
        move || {
            watch.wait(&receiver, progress).or_else(|raised| {
                let _: R = watch.wait(&receiver, None)?;
                Err(raised)
            })
        }
    })?;
    watch.look(progress)?;
    Ok(result)
}

fn started<R: Send + 'static>(
    watch: &Arc<Watch>,
    work: impl FnOnce(&Watch) -> R + Send + 'static,
) -> PyResult<Receiver<R>> {
    let (sender, receiver) = channel();
    let watch = Arc::clone(watch);
    // After a stop, nobody receives the result.
    let thread = move || drop(sender.send(work(&watch)));
    std::thread::Builder::new().spawn(thread).map_err(|error| {
        PyRuntimeError::new_err(format!("cannot start a thread for the work: {error}"))
    })?;
    Ok(receiver)
}
