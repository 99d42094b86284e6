//! How far long work has come.

use std::ops::ControlFlow;

/// Watcher of work that gives many answers. `()` looks away.
pub trait Progress: Sync {
    /// So many more answers are expected.
    fn expect(&self, answers: usize);

    /// One more answer was given; `Break` stops the work as soon as that is possible.
    fn answered(&self) -> ControlFlow<()>;
}

impl Progress for () {
    fn expect(&self, _: usize) {}

    fn answered(&self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
