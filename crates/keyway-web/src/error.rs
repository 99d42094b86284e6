//! Errors of questions.

use serde::Serialize;
use std::fmt::Display;

/// The kind of an error; the same names as in `keyway.error/1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Kind {
    /// The question itself.
    Usage,
    /// A map, a scene or another file.
    Input,
    /// A parameter.
    Config,
    /// A start or goal without enough clearance.
    Position,
}

/// The reason why a question has no answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PageError {
    /// Its kind.
    pub kind: Kind,
    /// Message with the fault and what was expected.
    pub message: String,
    /// The field or the file to blame, if it is a single one.
    pub field: Option<String>,
}

impl PageError {
    pub(crate) fn new(kind: Kind, message: impl Display) -> Self {
        Self { kind, message: message.to_string(), field: None }
    }

    pub(crate) fn field(self, field: impl Into<String>) -> Self {
        Self { field: Some(field.into()), ..self }
    }
}
