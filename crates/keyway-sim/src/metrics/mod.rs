//! All metrics of a plan or a run, and their statistics over many runs ([`statistics`]). Metrics
//! are computed nowhere else.

mod command_jerk;
mod mrpb;
mod path;
mod run;
pub mod statistics;

pub use command_jerk::CommandJerk;
pub use mrpb::Mrpb;
pub use path::PathMetrics;
pub use run::{RunMetrics, count_run_heading_jumps};
