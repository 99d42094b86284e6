//! `tf2_msgs`.

use super::Named;
use super::geometry_msgs::TransformStamped;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct TFMessage {
    pub(crate) transforms: Vec<TransformStamped>,
}

impl Named for TFMessage {
    const NAME: (&'static str, &'static str) = ("tf2_msgs", "TFMessage");
}
