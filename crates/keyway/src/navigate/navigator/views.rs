//! Views of what a navigator knows and does, for pictures and reports.

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
    /// The latest stamp that was observed \[s\]; `None` before the first one.
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

    /// The place of the route at which the footprint does not fit, as far as is known and sensed;
    /// `None` where it fits, and without a goal.
    pub fn misfit(&self) -> Option<Misfit> {
        let footprint = &self.parts.robot.footprint;
        Misfit::first_along(&self.route()?.smoothed, footprint, &self.world.obstacles)
    }

    /// The obstacle to which the robot was too near when it got its goal, as it was told; `None`
    /// where it was not, and from the cycle on in which it has left.
    pub fn too_near(&self) -> Option<&StartTooNear> {
        self.task()?.too_near.as_ref()
    }

    /// The points that the guide hands out along the route, its end last; none without a goal.
    pub fn guide_points(&self) -> Vec<Point> {
        self.route().map_or_else(Vec::new, |route| self.parts.guide.points(&route.smoothed))
    }

    /// The place to which the last step drove, and the rest of the way to the goal; before the
    /// first step the end of the route, and all of the way. `None` without a goal.
    pub fn guidance(&self) -> Option<Guidance> {
        self.task().map(|task| task.guidance)
    }

    /// Angle by which the robot has to turn, to either side, to face the place to which it drives,
    /// or at its goal to face as it should \[rad\]; 0 without a goal.
    pub fn turn_left_rad(&self) -> f64 {
        let (Some(task), Some(pose)) = (self.task(), self.place) else { return 0.0 };
        let left_rad = match task.mode {
            Mode::Arriving(_) => task.goal.turn_left_rad(pose).unwrap_or_default(),
            _ => pose.bearing_to(task.guidance.point),
        };
        left_rad.abs()
    }

    /// The stack that drives, fitted to its robot.
    pub const fn stack(&self) -> &FittedStack {
        &self.parts
    }

    /// The known map, as it was given and edited.
    pub fn map(&self) -> &OccupancyGrid {
        self.world.map()
    }

    /// Contradictions in what was observed lately, such as a velocity that is always 0 although the
    /// pose moves, and what was learned of the motors. None is proof of an error.
    pub fn doubts(&self) -> &[Doubt] {
        self.world.doubts()
    }

    /// Cells that hold something which the known map does not show.
    pub const fn sensed(&self) -> &BitGrid {
        self.world.sensed.sensed()
    }

    /// Moving obstacles, as estimated from the scans so far; empty where everything counts as
    /// standing (`controller.movers` of the stack).
    pub fn movers(&self) -> &[Mover] {
        self.world.tracker.as_ref().map_or(&[], |tracker| tracker.movers())
    }

    /// Ground on which movers walk to and fro, and around which the robot goes.
    pub fn gone_around(&self) -> &[Disc] {
        self.world.walked.avoided()
    }

    /// Fate of the candidates of the last decision.
    pub const fn evaluation(&self) -> &Evaluation {
        &self.record.evaluation
    }

    /// Explanation of the local planner's last decision, candidate by candidate; empty when
    /// it was not asked, and once something has changed since. Costs many times as much as the
    /// decision ([`LocalPlanner::explain`](crate::local::LocalPlanner::explain)).
    pub fn explain(&self) -> Explanation {
        let (Some(asked), Some(task)) = (&self.record.asked, self.task()) else {
            return Explanation::default();
        };
        // Nothing of it has changed since the decision.
        let scene = self.world.scene(task, (asked.pose, asked.velocity), asked.smoothed());
        let local = self.slow.as_ref().map_or(&self.parts.local, |slow| &slow.local);
        local.explain(&scene, &asked.memory)
    }

    /// Poses along the course that the last decision began, the first one where its command acts;
    /// empty for local planners that plan no farther than their command, and once something has
    /// changed since.
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

    /// Searches for a route, those that found none or the same way again included: the first one
    /// to each goal; one each time a scan shows something on the route, or no place of it is in
    /// sight; one at each way-point, and one after each wait where there was no route; and those of
    /// the recoveries. The legs between way-points count as one.
    pub const fn routes_planned(&self) -> u32 {
        self.record.counts.routes_planned
    }

    /// Number of different ways taken, the first one to each goal included: a route that leads
    /// the same way as the one before does not count. So progress can be measured along a way,
    /// however often it is planned.
    pub const fn ways_taken(&self) -> u32 {
        self.record.counts.ways_taken
    }

    /// The way-points to the goal that were skipped, by their index
    /// ([`IfWayPointBlocked`](crate::navigate::IfWayPointBlocked)).
    pub fn way_points_skipped(&self) -> &[usize] {
        self.task().map_or(&[], |task| &task.skipped)
    }

    /// Number of way-points to the goal that were passed, passed near by or skipped.
    pub fn way_points_passed(&self) -> usize {
        self.task().map_or(0, |task| task.passed)
    }

    /// Counts of all that was tried so far because the robot got no farther.
    pub const fn recoveries(&self) -> RecoveryCounts {
        self.record.counts.recoveries
    }

    /// The reason why the stop rule changed the last command; `None` when it did not, or there is
    /// none (`controller.safe` of the stack).
    pub const fn refusal(&self) -> Option<&Refusal> {
        self.record.guard.refusal()
    }

    /// Number of commands that the stop rule has changed, by reason; `None` when there is none.
    pub fn refusals(&self) -> Option<RefusalCounts> {
        self.record.guard.counts()
    }
}
