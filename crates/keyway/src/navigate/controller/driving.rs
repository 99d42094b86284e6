//! One command towards the guide point.

use super::{Asked, Controller};
use crate::geometry::{Point, Pose, Segment, Velocity};
use crate::guide::{Guidance, GuideView};
use crate::local::{NoCommand, Scene};
use crate::navigate::WayProgress;

impl Controller {
    /// The local planner's command towards the current guide point.
    pub(super) fn drive(&mut self, pose: Pose, velocity: Velocity) -> Result<Velocity, NoCommand> {
        self.find_guide_point(pose.point());
        let remaining_m = self.guidance.remaining_m;
        let mut memory = self.memory.clone();
        self.asked = Some(Asked { pose, velocity, memory: memory.clone() });
        let mut scratch = std::mem::take(&mut self.scratch);
        let decision = self.local.decide(&self.scene(pose, velocity), &mut memory, &mut scratch);
        (self.memory, self.scratch) = (memory, scratch);
        self.evaluation = match &decision {
            Ok(decision) => decision.evaluation.clone(),
            Err(why) => why.evaluation.clone(),
        };
        let cycle_s = self.robot.cycle_s;
        let is_blocked = match &decision {
            Ok(decision) => self.robot.stands(decision.command),
            Err(_) => true,
        };
        let longest_s = self.stack.controller.longest_wait_s;
        let waits_s = if self.waits_for_mover() { longest_s } else { 0.0 };
        let progress_m = WayProgress::step_m(&self.robot, self.stack.controller.no_progress_s);
        self.watch.note_cycle([remaining_m, progress_m], is_blocked, waits_s, cycle_s);
        self.recovery.note_progress(remaining_m);
        Ok(decision?.command)
    }

    /// What the local planner sees.
    pub(super) fn scene(&self, pose: Pose, velocity: Velocity) -> Scene<'_> {
        let (obstacles, sensed, movers) =
            (&self.obstacles, self.sensed.sensed(), &self.movers_then[..]);
        let Guidance { point: guide, remaining_m } = self.guidance;
        let (path, seen) = (&self.route.smoothed, self.seen_cells());
        let walked = self.walked.avoided();
        Scene { obstacles, sensed, seen, movers, walked, pose, velocity, guide, path, remaining_m }
    }

    /// Where to drive: to the guide's point, or to the last place before it that is in sight.
    pub(super) fn find_guide_point(&mut self, position: Point) {
        let clearance = self.obstacles.clearance();
        let path = &self.route.smoothed;
        let clearance_m = self.needed_m();
        let view = GuideView { path, position, obstacles: clearance, clearance_m };
        let Some(guidance) = self.guide.guide(&view, &mut self.guide_memory) else { return };
        let remaining_m = guidance.remaining_m + self.later_m();
        self.guidance = Guidance { remaining_m, ..guidance };
        self.is_lost = false;
        if !self.stack.controller.watch_route {
            return;
        }
        // Where the robot has less room than its radius, the way there need not have more.
        let radius_m = self.robot.footprint.inscribed_radius_m();
        let own_m = clearance.of_point(position, radius_m).min(clearance.to_border(position));
        let room_m = radius_m.min(own_m * (1.0 - 1e-6)).max(0.0);
        if clearance.is_clear(Segment::new(position, guidance.point), room_m) {
            return;
        }
        let away_m = position.distance(guidance.point);
        let guide_m = path.length_m() - (guidance.remaining_m - away_m).max(0.0);
        match self.rest().farthest_in_sight(position, guide_m, [room_m, radius_m], &clearance) {
            Some(point) => self.guidance.point = point,
            None => self.is_lost = true,
        }
    }
}
