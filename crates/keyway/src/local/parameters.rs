//! The common interface of the parameters of all local planners.

use super::LocalPlanner;
use crate::ConfigError;
use crate::robot::Robot;
use std::sync::Arc;

/// A local planner chosen by name.
pub(super) type BoxedLocalPlanner = Box<dyn LocalPlanner + Send + Sync>;

/// The parameters of a local planner.
pub(super) trait LocalParameters {
    /// The parameters for a robot.
    fn for_robot(robot: &Robot) -> Self
    where
        Self: Sized;

    /// Builds the local planner for a robot.
    fn build(&self, robot: &Arc<Robot>) -> Result<BoxedLocalPlanner, ConfigError>;

    /// The published values of the local planner's paper.
    fn as_published() -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// True if the planner uses the observed space ahead
    /// ([`SeenCells::ahead`](crate::sense::SeenCells::ahead)).
    fn stops_within_sight(&self) -> bool {
        false
    }

    /// Fields for which the paper gives no value.
    fn readings(&self) -> &'static [&'static str] {
        &[]
    }
}
