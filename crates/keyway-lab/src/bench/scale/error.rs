//! Errors of a measurement.

use keyway::files::RobotLayersError;
use keyway::map::FrameError;
use keyway::plan::PlanError;
use thiserror::Error;

/// Reason why a planner cannot be measured on a tiled map.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ScaleError {
    /// The map cannot be tiled to this side.
    #[error(transparent)]
    Side(FrameError),
    /// The layers cannot be derived, or leave no cell free.
    #[error(transparent)]
    Layers(RobotLayersError),
    /// The planner cannot be used.
    #[error(transparent)]
    Planner(PlanError),
    /// The map has no free cell.
    #[error("no cell of the map is free")]
    NoFreeCell {
        /// True if the map has unknown cells, and they count as obstacles.
        is_unknown_blocked: bool,
    },
    /// The largest component ends within one tile, so no path would grow with the side.
    #[error(
        "the tiles of this map are not connected: no free cell of its largest component is at the border"
    )]
    Apart,
    /// The planner refuses the query.
    #[error(transparent)]
    Refused(PlanError),
    /// The observer stopped the measurement.
    #[error("stopped before the end")]
    Stopped,
}
