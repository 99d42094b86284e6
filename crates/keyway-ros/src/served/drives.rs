//! Actions that drive the robot.

use super::{Drives, Told};
use crate::messages::builtin_interfaces::Duration;
use crate::messages::geometry_msgs::PoseStamped;
use crate::messages::nav2_msgs::{
    Distance, FollowPath, FollowPathFeedback, FollowPathGoal, FollowPathOutcome, NavigateToPose,
    NavigateToPoseFeedback, NavigateToPoseGoal, Outcome, Target, TimedOutcome, Wait, WaitFeedback,
    WaitGoal, jazzy, kilted,
};
use crate::messages::std_msgs::Header;
use crate::pilot::{Act, Ended, Family, Missed, Motion, Report, Wanted};

impl Drives for NavigateToPose {
    fn wanted(goal: NavigateToPoseGoal) -> Wanted {
        Wanted::Poses(vec![goal.pose])
    }

    fn outcome(ended: &Ended, _: &Report) -> Outcome {
        outcome(ended, Family::Navigate)
    }

    fn feedback(report: &Report, told: Told<'_>) -> NavigateToPoseFeedback {
        NavigateToPoseFeedback {
            current_pose: PoseStamped {
                header: Header::new(told.now_s, told.frame),
                pose: report.pose.into(),
            },
            navigation_time: Duration::of(report.under_way_s),
            estimated_time_remaining: Duration::of(report.left_s),
            number_of_recoveries: i16::try_from(report.recoveries).unwrap_or(i16::MAX),
            distance_remaining: report.way_m as f32,
        }
    }
}

impl Drives for FollowPath {
    fn wanted(goal: FollowPathGoal) -> Wanted {
        Wanted::Path(goal.path)
    }

    fn outcome(ended: &Ended, _: &Report) -> FollowPathOutcome {
        let Outcome { error_code, error_msg } = outcome(ended, Family::Follow);
        FollowPathOutcome { error_code, error_msg, ..FollowPathOutcome::default() }
    }

    fn feedback(report: &Report, _: Told<'_>) -> FollowPathFeedback {
        FollowPathFeedback { distance_to_goal: report.way_m as f32, speed: report.speed_mps as f32 }
    }
}

impl Drives for Wait {
    fn wanted(goal: WaitGoal) -> Wanted {
        Wanted::Wait(goal.time.duration_s())
    }

    fn outcome(ended: &Ended, report: &Report) -> TimedOutcome {
        timed_outcome(ended, report, Family::Wait)
    }

    fn feedback(report: &Report, _: Told<'_>) -> WaitFeedback {
        WaitFeedback { time_left: Duration::of(report.left_s) }
    }
}

/// Single motions, whose goals have the same fields in all distributions, some with one more.
macro_rules! single_motions {
    ($($distribution:ident),+) => { $(
        impl Drives for $distribution::Spin {
            fn wanted(goal: $distribution::SpinGoal) -> Wanted {
                Wanted::Act(Act {
                    motion: Motion::Turn(f64::from(goal.target_yaw)),
                    allowance_s: goal.time_allowance.duration_s(),
                    most_mps: None,
                    fault: None,
                })
            }

            fn outcome(ended: &Ended, report: &Report) -> TimedOutcome {
                timed_outcome(ended, report, Family::Spin)
            }

            fn feedback(report: &Report, _: Told<'_>) -> Distance {
                Distance { distance: report.made.turned_rad as f32 }
            }
        }

        impl Drives for $distribution::BackUp {
            fn wanted(goal: $distribution::DriveGoal) -> Wanted {
                // As in Nav2, signs are ignored.
                let way_m = -goal.target.x.abs();
                straight(Target { x: way_m, ..goal.target }, -goal.speed.abs(), goal.time_allowance)
            }

            fn outcome(ended: &Ended, report: &Report) -> TimedOutcome {
                timed_outcome(ended, report, Family::BackUp)
            }

            fn feedback(report: &Report, _: Told<'_>) -> Distance {
                Distance { distance: report.made.driven_m as f32 }
            }
        }

        impl Drives for $distribution::DriveOnHeading {
            fn wanted(goal: $distribution::DriveGoal) -> Wanted {
                straight(goal.target, goal.speed, goal.time_allowance)
            }

            fn outcome(ended: &Ended, report: &Report) -> TimedOutcome {
                timed_outcome(ended, report, Family::DriveOnHeading)
            }

            fn feedback(report: &Report, _: Told<'_>) -> Distance {
                Distance { distance: report.made.driven_m as f32 }
            }
        }
    )+ };
}

single_motions!(jazzy, kilted);

