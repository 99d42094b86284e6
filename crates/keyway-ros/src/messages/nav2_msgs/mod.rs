//! `nav2_msgs`: the definitions that Jazzy and Kilted share. The others are in separate files.

pub(crate) mod jazzy;
pub(crate) mod kilted;
mod refused;
pub(crate) mod services;

pub(crate) use refused::{
    AssistedTeleop, ComputeAndTrackRoute, ComputeRoute, DockRobot, FollowGpsWaypoints, UndockRobot,
    Unread,
};

use super::builtin_interfaces::Duration;
use super::geometry_msgs::{PoseStamped, Vector3};
use super::nav_msgs::Path;
use super::std_msgs::Header;
use super::{Action, Empty, Named};
use serde::{Deserialize, Serialize};

/// Defines an action from its parts.
macro_rules! action {
    ($(#[$doc:meta])* $action:ident: $goal:ty => $outcome:ty, $feedback:ty) => {
        $(#[$doc])*
        pub(crate) struct $action;

        impl Action for $action {
            const NAME: (&'static str, &'static str) = ("nav2_msgs", stringify!($action));
            type Goal = $goal;
            type Outcome = $outcome;
            type Feedback = $feedback;
        }
    };
}
use action;

/// A speed limit; 0 removes it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpeedLimit {
    pub(crate) header: Header,
    /// True if the limit is a percentage of the full speed; otherwise it is in metres per second.
    pub(crate) percentage: bool,
    /// `speed_limit` in the definition.
    pub(crate) most: f64,
}

impl Named for SpeedLimit {
    const NAME: (&'static str, &'static str) = ("nav2_msgs", "SpeedLimit");
}

/// Metadata of a costmap filter: its mask, and the interpretation of the mask's values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CostmapFilterInfo {
    pub(crate) header: Header,
    /// `type` in the definition.
    pub(crate) kind: u8,
    pub(crate) filter_mask_topic: String,
    pub(crate) base: f32,
    pub(crate) multiplier: f32,
}

impl Named for CostmapFilterInfo {
    const NAME: (&'static str, &'static str) = ("nav2_msgs", "CostmapFilterInfo");
}

impl CostmapFilterInfo {
    pub(crate) const KEEP_OUT: u8 = 0;
    /// Values are speed limits in percent of the full speed: base + multiplier times the value.
    pub(crate) const SPEED_PERCENT: u8 = 1;
    /// The same in metres per second.
    pub(crate) const SPEED: u8 = 2;
}

/// The outcome of an action without further fields.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Outcome {
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

/// The outcome of an action with its elapsed time.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct TimedOutcome {
    pub(crate) total_elapsed_time: Duration,
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

/// A path, and the planning time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ComputedPath {
    pub(crate) path: Path,
    pub(crate) planning_time: Duration,
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

/// Feedback with a travelled distance or angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Distance {
    pub(crate) distance: f32,
}

action! {
    /// Drives to a pose.
    NavigateToPose: NavigateToPoseGoal => Outcome, NavigateToPoseFeedback
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NavigateToPoseGoal {
    pub(crate) pose: PoseStamped,
    pub(crate) behavior_tree: String,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NavigateToPoseFeedback {
    pub(crate) current_pose: PoseStamped,
    pub(crate) navigation_time: Duration,
    pub(crate) estimated_time_remaining: Duration,
    pub(crate) number_of_recoveries: i16,
    pub(crate) distance_remaining: f32,
}

action! {
    /// Computes a path to a pose.
    ComputePathToPose: ComputePathToPoseGoal => ComputedPath, Empty
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ComputePathToPoseGoal {
    pub(crate) goal: PoseStamped,
    pub(crate) start: PoseStamped,
    pub(crate) planner_id: String,
    pub(crate) use_start: bool,
}

action! {
    /// Follows a path.
    FollowPath: FollowPathGoal => FollowPathOutcome, FollowPathFeedback
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct FollowPathGoal {
    pub(crate) path: Path,
    pub(crate) controller_id: String,
    pub(crate) goal_checker_id: String,
    pub(crate) progress_checker_id: String,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct FollowPathOutcome {
    pub(crate) result: Empty,
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct FollowPathFeedback {
    pub(crate) distance_to_goal: f32,
    pub(crate) speed: f32,
}

action! {
    /// Smooths a path.
    SmoothPath: SmoothPathGoal => SmoothPathOutcome, Empty
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SmoothPathGoal {
    pub(crate) path: Path,
    pub(crate) smoother_id: String,
    pub(crate) max_smoothing_duration: Duration,
    pub(crate) check_for_collisions: bool,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SmoothPathOutcome {
    pub(crate) path: Path,
    pub(crate) smoothing_duration: Duration,
    pub(crate) was_completed: bool,
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

action! {
    /// Waits in place for a time.
    Wait: WaitGoal => TimedOutcome, WaitFeedback
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct WaitGoal {
    pub(crate) time: Duration,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct WaitFeedback {
    pub(crate) time_left: Duration,
}

/// The target of a straight drive, in the robot's frame.
pub(crate) type Target = Vector3;
