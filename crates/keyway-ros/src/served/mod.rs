//! Actions and services of the node: those that drive the robot, and queries. Each defines the
//! task of its goal and the message of its outcome. Actions of Nav2 that this node lacks are
//! refused.

mod asks;
mod drives;
mod refused;
mod services;

use crate::error::StartError;
use crate::messages::Action;
use crate::messages::builtin_interfaces::Time;
use crate::messages::lifecycle_msgs::GetState;
use crate::messages::nav2_msgs::services::{
    ClearCostmapAroundRobot, ClearCostmapExceptRegion, ClearEntireCostmap, GetCostmap,
    GetLocalCostmap, LoadMap, ManageLifecycleNodes,
};
use crate::messages::nav2_msgs::{self, jazzy, kilted};
use crate::messages::std_srvs::IsActive;
use crate::pilot::{Ended, Pilot, Report, Wanted};
use crate::wire::{ActionServer, GoalEvent, GoalId, GoalStatus, Wire, Wired};

/// ROS distributions with different messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Distribution {
    Jazzy,
    Kilted,
}

impl Distribution {
    /// Its name, as in `ROS_DISTRO`.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Jazzy => "jazzy",
            Self::Kilted => "kilted",
        }
    }
}

/// The time and the map frame for feedback and answers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Told<'a> {
    pub(crate) now_s: f64,
    pub(crate) frame: &'a str,
}

/// An action that drives the robot.
trait Drives: Action {
    /// The task of a goal.
    fn wanted(goal: Self::Goal) -> Wanted;

    /// The message of the outcome.
    fn outcome(ended: &Ended, report: &Report) -> Self::Outcome;

    /// The feedback message.
    fn feedback(report: &Report, told: Told<'_>) -> Self::Feedback;
}

/// An action that is answered at once.
trait Asks: Action {
    /// Returns its outcome message, and how it ended.
    fn answer(pilot: &mut Pilot, goal: Self::Goal, told: Told<'_>) -> (Ended, Self::Outcome);
}

/// A request of a client.
pub(crate) enum Wish {
    Begin(GoalId, Wanted),
    Cancel(GoalId),
}

/// The server of an action that drives the robot.
pub(crate) trait Served {
    /// All requests since the last call.
    fn receive(&mut self, now: Time) -> Vec<Wish>;

    /// Ends a goal.
    fn end(&mut self, id: GoalId, status: GoalStatus, ended: &Ended, report: &Report);

    /// Sends feedback to the client of a goal.
    fn feed_back(&self, id: GoalId, report: &Report, told: Told<'_>);
}

/// The server of an action or service that is answered at once.
pub(crate) trait Answered {
    /// Answers all requests since the last call.
    fn answer_all(&mut self, pilot: &mut Pilot, told: Told<'_>);
}

impl<A: Drives + Wired> Served for ActionServer<A> {
    fn receive(&mut self, now: Time) -> Vec<Wish> {
        let wish = |event| match event {
            GoalEvent::Begin(id, goal) => Wish::Begin(id, A::wanted(goal)),
            GoalEvent::Cancel(id) => Wish::Cancel(id),
        };
        self.events(now).into_iter().map(wish).collect()
    }

    fn end(&mut self, id: GoalId, status: GoalStatus, ended: &Ended, report: &Report) {
        self.finish(id, status, A::outcome(ended, report));
    }

