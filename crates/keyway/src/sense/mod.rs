//! From range scans to obstacles that no map shows.

mod layer;
mod scan;

pub use layer::SensedLayer;
pub use scan::Scan;
