//! Where the local planner is sent next.

mod key_points;

pub use key_points::{KeyPoints, KeyPointsConfig};
