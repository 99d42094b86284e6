//! The robot and what it decides each control cycle.

mod robot;

pub use robot::{Limits, RangeSensor, Robot, RobotError};
