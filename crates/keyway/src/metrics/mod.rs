//! All measures of a plan or a run; the only place where metrics are computed.

mod path;
mod run;
mod shortest;

pub use path::{PathMetrics, count_heading_jumps};
pub use run::RunMetrics;
pub use shortest::shortest_line;
