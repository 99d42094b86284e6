//! Progress of long work.

use std::fmt::Display;
use std::ops::ControlFlow;

/// Observer of work that yields many answers. `()` ignores them.
pub trait Progress: Sync {
    /// Announces this many more answers.
    fn expect(&self, answers: usize);

    /// Reports one more answer; `Break` stops the work as soon as possible.
    fn answered(&self) -> ControlFlow<()>;

    /// Reports a likely mistake in the input of the work; the work continues.
    fn warned(&self, _warning: &dyn Display) {}
}

impl Progress for () {
    fn expect(&self, _: usize) {}

    fn answered(&self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
