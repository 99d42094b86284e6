//! What a robot may drive on: occupancy grids as files give them, the layers derived for a search,
//! exact distances to obstacles, and readers and writers of the field's file formats.

mod bits;
mod blocked_by;
mod cell;
mod cell_index;
mod clearance;
mod clearance_cubics;
mod clearance_curves;
mod clearance_expanded;
mod clearance_scan;
mod components;
mod costmap;
mod dilation;
mod field;
mod fingerprint;
mod footprint;
mod footprint_turn;
#[cfg(feature = "formats")]
pub mod formats;
mod frame;
mod free_ends;
mod hindrance;
mod layers;
mod nearest;
mod occupancy;
mod ray;
mod search_map;
mod separation;
mod stops;

pub use bits::BitGrid;
pub use blocked_by::BlockedBy;
pub use cell::Cell;
pub use cell_index::CellIndex;
pub use clearance::Clearance;
pub(crate) use clearance::Obstruction;
pub use clearance_curves::ClearanceBounds;
pub use components::{Components, Connectivity};
pub use costmap::{Costmap, CostmapConfig};
pub use field::{CellWindow, DistanceField, DistanceTo, FieldConfig};
#[cfg(feature = "formats")]
pub(crate) use fingerprint::mix;
pub use footprint::{Circle, Footprint, FootprintError, Polygon};
#[cfg(feature = "formats")]
use frame::is_origin;
pub use frame::{FrameError, GridFrame, MAX_CELLS};
pub use hindrance::Hindrance;
pub use layers::{LayerConfig, UnknownPolicy};
pub use occupancy::{CellState, Edit, OccupancyGrid};
pub(crate) use ray::RayCells;
pub use search_map::SearchMap;
pub use separation::Separation;
use stops::StopBitmaps;
