//! Errors of batches, in the terms of the command line.

use crate::error::{CliError, Kind};
use crate::inputs::{bad_file, map_error};
use keyway_lab::batch::BatchError;

impl From<BatchError> for CliError {
    fn from(error: BatchError) -> Self {
        let argument = error.field().map(argument);
        let kind = match error {
            BatchError::Robot(error) => return bad_file(error, "--robot"),
            BatchError::Stack(error) => return bad_file(error, "--stacks"),
            BatchError::Disturbances(error) => return bad_file(error, "--disturbances"),
            BatchError::Map(error) => return map_error(&error),
            BatchError::RobotValue(_) | BatchError::Set(_) => Kind::Config,
            BatchError::NoScenes
            | BatchError::NoParts
            | BatchError::NoOut
            | BatchError::Seeds { .. }
            | BatchError::NoJobs
            | BatchError::StackTwice { .. }
            | BatchError::SceneTwice { .. }
            | BatchError::Stopped => Kind::Usage,
            BatchError::OutIsPart { .. }
            | BatchError::OtherRuns { .. }
            | BatchError::RecordInTheWay { .. }
            | BatchError::Results(_)
            | BatchError::Picture(_) => Kind::Output,
            _ => Kind::Input,
        };
        Self { field: argument, ..Self::new(kind, error) }
    }
}

/// Returns the argument for a field of a request.
fn argument(field: &str) -> String {
    match field {
        "scenes" => "SCENE.toml".to_owned(),
        "parts" => "DIR".to_owned(),
        option => format!("--{option}"),
    }
}
