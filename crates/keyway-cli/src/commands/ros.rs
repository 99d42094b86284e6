//! `keyway ros`.

use super::Done;
use crate::error::{CliError, Kind};

/// Runs the node until it is stopped.
pub(crate) fn run(arguments: Vec<String>) -> Result<Done, CliError> {
    keyway_ros::run(arguments).map_err(|error| CliError::new(Kind::Config, error))?;
    Ok(Done::Success)
}
