//! `nav2_msgs`, as far as Jazzy and Kilted have the same.

use super::builtin_interfaces::Duration;
use super::geometry_msgs::PoseStamped;
use super::nav_msgs::Path;
use super::std_msgs::Header;
use super::{Action, Empty, Named};
use serde::{Deserialize, Serialize};

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

/// To drive to a pose.
pub(crate) struct NavigateToPose;

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NavigateToPoseGoal {
    pub(crate) pose: PoseStamped,
    pub(crate) behavior_tree: String,
}

/// The outcome of an action that has no other.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Ended {
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NavigateToPoseFeedback {
    pub(crate) current_pose: PoseStamped,
    pub(crate) navigation_time: Duration,
    pub(crate) estimated_time_remaining: Duration,
    pub(crate) number_of_recoveries: i16,
    pub(crate) distance_remaining: f32,
}

impl Action for NavigateToPose {
    const NAME: (&'static str, &'static str) = ("nav2_msgs", "NavigateToPose");
    type Goal = NavigateToPoseGoal;
    type Outcome = Ended;
    type Feedback = NavigateToPoseFeedback;
}

/// A way to a pose.
pub(crate) struct ComputePathToPose;

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ComputePathToPoseGoal {
    pub(crate) goal: PoseStamped,
    pub(crate) start: PoseStamped,
    pub(crate) planner_id: String,
    pub(crate) use_start: bool,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ComputedPath {
    pub(crate) path: Path,
    pub(crate) planning_time: Duration,
    pub(crate) error_code: u16,
    pub(crate) error_msg: String,
}

impl Action for ComputePathToPose {
    const NAME: (&'static str, &'static str) = ("nav2_msgs", "ComputePathToPose");
    type Goal = ComputePathToPoseGoal;
    type Outcome = ComputedPath;
    type Feedback = Empty;
}

/// To drive along a path.
pub(crate) struct FollowPath;

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

impl Action for FollowPath {
    const NAME: (&'static str, &'static str) = ("nav2_msgs", "FollowPath");
    type Goal = FollowPathGoal;
    type Outcome = FollowPathOutcome;
    type Feedback = FollowPathFeedback;
}
