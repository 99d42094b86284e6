//! What goes wrong at the command line: a message for people, and the same for programs.

use clap::error::{ContextKind, ContextValue};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt::Display;
use std::io::Write;
use thiserror::Error;

/// Which part of the input is to blame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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

#[derive(Serialize, Deserialize)]
struct ErrorReport<'a> {
    schema: Cow<'a, str>,
    kind: Kind,
    message: Cow<'a, str>,
    field: Option<Cow<'a, str>>,
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

    /// The error of another process of this program.
    pub(crate) fn from_report(report: &serde_json::Value) -> Result<Self, serde_json::Error> {
        let ErrorReport { kind, message, field, .. } = ErrorReport::deserialize(report)?;
        Ok(Self { kind, message: message.into_owned(), field: field.map(Cow::into_owned) })
    }

    /// To the standard error as text, or to the standard output as JSON, if that can be written.
    pub(crate) fn print(&self, json: bool) {
        let is_printed = json && {
            let report = ErrorReport {
                schema: "keyway.error/1".into(),
                kind: self.kind,
                message: self.message.as_str().into(),
                field: self.field.as_deref().map(Into::into),
            };
            crate::json::print(&report).is_ok()
        };
        if !is_printed {
            // Nobody is left to tell when even this cannot be printed.
            let _ = writeln!(std::io::stderr(), "error: {}", self.message);
        }
    }
}
