//! What goes wrong at the command line: a message for people, and the same for programs.

use clap::error::{ContextKind, ContextValue};
use serde::Serialize;
use std::fmt::Display;
use std::io::Write;
use thiserror::Error;

/// Which part of the input is to blame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Kind {
    /// The arguments.
    Usage,
    /// A file that cannot be read, or does not hold what it should.
    Input,
    /// A parameter of a planner, a stack or a robot.
    Config,
    /// A start or goal at which there is no room.
    Position,
    /// A file, or the standard output, that cannot be written.
    Output,
}

/// Why a command was refused. Exit code 2.
#[derive(Debug, Error)]
#[error("{message}")]
pub(crate) struct CliError {
    pub(crate) kind: Kind,
    pub(crate) message: String,
    /// The argument or field that is to blame.
    pub(crate) field: Option<String>,
}

#[derive(Serialize)]
struct ErrorReport<'a> {
    schema: &'static str,
    kind: Kind,
    message: &'a str,
    field: Option<&'a str>,
}

impl CliError {
    pub(crate) fn new(kind: Kind, message: impl Display) -> Self {
        Self { kind, message: message.to_string(), field: None }
    }

    /// Names what is to blame.
    pub(crate) fn field(self, field: impl Into<String>) -> Self {
        Self { field: Some(field.into()), ..self }
    }

    pub(crate) fn from_clap(error: &clap::Error) -> Self {
        let text = error.to_string();
        let message = text.strip_prefix("error: ").unwrap_or(&text);
        // What follows the first paragraph repeats the usage.
        let message = message.split("\n\n").next().unwrap_or(message).trim();
        let field = match error.get(ContextKind::InvalidArg) {
            Some(ContextValue::String(arg)) => Some(arg.clone()),
            Some(ContextValue::Strings(args)) => args.first().cloned(),
            _ => None,
        };
        // `--start <X,Y>` -> `--start`.
        let field = field.and_then(|arg| arg.split(' ').next().map(str::to_owned));
        Self { kind: Kind::Usage, message: message.to_owned(), field }
    }

    /// To the standard error as text, or to the standard output as JSON, if that can be written.
    pub(crate) fn print(&self, json: bool) {
        let is_told = json && {
            let schema = "keyway.error/1";
            let Self { kind, message, field } = self;
            let report = ErrorReport { schema, kind: *kind, message, field: field.as_deref() };
            crate::json::print(&report).is_ok()
        };
        if !is_told {
            // Nobody is left to tell when even this cannot be printed.
            let _ = writeln!(std::io::stderr(), "error: {}", self.message);
        }
    }
}
