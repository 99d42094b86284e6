//! Read access to the state of a navigator, for plots and reports.

use super::Navigator;
use crate::geometry::{Disc, Point, Pose};
use crate::guide::Guidance;
use crate::local::{Evaluation, Explanation, Refusal, RefusalCounts};
use crate::map::{BitGrid, OccupancyGrid};
use crate::navigate::mode::Mode;
use crate::navigate::start::StartTooNear;
use crate::navigate::time::Time;
use crate::navigate::{Doubt, FittedStack, Goal, Misfit, RecoveryCounts};
use crate::route::Route;
use crate::sense::Mover;

impl Navigator {
    /// The latest observed stamp \[s\]; `None` before the first one.
    pub fn now_s(&self) -> Option<f64> {
        self.world.now().map(Time::stamp_s)
    }

    /// The goal, if there is one.
    pub fn goal(&self) -> Option<Goal> {
        self.task().map(|task| task.goal)
    }

    /// The route being followed: to the goal, or to the next way-point; `None` without a goal.
    pub fn route(&self) -> Option<&Route> {
        self.task().map(|task| &task.route)
    }

    /// The first misfit of the footprint along the route, given the known and the sensed
    /// obstacles; `None` if it fits, and without a goal.
    pub fn misfit(&self) -> Option<Misfit> {
        let footprint = &self.parts.robot.footprint;
        Misfit::first_along(&self.route()?.smoothed, footprint, &self.world.obstacles)
    }

    /// The obstacle that the robot was too close to when its goal was set; `None` if there was
    /// none, and from the cycle on in which the robot has left it.
    pub fn too_near(&self) -> Option<&StartTooNear> {
        self.task()?.too_near.as_ref()
    }

    /// The guide points along the route, its end last; none without a goal.
    pub fn guide_points(&self) -> Vec<Point> {
        self.route().map_or_else(Vec::new, |route| self.parts.guide.points(&route.smoothed))
    }

    /// The guide point of the last step and the remaining path length to the goal; before the
    /// first step, the end of the route and its whole length. `None` without a goal.
    pub fn guidance(&self) -> Option<Guidance> {
        self.task().map(|task| task.guidance)
    }

    /// Absolute angle by which the robot has to rotate to face its guide point, or at its goal to
    /// reach the goal heading \[rad\]; 0 without a goal.
    pub fn turn_left_rad(&self) -> f64 {
        let (Some(task), Some(pose)) = (self.task(), self.place) else { return 0.0 };
        let left_rad = match task.mode {
            Mode::Arriving(_) => task.goal.turn_left_rad(pose).unwrap_or_default(),
            _ => pose.bearing_to(task.guidance.point),
        };
        left_rad.abs()
    }

    /// The stack that drives the robot, fitted to it.
    pub const fn stack(&self) -> &FittedStack {
        &self.parts
    }

    /// The known map, as it was given and edited.
    pub fn map(&self) -> &OccupancyGrid {
        self.world.map()
    }

    /// Contradictions in recent observations, such as a velocity that is always 0 although the
    /// pose moves, and properties of the motors that were learned. None of them proves an error.
    pub fn doubts(&self) -> &[Doubt] {
        self.world.doubts()
    }

    /// Cells with obstacles that the known map does not show.
    pub const fn sensed(&self) -> &BitGrid {
        self.world.sensed.sensed()
    }

    /// Moving obstacles, as estimated from the scans so far; empty if everything counts as
    /// stationary (`controller.movers` of the stack).
    pub fn movers(&self) -> &[Mover] {
        self.world.tracker.as_ref().map_or(&[], |tracker| tracker.movers())
    }

    /// Areas in which moving obstacles walk back and forth, and which the robot avoids.
    pub fn gone_around(&self) -> &[Disc] {
        self.world.walked.avoided()
    }

    /// Statistics of the candidates of the last decision.
    pub const fn evaluation(&self) -> &Evaluation {
        &self.record.evaluation
    }

    /// Explanation of the local planner's last decision, candidate by candidate; empty if the
    /// planner was not called, and once an input has changed since. Costs many times as much as
    /// the decision ([`LocalPlanner::explain`](crate::local::LocalPlanner::explain)).
    pub fn explain(&self) -> Explanation {
        let (Some(asked), Some(task)) = (&self.record.asked, self.task()) else {
            return Explanation::default();
        };
        // None of the inputs has changed since the decision.
        let scene = self.world.scene(task, (asked.pose, asked.velocity), asked.jerk_limited());
        let local = self.slow.as_ref().map_or(&self.parts.local, |slow| &slow.local);
        local.explain(&scene, &asked.memory)
    }

    /// Poses along the trajectory of the last decision, the first one at the time at which its
    /// command takes effect; empty for local planners that plan no farther than their command,
    /// and once an input has changed since.
    pub fn course(&self) -> Vec<Pose> {
        const PARTS: u32 = 4;
        let (Some(asked), Some(task)) = (&self.record.asked, self.task()) else {
            return Vec::new();
        };
        let Some(course) = task.memory.course() else { return Vec::new() };
        let (mut pose, mut from) = (asked.pose, asked.velocity);
        let mut poses = vec![pose];
        for &to in &course.velocities {
            let at = |part: u32| from.lerp(to, f64::from(part) / f64::from(PARTS));
            for part in 0..PARTS {
                let part_s = course.stretch_s / f64::from(PARTS);
                pose = pose.after_ramp(at(part), at(part + 1), part_s);
                poses.push(pose);
            }
            from = to;
        }
        poses
    }

    /// Number of route searches, including those that failed or found the same route: the first
    /// one to each goal; one each time a scan shows an obstacle on the route, or no point of it
    /// is in line of sight; one at each way-point; one after each wait without a route; and those
    /// of the recoveries. The legs between way-points count as one.
    pub const fn routes_planned(&self) -> u32 {
        self.record.counts.routes_planned
    }

    /// Number of different routes taken, including the first one to each goal. A route that
    /// follows the one before does not count, so that progress can be measured along a route
    /// however often it is replanned.
    pub const fn ways_taken(&self) -> u32 {
        self.record.counts.ways_taken
    }

    /// The way-points to the goal that were skipped, by their index
    /// ([`IfWayPointBlocked`](crate::navigate::IfWayPointBlocked)).
    pub fn way_points_skipped(&self) -> &[usize] {
        self.task().map_or(&[], |task| &task.skipped)
    }

    /// Number of way-points to the goal that were passed, passed nearby or skipped.
    pub fn way_points_passed(&self) -> usize {
        self.task().map_or(0, |task| task.passed)
    }

    /// Counts of all recoveries so far.
    pub const fn recoveries(&self) -> RecoveryCounts {
        self.record.counts.recoveries
    }

    /// The reason why the stop rule changed the last command; `None` if it did not, or without a
    /// stop rule (`controller.safe` of the stack).
    pub const fn refusal(&self) -> Option<&Refusal> {
        self.record.guard.refusal()
    }

    /// Number of commands that the stop rule has changed, by reason; `None` without a stop rule.
    pub fn refusals(&self) -> Option<RefusalCounts> {
        self.record.guard.counts()
    }
}
