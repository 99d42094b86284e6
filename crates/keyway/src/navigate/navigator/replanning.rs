//! New routes while the robot drives: their occasions, and their results.

use super::Deciding;
use crate::geometry::{Disc, Point, Polyline};
use crate::guide::GuideMemory;
use crate::navigate::mode::Mode;
use crate::navigate::route::turning_clearance_m;
use crate::navigate::task::{GivenPath, Task};
use crate::navigate::watch::{RestOfRoute, Watch};
use crate::navigate::world::World;
use crate::navigate::{IfWayPointBlocked, Misfit};
use crate::route::Route;

/// Result of planning again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Replanned {
    /// The new route leads another way.
    Elsewhere,
    /// It leads the same way as the last one.
    Alike,
    /// There is none.
    Failed,
}

impl Deciding<'_> {
    /// Plans again when what was sensed in this cycle cuts the route, or no place of it is in
    /// sight; begins a recovery when the robot gets no farther.
    pub(super) fn look_after_route(&mut self) {
        let position = self.pose.point();
        self.task.hold.note(position, self.robot, self.elapsed_s);
        if self.task.mode.is_recovering() {
            return;
        }
        self.note_met();
        if let Mode::Waiting { left_s, .. } = self.task.mode {
            if self.make_way() {
                return;
            }
            if left_s <= 0.0 && self.replan() == Replanned::Failed {
                self.leave_way_point();
            }
            return;
        }
        let (window_m, route) = (self.robot.decision_reach_m(), &self.task.route);
        self.task.covered_m = route.smoothed.nearest_along(position, self.task.covered_m, window_m);
        if let Some(GivenPath { path, covered_m }) = &mut self.task.given {
            *covered_m = path.nearest_along(position, *covered_m, window_m);
        }
        if self.go_on_making_way() || self.go_around() || self.make_way() {
            return;
        }
        let config = &self.stack.controller;
        let (blocked_s, no_progress_s) = (config.blocked_s, config.no_progress_s);
        let frame = self.world.known.frame();
        let is_marked = self.world.has_changed_much
            || self.rest().is_cut(&self.world.edits, frame, self.needed_m());
        let is_cut = config.watch_route && is_marked;
        let watch = &self.task.watch;
        if is_cut || (self.task.is_lost && watch.route_s >= blocked_s) {
            self.replan();
        } else if watch.blocked_s >= blocked_s || watch.no_progress_s >= no_progress_s {
            self.recover();
        }
    }

    /// Takes another way around ground on which movers walk, once that takes no longer than the
    /// robot has been held up beside it.
    fn go_around(&mut self) -> bool {
        if !self.stack.controller.go_around {
            return false;
        }
        let Some(held_s) = self.task.hold.look() else { return false };
        let ahead_m = 2.0 * self.robot.decision_reach_m();
        let (rest, needed_m) = (self.rest(), self.needed_m());
        let mut ground = self.world.walked.across(&rest.beginning(ahead_m), needed_m);
        let left_m = self.task.route.smoothed.length_m() - self.task.covered_m;
        self.leave_ends_free(&mut ground);
        let Some(route) = self.route_around(&ground) else { return false };
        let longer_m = route.smoothed.length_m() - left_m;
        if longer_m > held_s * self.robot.limits.v_max_mps || self.is_same_way(&route) {
            return false;
        }
        self.world.walked.avoid(&ground);
        self.task.given = None;
        self.record.counts.routes_planned += 1;
        self.record.counts.recoveries.go_around += 1;
        self.take(route);
        true
    }

    /// Ground beside the robot, or beside its next stop, cannot be gone around.
    fn leave_ends_free(&self, ground: &mut Vec<Disc>) {
        let beside_m = 2.0 * self.robot.footprint.inscribed_radius_m();
        let ends: [Point; 2] = [self.pose.point(), self.task.next_stop()];
        ground.retain(|disc| {
            ends.iter().all(|end| end.distance(disc.centre) >= disc.radius_m + beside_m)
        });
    }

    /// A route to the next stop around some ground; `None` where there is none, or no ground.
    fn route_around(&mut self, ground: &[Disc]) -> Option<Route> {
        let ends = (self.pose.point(), self.task.next_stop());
        let World { router, known, .. } = &mut *self.world;
        router.around(known, ends, self.stack.controller.replan_budget, ground)
    }

    fn is_same_way(&self, route: &Route) -> bool {
        let apart_m = 2.0 * self.world.known.frame().resolution_m();
        self.rest().is_same_way(&route.smoothed, apart_m)
    }

    pub(super) const fn rest(&self) -> RestOfRoute<'_> {
        RestOfRoute { path: &self.task.route.smoothed, covered_m: self.task.covered_m }
    }

    /// Least clearance of the way along the route \[m\]: the robot must be able to turn on the
    /// spot, as far as the route leaves room for that. With less, a guide would cut corners that
    /// only the inscribed disc can pass.
    pub(super) fn needed_m(&self) -> f64 {
        turning_clearance_m(self.stack, self.robot).min(self.task.route.clearance_m)
    }

    /// The rest of a path that was given from elsewhere, if the robot is near it and fits along it.
    fn given_again(&self) -> Option<Route> {
        let GivenPath { path, covered_m } = self.task.given.as_ref()?;
        let position = self.pose.point();
        let covered_m = path.nearest_along(position, *covered_m, path.length_m());
        let rest: Vec<Point> =
            RestOfRoute { path, covered_m }.segments().map(|leg| leg.b).collect();
        let begin = path.at_length(covered_m)?;
        if rest.is_empty() || begin.distance(position) > Task::near_m(self.robot) {
            return None;
        }
        let rest = Polyline::new([begin].into_iter().chain(rest).collect());
        let (footprint, obstacles) = (&self.robot.footprint, &self.world.obstacles);
        if Misfit::first_along(&rest, footprint, obstacles).is_some() {
            return None;
        }
        let clearance_m = self.world.router.clearance_along(&rest);
        Some(Route { smoothed: rest, clearance_m, ..Route::default() })
    }

    /// Plans again on what is known and sensed, around the ground that is avoided, if there is a
    /// way around. When that fails, the old route stays, and the next attempt waits longer each
    /// time. A path from elsewhere is left where the robot does not fit along it.
    pub(super) fn replan(&mut self) -> Replanned {
        if let Some(route) = self.given_again() {
            return self.take(route);
        }
        self.task.given = None;
        self.record.counts.routes_planned += 1;
        let mut avoided = self.world.walked.avoided().to_vec();
        self.leave_ends_free(&mut avoided);
        if let Some(route) = self.route_around(&avoided) {
            return self.take(route);
        }
        self.world.walked.avoid(&[]);
        let (stop, config) = (self.task.next_stop(), &self.stack.controller);
        match self.world.router.again(self.pose.point(), stop, config.replan_budget) {
            Ok(route) => self.take(route),
            Err(why) => {
                let longest_s = config.longest_wait_s.max(config.blocked_s);
                let wait_s = (2.0 * self.task.waited_s).clamp(config.blocked_s, longest_s);
                self.task.waited_s = wait_s;
                self.task.mode = Mode::Waiting { why, left_s: wait_s };
                self.task.watch = Watch::NEW;
                Replanned::Failed
            }
        }
    }

    /// Passes a way-point to which there still is no route near by, or skips it, as the stack says.
    fn leave_way_point(&mut self) {
        let is_out_of_reach =
            matches!(&self.task.mode, Mode::Waiting { why, .. } if why.is_of_goal());
        if self.task.is_last_leg() || !is_out_of_reach {
            return;
        }
        match self.stack.controller.if_way_point_blocked {
            IfWayPointBlocked::Wait => return,
            IfWayPointBlocked::Skip => {}
            IfWayPointBlocked::PassNear => {
                if let Some((place, route)) = self.route_beside() {
                    self.task.stops[self.task.passed].0 = place;
                    self.take(route);
                    return;
                }
            }
        }
        self.task.skipped.push(self.task.passed);
        self.task.passed += 1;
        self.task.waited_s = 0.0;
        self.replan();
    }

    /// The route to the place beside the next way-point that is nearest to it and can be reached.
    fn route_beside(&mut self) -> Option<(Point, Route)> {
        const NEAR_M: f64 = 1.0;
        let near_m = NEAR_M.max(4.0 * self.robot.footprint.circumscribed_radius_m());
        let (position, stop) = (self.pose.point(), self.task.next_stop());
        let asked = self.task.asked[self.task.passed];
        let router = &mut self.world.router;
        // What stands there is seen from outside: within it there seems to be room.
        let place = router.nearest_reachable(position, asked)?;
        if place == stop || place.distance(asked) > near_m {
            return None;
        }
        let budget = self.stack.controller.replan_budget;
        Some((place, router.again(position, place, budget).ok()?))
    }

    /// Follows another route from here on.
    pub(super) fn take(&mut self, route: Route) -> Replanned {
        let is_same = self.is_same_way(&route);
        let task = &mut *self.task;
        task.guide_memory = GuideMemory::default();
        task.memory = std::mem::take(&mut task.memory).on_another_route();
        (task.route, task.covered_m, task.is_lost) = (route, 0.0, false);
        task.waited_s = 0.0;
        if matches!(task.mode, Mode::Waiting { .. } | Mode::MakingWay { .. }) {
            task.mode = Mode::Following;
        }
        if is_same {
            task.watch.route_s = 0.0;
            return Replanned::Alike;
        }
        self.record.counts.ways_taken += 1;
        task.led_from = None;
        task.watch = Watch::NEW;
        Replanned::Elsewhere
    }
}
