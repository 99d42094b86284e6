//! Reasons for waiting.

use super::clouds::CloudError;
use crate::transforms::TransformError;
use keyway::sense::ScanError;
use thiserror::Error;

/// The reason for a stopped robot, independent of its goal.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum Waits {
    #[error("no map has arrived yet")]
    Map,
    #[error("no odometry has arrived yet")]
    Odometry,
    #[error(transparent)]
    Transform(#[from] TransformError),
    #[error("a scan cannot be used: {0}")]
    Scan(#[from] ScanError),
    #[error(transparent)]
    Cloud(#[from] CloudError),
    #[error("cloud_topics[{cloud}] has been silent for more than {after_s} s (`cloud_timeout`)")]
    Silent { cloud: usize, after_s: f64 },
    /// The lidars are silent: a message with the reason, and their topics.
    #[error("{why} (topics: {topics})")]
    Blind { why: String, topics: String },
    #[error("the odometry is {age_s:.2} s old")]
    NewOdometry { age_s: f64 },
    #[error(
        "the odometry is {ahead_s:.2} s ahead of this machine's clock: synchronise the clocks, for example with NTP"
    )]
    Ahead { ahead_s: f64 },
    #[error("the pose is {age_s:.2} s old: its transforms are late or have stopped")]
    NewPose { age_s: f64 },
}
