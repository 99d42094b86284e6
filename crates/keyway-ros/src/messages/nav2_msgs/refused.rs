//! Actions that this node knows by name only.

use crate::messages::Action;
use serde::{Deserialize, Serialize};

/// A message whose fields are not decoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Unread;

macro_rules! unread {
    ($($action:ident = $name:literal),+ $(,)?) => { $(
        pub(crate) struct $action;

        impl Action for $action {
            const NAME: (&'static str, &'static str) = ("nav2_msgs", $name);
            type Goal = Unread;
            type Outcome = Unread;
            type Feedback = Unread;
        }
    )+ };
}

unread!(
    AssistedTeleop = "AssistedTeleop",
    ComputeAndTrackRoute = "ComputeAndTrackRoute",
    ComputeRoute = "ComputeRoute",
    DockRobot = "DockRobot",
    FollowGpsWaypoints = "FollowGPSWaypoints",
    UndockRobot = "UndockRobot",
);
