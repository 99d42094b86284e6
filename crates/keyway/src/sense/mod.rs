//! From range scans to what stands where no map says so.

mod layer;
mod scan;

pub use layer::SensedLayer;
pub use scan::Scan;
