//! Reasons to stand in doubt.

use super::clouds::CloudError;
use crate::transforms::TransformError;
use thiserror::Error;

/// The reason why a robot stands and nothing is decided.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum Waits {
    #[error("no map has come yet")]
    Map,
    #[error("no odometry has come yet")]
    Odometry,
    #[error(transparent)]
    Transform(#[from] TransformError),
    #[error(transparent)]
    Cloud(#[from] CloudError),
    #[error("the pose is {age_s:.2} s old, by transforms that are late or have ended")]
    NewPose { age_s: f64 },
}
