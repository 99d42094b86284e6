//! `std_msgs`.

use super::builtin_interfaces::Time;
use serde::{Deserialize, Serialize};

/// The stamp and the frame of a message.
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

/// A colour; each component is from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ColorRgba {
    pub(crate) r: f32,
    pub(crate) g: f32,
    pub(crate) b: f32,
    pub(crate) a: f32,
}
