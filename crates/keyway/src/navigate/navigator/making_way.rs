//! Making way for an oncoming moving obstacle where two cannot pass.

use super::Deciding;
use crate::geometry::{Disc, Point};
use crate::map::Clearance;
use crate::navigate::encounter::{Encounter, Party};
use crate::navigate::mode::Mode;
use crate::navigate::navigator::replanning::Replanned;
use crate::navigate::walked_ground::is_across;
use crate::navigate::watch::RestOfRoute;
use crate::navigate::{Blocked, Step};
use crate::route::Route;

impl Deciding<'_> {
    /// Time of being held up after which the robot makes way, if it is the one to do so \[s\].
    const HELD_S: f64 = 2.0;

    /// Time after which the other party is taken not to make way, even if it should \[s\].
    const ALONE_S: f64 = 8.0;

    /// Time without progress after which a robot near the position has reached it \[s\].
    const COMES_ON_S: f64 = 1.0;

    /// Longest time that it waits beside the other party's path \[s\].
    const STANDS_S: f64 = 12.0;

    /// Records an oncoming moving obstacle.
    pub(super) fn note_met(&mut self) {
        if !self.stack.controller.make_way {
            return;
        }
        let (needed_m, ahead_m) = (self.needed_m(), 2.0 * self.robot.decision_reach_m());
        let mut met = self.task.met;
        let movers = &self.world.movers_then;
        met.note(movers, &self.rest().beginning(ahead_m), needed_m, self.elapsed_s);
        self.task.met = met;
    }

    /// Drives to a position beside the path of the obstacle that it met, if no route leads past
    /// it and the robot is the one to make way.
    pub(super) fn make_way(&mut self) -> bool {
        let Some(other) = self.task.met.disc() else { return false };
        let held_s = self.task.hold.held_s();
        if held_s < Self::HELD_S || !self.task.met.look() {
            return false;
        }
        if self.route_past(&other, self.task.next_stop()).is_some() {
            return false;
        }
        let Some(place) = self.encounter(other).place(held_s >= Self::ALONE_S) else {
            return false;
        };
        let Some(route) = self.route_past(&other, place.at) else { return false };
        self.record.counts.routes_planned += 1;
        self.record.counts.recoveries.make_way += 1;
        self.take(route);
        self.task.mode = Mode::MakingWay { place: place.at, other, stood_s: 0.0 };
        true
    }

    fn encounter(&self, other: Disc) -> Encounter<'_> {
        let footprint = &self.robot.footprint;
        let robot = Party {
            centre: self.pose.point(),
            narrow_m: footprint.inscribed_radius_m(),
            wide_m: footprint.circumscribed_radius_m(),
        };
        let other =
            Party { centre: other.centre, narrow_m: other.radius_m, wide_m: other.radius_m };
        let known = Clearance::new(self.world.known.frame(), self.world.known.occupied());
        let seen = self.world.obstacles.clearance();
        let apart_m =
            2.0 * self.robot.safety_margin_or_default_m() + 2.0 * known.frame().resolution_m();
        Encounter { known, seen, robot, other, apart_m }
    }

    /// A route that does not lead through a disc, which may be occupied.
    fn route_past(&mut self, disc: &Disc, to: Point) -> Option<Route> {
        let (from, budget) = (self.pose.point(), self.stack.controller.replan_budget);
        let needed_m = self.robot.footprint.inscribed_radius_m();
        let router = &mut self.world.router;
        let around = router.around(&self.world.known, (from, to), budget, &[*disc]);
        let is_past = |route: &Route| !is_across(disc, &route.smoothed.segments(), needed_m);
        around.or_else(|| router.again(from, to, budget).ok().filter(is_past))
    }

    /// Ends making way as soon as a route leads past the other party, or when it takes too long.
    /// Returns false if the robot does not make way.
    pub(super) fn go_on_making_way(&mut self) -> bool {
        let Mode::MakingWay { place, stood_s, other } = &mut self.task.mode else { return false };
        let config = &self.stack.controller;
        let mut near_m = config.goal_tolerance_m;
        // The position hardly has more clearance than needed: the robot drives all the way to it,
        // if it can.
        if self.task.watch.no_progress_s < Self::COMES_ON_S {
            near_m = near_m.min(self.world.known.frame().resolution_m());
        }
        if *stood_s > 0.0 || self.pose.point().distance(*place) <= near_m {
            *stood_s += self.elapsed_s;
        }
        let is_held = self.task.watch.blocked_s.max(self.task.watch.no_progress_s)
            >= config.blocked_s.max(config.no_progress_s);
        let (begun, stood_s) = (*other, *stood_s);
        let last = self.task.met.disc().unwrap_or(begun);
        if stood_s >= Self::STANDS_S || stood_s == 0.0 && is_held {
            self.take_as_gone(begun, last);
            if self.replan() == Replanned::Failed {
                self.forget_around();
            }
        } else if self.task.met.look() {
            self.pass(last);
        }
        true
    }

    /// The other party has had the time to pass, though the robot may not have seen it: the space
    /// between its first and its last sensed position counts as free again, except for obstacles
    /// in view.
    fn take_as_gone(&mut self, begun: Disc, last: Disc) {
        self.task.mode = Mode::Following;
        let radius_m = begun.radius_m.max(last.radius_m) + self.world.known.frame().resolution_m();
        let steps = (begun.centre.distance(last.centre) / radius_m).ceil().max(1.0) as u32;
        for step in 0..=steps {
            let part = f64::from(step) / f64::from(steps);
            let centre = begun.centre.lerp(last.centre, part);
            self.world.forget_disc(&Disc { centre, radius_m });
        }
        self.task.met.forget();
    }

    /// Forgets the sensed obstacles around a robot that has made way and has no route. They may
    /// be the other party, sensed as it came into view and now out of view.
    fn forget_around(&mut self) {
        let (centre, radius_m) = (self.pose.point(), Encounter::REACH_M);
        self.world.forget_disc(&Disc { centre, radius_m });
    }

    /// Takes the route to the next stop, if no moving obstacle is on its first part.
    fn pass(&mut self, other: Disc) {
        let Some(route) = self.route_past(&other, self.task.next_stop()) else { return };
        let needed_m = self.robot.footprint.inscribed_radius_m();
        let ahead_m = 2.0 * self.robot.decision_reach_m();
        let rest = RestOfRoute { path: &route.smoothed, covered_m: 0.0 };
        let movers = self.world.movers_then.iter().map(|it| Disc::new(it.centre, it.radius_m));
        let mut discs = movers.chain([other]);
        let is_taken = discs.any(|disc| is_across(&disc, &rest.beginning(ahead_m), needed_m));
        if is_taken {
            return;
        }
        self.record.counts.routes_planned += 1;
        self.task.met.forget();
        self.take(route);
    }

    /// The step of a robot that waits beside the other party's path.
    pub(super) fn stand_aside(&self) -> Option<Step> {
        let Mode::MakingWay { stood_s, .. } = self.task.mode else { return None };
        let braked = self.robot.limits.braked(self.velocity, self.robot.cycle_s);
        (stood_s > 0.0).then_some(Step::Blocked { command: braked, why: Blocked::MakingWay })
    }
}
