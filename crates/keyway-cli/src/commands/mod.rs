//! The commands: each takes its arguments, calls the library, and writes what came out.

pub(crate) mod bench;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod list;
pub(crate) mod map;
pub(crate) mod navigate;
pub(crate) mod plan;

/// How a command that was not refused ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Done {
    /// Exit code 0.
    Success,
    /// There is no path, the goal was not reached, or an answer was wrong. Exit code 1.
    Failure,
}

impl Done {
    pub(crate) const fn when(succeeded: bool) -> Self {
        if succeeded { Self::Success } else { Self::Failure }
    }
}

/// Prints text; a reader that went away is no error of this program.
pub(crate) fn print(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stdout(), "{text}");
}
