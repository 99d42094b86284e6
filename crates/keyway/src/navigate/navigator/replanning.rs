//! Replanning while the robot drives: its triggers and its results.

use super::Deciding;
use crate::geometry::{Disc, Point, Polyline};
use crate::guide::GuideMemory;
use crate::navigate::layers::turning_clearance_m;
use crate::navigate::mode::Mode;
use crate::navigate::task::{GivenPath, Task};
use crate::navigate::watch::{RestOfRoute, Watch};
use crate::navigate::world::World;
use crate::navigate::{IfWayPointBlocked, Misfit};
use crate::route::Route;

/// Result of replanning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Replanned {
    /// The new route differs from the last one.
    Elsewhere,
    /// The new route is the same as the last one.
    Alike,
    /// No route exists.
    Failed,
}

impl Deciding<'_> {
    /// Replans if obstacles sensed in this cycle cut the route, or if no point of it is in line
    /// of sight. Starts a recovery if the robot makes no progress.
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

    /// Takes a detour around an area in which moving obstacles walk, once the detour takes no
    /// longer than the robot has been held up beside that area.
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
        self.note_detour(&route);
        self.take(route);
        true
    }

    /// An area beside the robot, or beside its next stop, cannot be avoided.
    fn leave_ends_free(&self, ground: &mut Vec<Disc>) {
        let beside_m = 2.0 * self.robot.footprint.inscribed_radius_m();
        let ends: [Point; 2] = [self.pose.point(), self.task.next_stop()];
        ground.retain(|disc| {
            ends.iter().all(|end| end.distance(disc.centre) >= disc.radius_m + beside_m)
        });
    }

    /// A route to the next stop around some areas; `None` if there is none, or no area.
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

    /// Minimum clearance along the route \[m\]: enough for the robot to rotate on the spot, as
    /// far as the route allows it. With less, a guide would cut corners that only the inscribed
    /// disc can pass.
    pub(super) fn needed_m(&self) -> f64 {
        turning_clearance_m(self.stack, self.robot).min(self.task.route.clearance_m)
    }

    /// The rest of an external path, if the robot is near it and fits along it.
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

    /// Replans with the known and the sensed obstacles, around the avoided areas if possible. On
    /// failure the old route stays, and the waiting time until the next attempt grows. An
    /// external path is abandoned if the robot does not fit along it.
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
        let detour_m =
            if self.task.takes_any_detour { f64::INFINITY } else { config.detour_for_clearance_m };
        let ends = (self.pose.point(), stop);
        match self.world.router.again_within(ends, config.replan_budget, detour_m) {
            Ok(route) => {
                self.note_detour(&route);
                self.take(route)
            }
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

    /// Notes how much longer a new route to the same stop is than the rest of the last one: a gap
    /// has closed. If gaps seemed to open again now and then, the robot would drive to and fro
    /// between them for ever.
    fn note_detour(&mut self, route: &Route) {
        const CLOSED_M: f64 = 2.0;
        let position = self.pose.point();
        let Task { route: last, covered_m, .. } = &*self.task;
        if last.end() != Some(self.task.next_stop()) {
            return;
        }
        let (path, window_m) = (&last.smoothed, 2.0 * self.robot.decision_reach_m());
        let covered_m = path.nearest_along(position, *covered_m, window_m);
        let Some(at) = path.at_length(covered_m) else { return };
        let rest_m = path.length_m() - covered_m + position.distance(at);
        self.task.detoured_m += (route.smoothed.length_m() - rest_m).max(0.0);
        let most_m = self.stack.controller.detour_for_clearance_m.max(CLOSED_M);
        self.task.takes_any_detour |= self.task.detoured_m > most_m;
    }

    /// Passes near a way-point that still cannot be reached, or skips it, as configured in the
    /// stack.
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
        self.task.begin_next_leg();
        self.replan();
    }

    /// The route to the reachable position that is nearest to the next way-point, if it is beside
    /// it.
    fn route_beside(&mut self) -> Option<(Point, Route)> {
        const NEAR_M: f64 = 1.0;
        let near_m = NEAR_M.max(4.0 * self.robot.footprint.circumscribed_radius_m());
        let (position, stop) = (self.pose.point(), self.task.next_stop());
        let asked = self.task.asked[self.task.passed];
        let router = &mut self.world.router;
        // An obstacle there is sensed from outside: its inside seems to be free.
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
