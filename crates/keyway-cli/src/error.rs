//! Errors of the command line: a message for people, and the same as JSON.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::ffi::OsString;
use std::fmt::Display;
use std::io::Write;
use thiserror::Error;

/// The part of the input that is to blame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Kind {
    /// The arguments.
    Usage,
    /// A file that cannot be read, or has invalid content.
    Input,
    /// A parameter of a planner, a stack or a robot.
    Config,
    /// A start or goal without enough clearance.
    Position,
    /// A file, or the standard output, that cannot be written.
    Output,
}

/// Error that refuses a command. Exit code 2.
#[derive(Debug, Error)]
#[error("{message}")]
pub(crate) struct CliError {
    pub(crate) kind: Kind,
    pub(crate) message: String,
    /// The argument or field to blame.
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

    /// Sets the argument or field to blame.
    pub(crate) fn field(self, field: impl Into<String>) -> Self {
        Self { field: Some(field.into()), ..self }
    }

    pub(crate) fn from_clap(error: &clap::Error) -> Self {
        let text = error.to_string();
        let message = text.strip_prefix("error: ").unwrap_or(&text);
        // Everything after the first paragraph repeats the usage.
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

    /// Returns the error for numbers of one value that are separated by spaces, as in
    /// `--start -8 -2`; `None` if the arguments have another fault.
    pub(crate) fn of_split_numbers(error: &clap::Error, argv: &[OsString]) -> Option<Self> {
        let Some(ContextValue::String(found)) = error.get(ContextKind::InvalidArg) else {
            return None;
        };
        let is_number = |arg: &OsString| arg.to_str().is_some_and(|arg| arg.parse::<f64>().is_ok());
        // The parser names `-2.825` by its first letter, as the flag `-2`.
        let is_found = |arg: &OsString| arg.to_str().is_some_and(|arg| arg.starts_with(found));
        let is_end = |pair: &[OsString]| is_found(&pair[1]) && pair.iter().all(is_number);
        let end = 1 + argv.windows(2).position(is_end)?;
        let count = argv[..=end].iter().rev().take_while(|arg| is_number(arg)).count();
        let option = argv[..=end - count].last()?.to_str().filter(|it| it.starts_with("--"))?;
        let rest = argv[end + 1..].iter().take_while(|arg| is_number(arg));
        let numbers: Vec<&str> =
            argv[end + 1 - count..=end].iter().chain(rest).filter_map(|arg| arg.to_str()).collect();
        if error.kind() != ErrorKind::UnknownArgument || numbers.len() < 2 {
            return None;
        }
        let message = format!(
            "{option} {}: separate the numbers by commas: {option} {}",
            numbers.join(" "),
            numbers.join(",")
        );
        Some(Self::new(Kind::Usage, message).field(option))
    }

    /// Returns the error for an option of other commands that batches and their scenes do not
    /// have; `None` for any other fault.
    pub(crate) fn of_batch(error: &clap::Error, argv: &[OsString]) -> Option<Self> {
        let Some(ContextValue::String(found)) = error.get(ContextKind::InvalidArg) else {
            return None;
        };
        let instead = match found.as_str() {
            "--as-published" => {
                "a batch drives every method with the values for the robot of its scene. `keyway navigate --as-published` drives \
                 one as published, on maps with cells of 1 m, and `keyway reproduce` measures the claims of the papers"
            }
            "--radius" => {
                "the robot of a batch comes from its scenes or from --robot: a file with the lines `like = \"small\"` and \
                 `radius_m = 0.22` is a robot of that radius"
            }
            _ => return None,
        };
        let command = argv.get(1).and_then(|command| command.to_str())?;
        let is_batch = command == "batch" || (command == "scene" && found == "--radius");
        let is_unknown = error.kind() == ErrorKind::UnknownArgument;
        let message = || format!("keyway {command} has no {found}: {instead}");
        (is_batch && is_unknown).then(|| Self::new(Kind::Usage, message()).field(found))
    }

    /// Parses the error report of another process of this program.
    pub(crate) fn from_report(report: &serde_json::Value) -> Result<Self, serde_json::Error> {
        let ErrorReport { kind, message, field, .. } = ErrorReport::deserialize(report)?;
        Ok(Self { kind, message: message.into_owned(), field: field.map(Cow::into_owned) })
    }

    /// Prints the error: to the standard error as text, or to the standard output as JSON. If the
    /// JSON cannot be written, the text is printed.
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
            // If even this fails, there is no channel left to report it.
            let _ = writeln!(std::io::stderr(), "error: {}", self.message);
        }
    }
}
