//! From range scans to obstacles that no map shows: those that stand, as cells ([`SensedLayer`]), and those that move, as
//! a list ([`Tracker`]).

mod beam;
mod layer;
mod mover;
mod own_body;
mod scan;
mod seen;
mod spread;
#[cfg(test)]
mod test_scan;
mod tracker;

pub use layer::SensedLayer;
pub use mover::{Disc, Mover, MoverBounds};
pub(crate) use own_body::OwnBody;
pub use scan::{Reading, Scan, ScanError};
pub use seen::{SeenCells, SeenGround, SeenWanted};
pub use spread::Walls;
pub use tracker::{Tracker, TrackerConfig};
