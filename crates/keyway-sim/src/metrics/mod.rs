//! All measures of a plan or a run, and what many of them say together ([`statistics`]); the only place
//! where metrics are computed.

mod mrpb;
mod path;
mod run;
pub mod statistics;

pub use mrpb::Mrpb;
pub use path::PathMetrics;
pub use run::{RunMetrics, count_run_heading_jumps};