    fn feed_back(&self, id: GoalId, report: &Report, told: Told<'_>) {
        self.publish_feedback(id, A::feedback(report, told));
    }
}

impl<A: Asks + Wired> Answered for ActionServer<A> {
    fn answer_all(&mut self, pilot: &mut Pilot, told: Told<'_>) {
        for event in self.events(Time::of(told.now_s)) {
            // An answer comes before it can be cancelled.
            let GoalEvent::Begin(id, goal) = event else { continue };
            let (ended, outcome) = A::answer(pilot, goal, told);
            let is_found = ended == Ended::Succeeded;
            let status = if is_found { GoalStatus::Succeeded } else { GoalStatus::Aborted };
            self.finish(id, status, outcome);
        }
    }
}

/// All actions that drive the robot.
pub(crate) fn served(
    wire: &mut Wire,
    distribution: Distribution,
) -> Result<Vec<Box<dyn Served>>, StartError> {
    let mut served: Vec<Box<dyn Served>> = vec![
        Box::new(wire.action::<nav2_msgs::NavigateToPose>("navigate_to_pose")?),
        Box::new(wire.action::<nav2_msgs::FollowPath>("follow_path")?),
        Box::new(wire.action::<nav2_msgs::Wait>("wait")?),
    ];
    match distribution {
        Distribution::Jazzy => {
            let through = "navigate_through_poses";
            served.push(Box::new(wire.action::<jazzy::NavigateThroughPoses>(through)?));
            served.push(Box::new(wire.action::<jazzy::FollowWaypoints>("follow_waypoints")?));
            served.push(Box::new(wire.action::<jazzy::Spin>("spin")?));
            served.push(Box::new(wire.action::<jazzy::BackUp>("backup")?));
            served.push(Box::new(wire.action::<jazzy::DriveOnHeading>("drive_on_heading")?));
        }
        Distribution::Kilted => {
            let through = "navigate_through_poses";
            served.push(Box::new(wire.action::<kilted::NavigateThroughPoses>(through)?));
            served.push(Box::new(wire.action::<kilted::FollowWaypoints>("follow_waypoints")?));
            served.push(Box::new(wire.action::<kilted::Spin>("spin")?));
            served.push(Box::new(wire.action::<kilted::BackUp>("backup")?));
            served.push(Box::new(wire.action::<kilted::DriveOnHeading>("drive_on_heading")?));
        }
    }
    Ok(served)
}

/// All actions and services that are answered at once. The node also answers in place of other
/// Nav2 nodes, whose names are given.
pub(crate) fn answered(
    wire: &mut Wire,
    distribution: Distribution,
    stands_for: &[String],
) -> Result<Vec<Box<dyn Answered>>, StartError> {
    let through = "compute_path_through_poses";
    let mut answered = refused::refused(wire)?;
    let others: [Box<dyn Answered>; 7] = [
        Box::new(wire.service::<IsActive>("lifecycle_manager_navigation/is_active")?),
        Box::new(wire.action::<nav2_msgs::ComputePathToPose>("compute_path_to_pose")?),
        Box::new(wire.action::<nav2_msgs::SmoothPath>("smooth_path")?),
        match distribution {
            Distribution::Jazzy => {
                Box::new(wire.action::<jazzy::ComputePathThroughPoses>(through)?)
            }
            Distribution::Kilted => {
                Box::new(wire.action::<kilted::ComputePathThroughPoses>(through)?)
            }
        },
        Box::new(
            wire.service::<ManageLifecycleNodes>("lifecycle_manager_navigation/manage_nodes")?,
        ),
        Box::new(
            wire.service::<ClearCostmapExceptRegion>("local_costmap/clear_costmap_except_region")?,
        ),
        Box::new(
            wire.service::<ClearCostmapAroundRobot>("local_costmap/clear_costmap_around_robot")?,
        ),
    ];
    answered.extend(others);
    for costmap in ["global_costmap", "local_costmap"] {
        let clear = format!("{costmap}/clear_entirely_{costmap}");
        answered.push(Box::new(wire.service::<ClearEntireCostmap>(&clear)?));
        let except = format!("{costmap}/clear_except_{costmap}");
        answered.push(Box::new(wire.service::<ClearCostmapExceptRegion>(&except)?));
        let around = format!("{costmap}/clear_around_{costmap}");
        answered.push(Box::new(wire.service::<ClearCostmapAroundRobot>(&around)?));
    }
    answered.push(Box::new(wire.service::<GetCostmap>("global_costmap/get_costmap")?));
    answered.push(Box::new(wire.service::<GetLocalCostmap>("local_costmap/get_costmap")?));
    for node in stands_for {
        answered.push(Box::new(wire.service::<GetState>(&format!("{node}/get_state"))?));
        if node == "map_server" {
            answered.push(Box::new(wire.service::<LoadMap>("map_server/load_map")?));
        }
    }
    Ok(answered)
}

#[cfg(test)]
mod tests;
