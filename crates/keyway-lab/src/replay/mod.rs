//! Records of runs, and the same runs made again.
//!
//! A record holds a run with everything that it takes to make it again: scene, robots and stacks as
//! data, and what came of it. A [`ReplayRequest`] reads one. It gives a [`Replay`] with the run to
//! be made, which then says in what the new run differs from the record.

mod difference;
mod error;
mod record;
mod request;

pub use difference::Difference;
pub use error::ReplayError;
pub(crate) use record::{RecordedInputs, RunRecord};
pub use request::{Replay, ReplayRequest};

/// Name and version of the form of a record.
const SCHEMA: &str = "keyway.record/1";
