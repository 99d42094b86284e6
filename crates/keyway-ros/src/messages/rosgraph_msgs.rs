//! `rosgraph_msgs`.

use super::Named;
use super::builtin_interfaces::Time;
use serde::{Deserialize, Serialize};

/// The simulated time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Clock {
    pub(crate) clock: Time,
}

impl Named for Clock {
    const NAME: (&'static str, &'static str) = ("rosgraph_msgs", "Clock");
}
