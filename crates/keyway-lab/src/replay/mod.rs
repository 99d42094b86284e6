//! Records of runs, and their replay.
//!
//! A record holds a run with everything that is needed to repeat it: scene, robots and stacks as
//! data, and the results. A [`ReplayRequest`] reads one and returns a [`Replay`] with the run to
//! repeat, which then compares the new run with the record.

mod difference;
mod error;
mod record;
mod request;

pub use difference::Difference;
pub use error::ReplayError;
pub(crate) use record::{RecordedInputs, RunRecord};
pub use request::{Replay, ReplayRequest};

/// Name and version of the record format.
const SCHEMA: &str = "keyway.record/1";
