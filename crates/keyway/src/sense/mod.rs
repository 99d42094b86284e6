//! From range scans to obstacles that no map shows: those that stand, as cells ([`SensedLayer`]),
//! and those that move, as a list ([`Tracker`]). Each looks at the scan of a cycle as it was
//! projected once ([`ProjectedScan`]). Points of other sensors ([`SensorPoints`]) are obstacles that
//! stand.

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
