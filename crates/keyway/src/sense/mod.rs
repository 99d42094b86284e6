//! Detection of obstacles that the map does not have. Range scans yield stationary obstacles, as
//! cells ([`SensedLayer`]), and moving ones, as a list ([`Tracker`]). Both use the same
//! projection of a cycle's scan ([`ProjectedScan`]). Points of other sensors ([`SensorPoints`])
//! are stationary obstacles.

mod layer;
mod mover;
mod observation;
mod points;
mod projected;
mod ranges;
mod scan;
mod seen;
mod spread;
#[cfg(test)]
pub(crate) mod test_scan;
mod tracker;

pub use layer::SensedLayer;
pub(crate) use layer::SensedPlaces;
pub(crate) use mover::MovingPoint;
pub use mover::{Mover, MoverBounds};
pub use observation::{Observation, SensorScan};
pub use points::{FieldOfView, SensorPoints};
pub use projected::{Hit, ProjectedScan};
pub use ranges::{Ranges, RangesRef};
pub use scan::{Reading, Scan, ScanError};
pub(crate) use seen::SeenStored;
pub use seen::{SeenCells, SeenGround, SeenWanted};
pub use spread::Walls;
pub use tracker::{Tracker, TrackerConfig};
