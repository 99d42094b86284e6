//! Long calls: the interpreter goes on meanwhile, Ctrl-C stops them, and somebody may watch.

use keyway::episode::EpisodeObserver;
use keyway_cli::Watcher;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
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
}

impl Watch {
    /// One more of `expected` is done.
    pub(crate) fn advance(&self, expected: u64) {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.expected.store(expected, Ordering::Relaxed);
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    /// Lets Python handle its signals, and calls whoever watches; an error stops the call.
    fn look(&self, progress: Option<&Progress>) -> PyResult<()> {
        Python::attach(|py| {
            py.check_signals()?;
            if let Some(Progress(progress)) = progress {
                let expected = Some(self.expected.load(Ordering::Relaxed)).filter(|&all| all > 0);
                progress.call1(py, (self.done.load(Ordering::Relaxed), expected))?;
            }
            Ok(())
        })
    }
}

impl Watcher for Watch {
    fn is_stopped_at(&self, done: u64, expected: u64) -> bool {
        self.done.store(done, Ordering::Relaxed);
        self.expected.store(expected, Ordering::Relaxed);
        self.is_stopped()
    }
}

/// Counts the cycles of a run.
pub(crate) struct Cycles<'a>(pub(crate) &'a Watch);

impl EpisodeObserver for Cycles<'_> {
    fn decided(&mut self, _cycle: &keyway::episode::Cycle<'_>) {
        self.0.advance(0);
    }

    fn gives_up(&self) -> bool {
        self.0.is_stopped()
    }
}

/// Does long work in a thread of its own. This thread waits without holding the interpreter, and looks at signals and calls
/// `progress(done, expected)` twenty times a second and at the end. What either raises stops the work and is raised here.
pub(crate) fn watched<R: Send>(
    py: Python<'_>,
    progress: Option<&Progress>,
    work: impl FnOnce(&Watch) -> R + Send,
) -> PyResult<R> {
    let watch = Watch::default();
    let watch = &watch;
    let (result, raised) = py.detach(|| {
        std::thread::scope(|scope| {
            let (sender, receiver) = channel();
            scope.spawn(move || sender.send(work(watch)));
            let mut raised = Ok(());
            loop {
                match receiver.recv_timeout(LOOK) {
                    Err(RecvTimeoutError::Timeout) => {
                        if raised.is_ok() {
                            raised = watch.look(progress);
                            watch.is_stopped.store(raised.is_err(), Ordering::Relaxed);
                        }
                    }
                    Ok(result) => break (Some(result), raised),
                    // The work has panicked: its thread says so when it is joined.
                    Err(RecvTimeoutError::Disconnected) => break (None, raised),
                }
            }
        })
    });
    raised?;
    watch.look(progress)?;
    result.ok_or_else(|| {
        pyo3::exceptions::PyRuntimeError::new_err("the work has ended without a result")
    })
}
