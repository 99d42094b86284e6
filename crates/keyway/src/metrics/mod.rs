//! Everything measured of a plan or a run; the only place where metrics are computed.

mod path;
mod run;

pub use path::{PathMetrics, count_heading_jumps};
pub use run::RunMetrics;
