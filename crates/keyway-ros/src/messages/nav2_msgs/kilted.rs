//! `nav2_msgs` of Kilted, as far as Jazzy differs.

use super::jazzy::{FollowWaypointsFeedback, FollowWaypointsGoal};
use super::{
    Action, ComputedPath, Distance, Empty, NavigateToPoseFeedback, Target, TimedOutcome, action,
};
use crate::messages::builtin_interfaces::Duration;
use crate::messages::geometry_msgs::PoseStamped;
use crate::messages::nav_msgs::Goals;
use serde::{Deserialize, Serialize};

action! {
    /// Turns on the spot.
    Spin: SpinGoal => TimedOutcome, Distance
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpinGoal {
    pub(crate) target_yaw: f32,
    pub(crate) time_allowance: Duration,
    pub(crate) disable_collision_checks: bool,
}

action! {
    /// Drives straight back.
    BackUp: DriveGoal => TimedOutcome, Distance
}

action! {
    /// Drives straight ahead.
    DriveOnHeading: DriveGoal => TimedOutcome, Distance
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct DriveGoal {
    pub(crate) target: Target,
    pub(crate) speed: f32,
    pub(crate) time_allowance: Duration,
    pub(crate) disable_collision_checks: bool,
}

action! {
    /// Drives to a pose via others.
    NavigateThroughPoses: NavigateThroughPosesGoal
        => NavigateThroughPosesOutcome, NavigateThroughPosesFeedback
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NavigateThroughPosesGoal {
    pub(crate) poses: Goals,
    pub(crate) behavior_tree: String,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NavigateThroughPosesOutcome {
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
    pub(crate) waypoint_statuses: Vec<WaypointStatus>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NavigateThroughPosesFeedback {
    pub(crate) to_pose: NavigateToPoseFeedback,
    pub(crate) number_of_poses_remaining: i16,
    pub(crate) waypoint_statuses: Vec<WaypointStatus>,
}

/// The state of a waypoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct WaypointStatus {
    /// [`Self::FAILED`] is the only one that is reported.
    pub(crate) status: u8,
    pub(crate) waypoint_index: u32,
    pub(crate) waypoint_pose: PoseStamped,
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

impl WaypointStatus {
    pub(crate) const FAILED: u8 = 3;
}

action! {
    /// Computes a path to a pose via others.
    ComputePathThroughPoses: ComputePathThroughPosesGoal => ComputedPath, Empty
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ComputePathThroughPosesGoal {
    pub(crate) goals: Goals,
    pub(crate) start: PoseStamped,
    pub(crate) planner_id: String,
    pub(crate) use_start: bool,
}

action! {
    /// Stops at several poses.
    FollowWaypoints: FollowWaypointsGoal => FollowWaypointsOutcome, FollowWaypointsFeedback
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct FollowWaypointsOutcome {
    pub(crate) missed_waypoints: Vec<WaypointStatus>,
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}
