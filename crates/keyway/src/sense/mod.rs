//! From range scans to what stands where no map says so.

mod scan;

pub use scan::Scan;