/// A drive ahead, or back if the target is behind the robot.
fn straight(target: Target, speed_mps: f32, allowance: Duration) -> Wanted {
    let (way_m, speed_mps) = (target.x, f64::from(speed_mps));
    let fault = if target.y != 0.0 || target.z != 0.0 {
        Some("the target must lie straight ahead or behind")
    } else if speed_mps.is_nan() || speed_mps == 0.0 {
        Some("the speed must not be 0")
    } else if way_m * speed_mps < 0.0 {
        Some("the speed must have the sign of the target")
    } else {
        None
    };
    let motion = if way_m < 0.0 { Motion::Back(-way_m) } else { Motion::Ahead(way_m) };
    let (allowance_s, most_mps) = (allowance.duration_s(), Some(speed_mps.abs()));
    Wanted::Act(Act { motion, allowance_s, most_mps, fault })
}

impl Drives for jazzy::NavigateThroughPoses {
    fn wanted(goal: jazzy::NavigateThroughPosesGoal) -> Wanted {
        Wanted::Poses(goal.poses)
    }

    fn outcome(ended: &Ended, _: &Report) -> Outcome {
        outcome(ended, Family::NavigateThrough)
    }

    fn feedback(report: &Report, told: Told<'_>) -> jazzy::NavigateThroughPosesFeedback {
        jazzy::NavigateThroughPosesFeedback {
            to_pose: NavigateToPose::feedback(report, told),
            number_of_poses_remaining: poses_left(report),
        }
    }
}

impl Drives for kilted::NavigateThroughPoses {
    fn wanted(goal: kilted::NavigateThroughPosesGoal) -> Wanted {
        Wanted::Poses(goal.poses.goals)
    }

    fn outcome(ended: &Ended, _: &Report) -> kilted::NavigateThroughPosesOutcome {
        let Outcome { error_code, error_msg } = outcome(ended, Family::NavigateThrough);
        let waypoint_statuses = Vec::new();
        kilted::NavigateThroughPosesOutcome { error_code, error_msg, waypoint_statuses }
    }

    fn feedback(report: &Report, told: Told<'_>) -> kilted::NavigateThroughPosesFeedback {
        kilted::NavigateThroughPosesFeedback {
            to_pose: NavigateToPose::feedback(report, told),
            number_of_poses_remaining: poses_left(report),
            waypoint_statuses: Vec::new(),
        }
    }
}

impl Drives for jazzy::FollowWaypoints {
    fn wanted(goal: jazzy::FollowWaypointsGoal) -> Wanted {
        stops(goal)
    }

    fn outcome(ended: &Ended, report: &Report) -> jazzy::FollowWaypointsOutcome {
        let missed = |missed: &Missed| jazzy::MissedWaypoint {
            index: missed.stop as u32,
            goal: missed.pose.clone(),
            error_code: missed.ended.code(Family::Navigate).0,
        };
        let Outcome { error_code, error_msg } = outcome(ended, Family::Waypoints);
        let missed_waypoints = report.made.missed.iter().map(missed).collect();
        jazzy::FollowWaypointsOutcome { missed_waypoints, error_code, error_msg }
    }

    fn feedback(report: &Report, _: Told<'_>) -> jazzy::FollowWaypointsFeedback {
        jazzy::FollowWaypointsFeedback { current_waypoint: report.made.stop as u32 }
    }
}

impl Drives for kilted::FollowWaypoints {
    fn wanted(goal: jazzy::FollowWaypointsGoal) -> Wanted {
        stops(goal)
    }

    fn outcome(ended: &Ended, report: &Report) -> kilted::FollowWaypointsOutcome {
        let missed = |missed: &Missed| {
            let (error_code, why) = missed.ended.code(Family::Navigate);
            kilted::WaypointStatus {
                status: kilted::WaypointStatus::FAILED,
                waypoint_index: missed.stop as u32,
                waypoint_pose: missed.pose.clone(),
                error_code,
                error_msg: why.to_owned(),
            }
        };
        let Outcome { error_code, error_msg } = outcome(ended, Family::Waypoints);
        let missed_waypoints = report.made.missed.iter().map(missed).collect();
        kilted::FollowWaypointsOutcome { missed_waypoints, error_code, error_msg }
    }

    fn feedback(report: &Report, told: Told<'_>) -> jazzy::FollowWaypointsFeedback {
        jazzy::FollowWaypoints::feedback(report, told)
    }
}

fn stops(goal: jazzy::FollowWaypointsGoal) -> Wanted {
    let (first, again) = (goal.goal_index as usize, goal.number_of_loops as usize);
    Wanted::Stops { poses: goal.poses, first, again }
}

fn poses_left(report: &Report) -> i16 {
    i16::try_from(report.poses.saturating_sub(report.passed)).unwrap_or(i16::MAX)
}

fn outcome(ended: &Ended, family: Family) -> Outcome {
    let (error_code, why) = ended.code(family);
    Outcome { error_code, error_msg: why.to_owned() }
}

fn timed_outcome(ended: &Ended, report: &Report, family: Family) -> TimedOutcome {
    let Outcome { error_code, error_msg } = outcome(ended, family);
    let total_elapsed_time = Duration::of(report.under_way_s);
    TimedOutcome { total_elapsed_time, error_code, error_msg }
}
