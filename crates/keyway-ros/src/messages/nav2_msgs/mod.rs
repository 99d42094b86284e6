//! `nav2_msgs`: the definitions that Jazzy and Kilted share; the others are in files of their own.

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

/// Makes an action of its parts.
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

/// The speed that is not to be exceeded; 0: there is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpeedLimit {
    pub(crate) header: Header,
    /// Of the robot's full speed; otherwise in metres per second.
    pub(crate) percentage: bool,
    /// `speed_limit` in the definition.
    pub(crate) most: f64,
}

impl Named for SpeedLimit {
    const NAME: (&'static str, &'static str) = ("nav2_msgs", "SpeedLimit");
}

/// A mask of ground, and how its values are meant.
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
    /// Values are parts of the full speed in percent: base + multiplier times the value.
    pub(crate) const SPEED_PERCENT: u8 = 1;
    /// The same in metres per second.
    pub(crate) const SPEED: u8 = 2;
}

/// The outcome of an action that has no other.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Outcome {
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

/// The outcome of an action that takes its time.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct TimedOutcome {
    pub(crate) total_elapsed_time: Duration,
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

/// A path, and the time that its making took.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ComputedPath {
    pub(crate) path: Path,
    pub(crate) planning_time: Duration,
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

/// A number that tells how far an action is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Distance {
    pub(crate) distance: f32,
}

action! {
    /// To drive to a pose.
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
    /// A way to a pose.
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
    /// To drive along a path.
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
    /// To make a path smooth.
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
    /// To stand for a time.
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
