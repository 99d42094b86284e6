//! One command towards the guide point.

use super::{Asked, Deciding};
use crate::geometry::{Point, Polyline, Segment, Velocity};
use crate::guide::{Guidance, GuideView};
use crate::local::NoCommand;
use crate::navigate::{WayLeft, WayProgress};

impl Deciding<'_> {
    /// The local planner's command towards the current guide point.
    pub(super) fn drive(&mut self) -> Result<Velocity, NoCommand> {
        let (pose, velocity) = (self.pose, self.velocity);
        self.find_guide_point();
        let Guidance { point, remaining_m } = self.task.guidance;
        let left = WayLeft { way_m: remaining_m, turn_rad: pose.bearing_to(point).abs() };
        let mut memory = self.task.memory.clone();
        let window = self.world.motors.window().cloned();
        let robot_then = self.robot_then;
        let asked = Asked { pose, velocity, robot_then, window, memory: memory.clone() };
        let scene = self.world.scene(self.task, (pose, velocity), asked.jerk_limited());
        let decision = self.local.decide(&scene, &mut memory, &mut self.record.scratch);
        (self.task.memory, self.record.asked) = (memory, Some(asked));
        self.record.evaluation = match &decision {
            Ok(decision) => decision.evaluation.clone(),
            Err(why) => why.evaluation.clone(),
        };
        let is_blocked = match &decision {
            Ok(decision) => self.robot.stands(decision.command),
            Err(_) => true,
        };
        let config = &self.stack.controller;
        let waits_s = if self.waits_for_mover() { config.longest_wait_s } else { 0.0 };
        let progress_m = WayProgress::step_m(self.robot, config.no_progress_s);
        self.task.watch.note_cycle((left, progress_m), is_blocked, waits_s, self.elapsed_s);
        self.task.order.note_progress(remaining_m);
        Ok(decision?.command)
    }

    /// Finds the guide point: that of the guide, or the last point of the route before it in line
    /// of sight.
    pub(super) fn find_guide_point(&mut self) {
        let position = self.pose.point();
        let clearance = self.world.obstacles.clearance();
        let clearance_m = self.needed_m();
        let ahead = self.ahead();
        let path = ahead.as_ref().unwrap_or(&self.task.route.smoothed);
        let beyond_m = self.task.route.smoothed.length_m() - path.length_m();
        let view = GuideView { path, position, obstacles: clearance, clearance_m };
        let Some(guidance) = self.guide.guide(&view, &mut self.task.guide_memory) else { return };
        let guidance = Guidance { remaining_m: guidance.remaining_m + beyond_m, ..guidance };
        let remaining_m = guidance.remaining_m + self.task.later_m();
        self.task.guidance = Guidance { remaining_m, ..guidance };
        self.task.is_lost = false;
        if !self.stack.controller.watch_route {
            return;
        }
        // If the robot has less clearance than its radius, the line to the guide point need not
        // have more.
        let radius_m = self.robot.footprint.inscribed_radius_m();
        let own_m = clearance.of_point(position, radius_m).min(clearance.to_border(position));
        let room_m = radius_m.min(own_m * (1.0 - 1e-6)).max(0.0);
        if clearance.is_clear(Segment::new(position, guidance.point), room_m) {
            return;
        }
        match self.farthest_in_sight(position, guidance, [room_m, radius_m]) {
            Some(point) => self.task.guidance.point = point,
            None => self.task.is_lost = true,
        }
    }

    /// The part of an external path that a guide is shown: as far as decisions reach, since a
    /// guide would cut loops short. `None` for a planned route.
    fn ahead(&self) -> Option<Polyline> {
        self.task.given.as_ref()?;
        let path = &self.task.route.smoothed;
        let end_m = self.task.covered_m + self.robot.decision_reach_m();
        let mut at_m = 0.0;
        let before = path.points().iter().zip(path.segments()).take_while(|(_, leg)| {
            at_m += leg.length();
            at_m < end_m
        });
        let mut points: Vec<Point> = path.points().first().copied().into_iter().collect();
        points.extend(before.map(|(_, leg)| leg.b));
        points.extend(path.at_length(end_m.min(path.length_m())));
        Some(Polyline::new(points))
    }

    /// The farthest point of the route up to the guide point to which the straight line keeps a
    /// clearance \[m\], unless it is closer than the second length \[m\].
    fn farthest_in_sight(
        &self,
        position: Point,
        guidance: Guidance,
        lengths_m: [f64; 2],
    ) -> Option<Point> {
        let away_m = position.distance(guidance.point);
        let length_m = self.task.route.smoothed.length_m();
        let guide_m = length_m - (guidance.remaining_m - away_m).max(0.0);
        let clearance = self.world.obstacles.clearance();
        self.rest().farthest_in_sight(position, guide_m, lengths_m, &clearance)
    }
}
