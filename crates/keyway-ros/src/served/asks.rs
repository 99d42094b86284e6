//! Actions that are answered at once: planning and smoothing of paths.

use super::{Asks, Told};
use crate::messages::builtin_interfaces::Duration;
use crate::messages::geometry_msgs::PoseStamped;
use crate::messages::nav_msgs::Path;
use crate::messages::nav2_msgs::{
    ComputePathToPose, ComputePathToPoseGoal, ComputedPath, SmoothPath, SmoothPathGoal,
    SmoothPathOutcome, jazzy, kilted,
};
use crate::messages::std_msgs::Header;
use crate::pilot::{Ended, Family, Fault, Pilot};
use std::time::Instant;

impl Asks for ComputePathToPose {
    fn answer(
        pilot: &mut Pilot,
        goal: ComputePathToPoseGoal,
        told: Told<'_>,
    ) -> (Ended, ComputedPath) {
        let start = goal.use_start.then_some(&goal.start);
        computed(pilot, (start, &[goal.goal]), told, Family::Plan)
    }
}

impl Asks for jazzy::ComputePathThroughPoses {
    fn answer(
        pilot: &mut Pilot,
        goal: jazzy::ComputePathThroughPosesGoal,
        told: Told<'_>,
    ) -> (Ended, ComputedPath) {
        let start = goal.use_start.then_some(&goal.start);
        computed(pilot, (start, &goal.goals), told, Family::PlanThrough)
    }
}

impl Asks for kilted::ComputePathThroughPoses {
    fn answer(
        pilot: &mut Pilot,
        goal: kilted::ComputePathThroughPosesGoal,
        told: Told<'_>,
    ) -> (Ended, ComputedPath) {
        let start = goal.use_start.then_some(&goal.start);
        computed(pilot, (start, &goal.goals.goals), told, Family::PlanThrough)
    }
}

fn computed(
    pilot: &mut Pilot,
    (start, goals): (Option<&PoseStamped>, &[PoseStamped]),
    told: Told<'_>,
    family: Family,
) -> (Ended, ComputedPath) {
    let began = Instant::now();
    let found = pilot.path(start, goals, told.now_s);
    let planning_time = Duration::of(began.elapsed().as_secs_f64());
    let header = Header::new(told.now_s, told.frame);
    match found {
        Ok((points, heading_rad)) => {
            let path = Path::along(&header, &points, Some(heading_rad));
            (Ended::Succeeded, ComputedPath { path, planning_time, ..ComputedPath::default() })
        }
        Err(ended) => {
            let (error_code, why) = ended.code(family);
            let (path, error_msg) = (Path { header, poses: Vec::new() }, why.to_owned());
            (ended, ComputedPath { path, planning_time, error_code, error_msg })
        }
    }
}

impl Asks for SmoothPath {
    fn answer(
        pilot: &mut Pilot,
        goal: SmoothPathGoal,
        told: Told<'_>,
    ) -> (Ended, SmoothPathOutcome) {
        let began = Instant::now();
        let smoothed = pilot.smoothed(&goal.path).and_then(|(points, fits)| {
            if fits || !goal.check_for_collisions {
                return Ok(points);
            }
            Err(Ended::failed(Fault::NoRoom, "the robot does not fit along the smoothed path"))
        });
        let smoothing_duration = Duration::of(began.elapsed().as_secs_f64());
        let header = Header::new(told.now_s, told.frame);
        let last = goal.path.poses.last();
        match smoothed {
            Ok(points) => {
                let heading_rad = last.and_then(|last| Some(last.pose.on_ground()?.theta));
                let path = Path::along(&header, &points, heading_rad);
                let was_completed = true;
                let outcome = SmoothPathOutcome {
                    path,
                    smoothing_duration,
                    was_completed,
                    ..SmoothPathOutcome::default()
                };
                (Ended::Succeeded, outcome)
            }
            Err(ended) => {
                let (error_code, why) = ended.code(Family::Smooth);
                let error_msg = why.to_owned();
                let outcome = SmoothPathOutcome {
                    path: goal.path,
                    smoothing_duration,
                    was_completed: false,
                    error_code,
                    error_msg,
                };
                (ended, outcome)
            }
        }
    }
}
