//! `nav2_msgs` of Jazzy, as far as Kilted differs.

use super::{
    Action, ComputedPath, Distance, Empty, NavigateToPoseFeedback, Outcome, Target, TimedOutcome,
    action,
};
use crate::messages::builtin_interfaces::Duration;
use crate::messages::geometry_msgs::PoseStamped;
use serde::{Deserialize, Serialize};

action! {
    /// Turns on the spot.
    Spin: SpinGoal => TimedOutcome, Distance
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpinGoal {
    pub(crate) target_yaw: f32,
    pub(crate) time_allowance: Duration,
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
}

action! {
    /// Drives to a pose via others.
    NavigateThroughPoses: NavigateThroughPosesGoal => Outcome, NavigateThroughPosesFeedback
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NavigateThroughPosesGoal {
    pub(crate) poses: Vec<PoseStamped>,
    pub(crate) behavior_tree: String,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NavigateThroughPosesFeedback {
    pub(crate) to_pose: NavigateToPoseFeedback,
    pub(crate) number_of_poses_remaining: i16,
}

action! {
    /// Computes a path to a pose via others.
    ComputePathThroughPoses: ComputePathThroughPosesGoal => ComputedPath, Empty
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ComputePathThroughPosesGoal {
    pub(crate) goals: Vec<PoseStamped>,
    pub(crate) start: PoseStamped,
    pub(crate) planner_id: String,
    pub(crate) use_start: bool,
}

action! {
    /// Stops at several poses.
    FollowWaypoints: FollowWaypointsGoal => FollowWaypointsOutcome, FollowWaypointsFeedback
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct FollowWaypointsGoal {
    pub(crate) number_of_loops: u32,
    pub(crate) goal_index: u32,
    pub(crate) poses: Vec<PoseStamped>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct FollowWaypointsOutcome {
    pub(crate) missed_waypoints: Vec<MissedWaypoint>,
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

/// A pose that was not reached.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MissedWaypoint {
    pub(crate) index: u32,
    pub(crate) goal: PoseStamped,
    pub(crate) error_code: u16,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct FollowWaypointsFeedback {
    pub(crate) current_waypoint: u32,
}
