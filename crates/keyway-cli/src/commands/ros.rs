//! `keyway ros`.

use super::Done;
use crate::error::{CliError, Kind};

/// Runs until it is told to stop.
pub(crate) fn run(arguments: Vec<String>) -> Result<Done, CliError> {
    keyway_ros::run(arguments).map_err(|error| CliError::new(Kind::Config, error))?;
    Ok(Done::Success)
}
