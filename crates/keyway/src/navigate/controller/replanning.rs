//! When a new route is planned while the robot drives, and what becomes of it.

use super::Controller;
use crate::geometry::{Disc, Point, Pose, Velocity};
use crate::guide::GuideMemory;
use crate::navigate::route::turning_clearance_m;
use crate::navigate::watch::{RestOfRoute, Watch};
use crate::route::Route;

/// What came of planning again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Replanned {
    /// The new route leads another way.
    Elsewhere,
    /// It leads the same way as the last one.
    Alike,
    /// There is none.
    Failed,
}

impl Controller {
    /// Plans again when what was sensed in this cycle cuts the route, or no place of it is in
    /// sight; begins a recovery when the robot gets no farther.
    pub(super) fn look_after_route(&mut self, pose: Pose, velocity: Velocity) {
        let position = pose.point();
        self.hold.note(position, &self.robot);
        if self.recovery.is_under_way() {
            return;
        }
        if self.no_route.is_some() {
            if self.wait_s <= 0.0 {
                self.replan(position);
            }
            return;
        }
        let window_m = self.robot.decision_reach_m();
        self.covered_m = self.route.smoothed.nearest_along(position, self.covered_m, window_m);
        if self.go_around(position) {
            return;
        }
        let config = &self.stack.controller;
        let (blocked_s, no_progress_s) = (config.blocked_s, config.no_progress_s);
        let is_cut = config.watch_route
            && self.rest().is_cut(&self.edits, self.known.frame(), self.needed_m());
        if is_cut || (self.is_lost && self.watch.route_s >= blocked_s) {
            self.replan(position);
        } else if self.watch.blocked_s >= blocked_s || self.watch.no_progress_s >= no_progress_s {
            self.recover(pose, velocity);
        }
    }

    /// Takes another way around ground on which movers walk, once that takes no longer than the
    /// robot has been held up beside it.
    fn go_around(&mut self, position: Point) -> bool {
        if !self.stack.controller.go_around {
            return false;
        }
        let Some(held_s) = self.hold.look(self.robot.cycle_s) else { return false };
        let ahead_m = 2.0 * self.robot.decision_reach_m();
        let mut ground = self.walked.across(&self.rest().beginning(ahead_m), self.needed_m());
        let left_m = self.route.smoothed.length_m() - self.covered_m;
        self.leave_ends_free(position, &mut ground);
        let Some(route) = self.route_around(position, &ground) else { return false };
        let longer_m = route.smoothed.length_m() - left_m;
        if longer_m > held_s * self.robot.limits.v_max_mps || self.is_same_way(&route) {
            return false;
        }
        self.walked.avoid(&ground);
        self.routes_planned += 1;
        self.recovery.counts.go_around += 1;
        self.take(route);
        true
    }

    /// Ground beside the robot, or beside its next stop, cannot be gone around.
    fn leave_ends_free(&self, position: Point, ground: &mut Vec<Disc>) {
        let beside_m = 2.0 * self.robot.footprint.inscribed_radius_m();
        let ends = [position, self.next_stop()];
        ground.retain(|disc| {
            ends.iter().all(|end| end.distance(disc.centre) >= disc.radius_m + beside_m)
        });
    }

    /// A route to the next stop around some ground; `None` where there is none, or no ground.
    fn route_around(&mut self, position: Point, ground: &[Disc]) -> Option<Route> {
        let (stop, budget) = (self.next_stop(), self.stack.controller.replan_budget);
        self.router.around(&self.known, (position, stop), budget, ground)
    }

    fn is_same_way(&self, route: &Route) -> bool {
        let apart_m = 2.0 * self.known.frame().resolution_m();
        self.rest().is_same_way(&route.smoothed, apart_m)
    }

    pub(super) const fn rest(&self) -> RestOfRoute<'_> {
        RestOfRoute { path: &self.route.smoothed, covered_m: self.covered_m }
    }

    /// What the way along the route needs at least: the robot must be able to turn on the spot, as
    /// far as the route leaves room for that. With less, a guide would cut corners that only the
    /// inscribed disc can pass.
    pub(super) fn needed_m(&self) -> f64 {
        turning_clearance_m(&self.stack, &self.robot).min(self.route.clearance_m)
    }

    /// Plans again on what is known and sensed, around the ground that is avoided, if there is a
    /// way around. When that fails, the old route stays, and the next attempt waits longer each
    /// time.
    pub(super) fn replan(&mut self, position: Point) -> Replanned {
        self.routes_planned += 1;
        let mut avoided = self.walked.avoided().to_vec();
        self.leave_ends_free(position, &mut avoided);
        if let Some(route) = self.route_around(position, &avoided) {
            return self.take(route);
        }
        self.walked.avoid(&[]);
        let (stop, config) = (self.next_stop(), &self.stack.controller);
        match self.router.again(position, stop, config.replan_budget) {
            Ok(route) => self.take(route),
            Err(why) => {
                let longest_s = config.longest_wait_s.max(config.blocked_s);
                self.waited_s = (2.0 * self.waited_s).clamp(config.blocked_s, longest_s);
                self.wait_s = self.waited_s;
                self.no_route = Some(why);
                self.watch = Watch::NEW;
                Replanned::Failed
            }
        }
    }

    /// Follows another route from here on.
    fn take(&mut self, route: Route) -> Replanned {
        let is_same = self.is_same_way(&route);
        self.guide_memory = GuideMemory::default();
        self.memory = std::mem::take(&mut self.memory).on_another_route();
        (self.route, self.covered_m, self.is_lost) = (route, 0.0, false);
        (self.no_route, self.waited_s) = (None, 0.0);
        if is_same {
            self.watch.route_s = 0.0;
            return Replanned::Alike;
        }
        self.ways_taken += 1;
        self.watch = Watch::NEW;
        Replanned::Elsewhere
    }
}
