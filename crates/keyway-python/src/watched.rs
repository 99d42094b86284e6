//! Long calls: the interpreter goes on meanwhile, Ctrl-C stops them, and somebody may watch.

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

/// Between two looks at the signals.
const LOOK: Duration = Duration::from_millis(50);

/// Who is called while long work is done.
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

/// How far a call has come, and whether it is to stop.
#[derive(Default)]
pub(crate) struct Watch {
    done: AtomicU64,
    /// 0 while nobody knows.
    expected: AtomicU64,
    is_stopped: AtomicBool,
    /// What is usually a mistake and was not yet said.
    warnings: Mutex<Vec<String>>,
}

impl Watch {
    /// One more of `expected` is done.
    pub(crate) fn advance(&self, expected: u64) {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.expected.store(expected, Ordering::Relaxed);
    }

    fn warnings(&self) -> MutexGuard<'_, Vec<String>> {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// So much of it is done; true stops the work.
    pub(crate) fn is_stopped_at(&self, done: u64, expected: u64) -> bool {
        self.done.store(done, Ordering::Relaxed);
        self.expected.store(expected, Ordering::Relaxed);
        self.is_stopped()
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    /// Waits for the result; what is raised meanwhile stops the work.
    fn wait<R>(&self, receiver: &Receiver<R>, progress: Option<&Progress>) -> PyResult<R> {
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok(result) => return Ok(result),
                Err(RecvTimeoutError::Timeout) => {
                    self.look(progress).inspect_err(|_| {
                        self.is_stopped.store(true, Ordering::Relaxed);
                    })?;
                }
                // The work has panicked, and its thread has said so.
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PyRuntimeError::new_err("the work has ended without a result"));
                }
            }
        }
    }

    /// Lets Python handle its signals, warns, and calls whoever watches; an error stops the call.
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

/// Counts the cycles of a run.
pub(crate) struct Cycles<'a>(pub(crate) &'a Watch);

impl EpisodeObserver for Cycles<'_> {
    fn decided(&mut self, _cycle: &keyway_sim::episode::Cycle<'_>) {
        self.0.advance(0);
    }

    fn gives_up(&self) -> bool {
        self.0.is_stopped()
    }
}

/// Does long work in a thread of its own. This thread waits without holding the interpreter, and looks at signals and calls
/// `progress(done, expected)` twenty times a second and at the end. What either raises stops the work and is raised here at
/// once: work that does not look whether it is stopped goes on to its end, and its result is dropped.
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

/// The same for work that writes files: who stops it waits until it has put them in order. Whoever stops it twice does not.
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
    // Nobody receives the result of work that was stopped.
    let thread = move || drop(sender.send(work(&watch)));
    std::thread::Builder::new().spawn(thread).map_err(|error| {
        PyRuntimeError::new_err(format!("cannot start a thread for the work: {error}"))
    })?;
    Ok(receiver)
}
