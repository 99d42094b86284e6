//! Maps: occupancy grids as read from files, the layers derived for a search, exact distances to
//! obstacles, and readers and writers of common map file formats.

mod bits;
mod cell;
mod cell_index;
mod cell_state;
mod clearance;
mod costmap;
mod field;
mod footprint;
#[cfg(feature = "formats")]
pub mod formats;
mod frame;
mod layers;
mod occupancy;
mod occupancy_values;
mod packed;
mod ray;

pub use bits::BitGrid;
pub use cell::Cell;
pub use cell_index::CellIndex;
pub use cell_state::CellState;
pub(crate) use clearance::Obstruction;
pub use clearance::{Clearance, ClearanceBounds};
pub use costmap::{Costmap, CostmapConfig};
pub use field::{CellWindow, DistanceField, DistanceTo, FieldConfig};
pub use footprint::Core;
pub(crate) use footprint::{
    Apart, Line, NearBoxes, NearObstacles, Placement, Reach, Sweep, Turned, on_grid,
};
#[cfg(feature = "formats")]
use frame::is_origin;
pub use frame::{FrameError, GridFrame, MAX_CELLS};
pub(crate) use layers::DiagonalEvents;
use layers::StopBitmaps;
#[cfg(feature = "formats")]
pub(crate) use layers::mix;
pub use layers::{
    BlockedBy, Components, Connectivity, Hindrance, LayerConfig, PublishedConstraints, SearchMap,
    Separation, UnknownPolicy,
};
pub use occupancy::{Edit, OccupancyGrid};
pub use occupancy_values::{OccupancyError, OccupancyThresholds};
pub use ray::{RayCell, RayCells};
