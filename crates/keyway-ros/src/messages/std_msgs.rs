//! `std_msgs`.

use super::builtin_interfaces::Time;
use serde::{Deserialize, Serialize};

/// The time and the frame of something.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Header {
    pub(crate) stamp: Time,
    pub(crate) frame_id: String,
}

impl Header {
    pub(crate) fn new(stamp_s: f64, frame: &str) -> Self {
        Self { stamp: Time::of(stamp_s), frame_id: frame.to_owned() }
    }
}
