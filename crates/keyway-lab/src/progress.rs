//! Progress of long work.

use std::ops::ControlFlow;

/// Observer of work that yields many answers. `()` ignores them.
pub trait Progress: Sync {
    /// Announces this many more answers.
    fn expect(&self, answers: usize);

    /// Reports one more answer; `Break` stops the work as soon as possible.
    fn answered(&self) -> ControlFlow<()>;
}

impl Progress for () {
    fn expect(&self, _: usize) {}

    fn answered(&self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
