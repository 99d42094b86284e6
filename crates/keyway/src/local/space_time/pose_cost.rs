//! The cost of a heading if the robot cannot turn everywhere: the time to go by position and
//! heading, less that by position.
//!
//! On open ground, a robot turns while it drives, and its time to go is that of a point. In a
//! narrow passage it is not: a robot that is nose first in a bay has to leave it to turn around,
//! and one that is to be there tail first turns before it. This computes the least time from every
//! position and heading near the path ahead to its end, over motions on a lattice: turning on the
//! spot, ahead and, if the robot can, back, each straight on or with a turn to the next heading; a
//! car-like robot has no turns on the spot, and arcs that are as long as its turning radius
//! requires. A place is free at a heading if the footprint fits somewhere in the lattice's square
//! around it, at that heading or halfway to the next ones. The time without headings is computed
//! on the same lattice, so that both contain the same discretization error.
//!
//! # Cost
//! None for round robots that turn in place, nor if the robot can turn everywhere along its path:
//! in place or, car-like, as gently as the path bends. Otherwise linear in the places near that
//! path, with 32 headings each; headings are checked only at places that the search reaches.

use super::cost_to_go::CostToGo;
use super::fitting::{Fitting, Ground};
use super::lattice::Lattice;
use super::near::Near;
use super::pose_times::{
    Facing, HEADING_RAD, HEADINGS, MotionTicks, PoseTimes, STEP_TICKS, WayEnd,
};
use crate::geometry::Point;
use crate::local::rear::Seen;
use crate::robot::Limits;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Costs of headings at the places near the path.
#[derive(Debug, Default)]
pub(super) struct PoseCost {
    near: Near,
    fitting: Fitting,
    times: PoseTimes,
    tick_s: f64,
    /// Cost of a heading from which no path exists \[s\].
    most_s: f64,
    is_active: bool,
    way: Vec<Point>,
    last: Option<LastTurn>,
}

/// The heading at the end of the path, for a robot that cannot turn there in place.
#[derive(Clone, Copy, Debug)]
struct LastTurn {
    end: Point,
    facing: Point,
    /// Distance from the end at which it begins to matter \[m\].
    near_m: f64,
    /// Cost of a heading that is off by more than [`Self::OFF_RAD`] \[s\], and of each radian.
    once_s: f64,
    radian_s: f64,
}

impl LastTurn {
    /// A smaller error is worth a part of a manoeuvre only \[rad\].
    const OFF_RAD: f64 = 0.1;

    fn new(end: &WayEnd, driven: Driven<'_>, spacing_m: f64) -> Option<Self> {
        let Limits { min_turning_radius_m, v_max_mps, v_min_mps, acceleration_mps2, .. } =
            *driven.limits;
        let Facing::At(facing_rad) = end.facing else { return None };
        if min_turning_radius_m == 0.0 {
            return None;
        }
        let (sin, cos) = libm::sincos(facing_rad);
        let (ahead_s, start_s) = (min_turning_radius_m / v_max_mps, v_max_mps / acceleration_mps2);
        // An arc ahead and one back turn by half of the angle each; or a whole loop.
        let (once_s, radian_s) = if driven.can_reverse {
            let slower = (v_max_mps / -v_min_mps).clamp(1.0, MotionTicks::MOST_SLOWER);
            (start_s, 0.5 * ahead_s * (1.0 + slower))
        } else {
            (TAU * ahead_s, 0.0)
        };
        let (facing, near_m) = (Point::new(cos, sin), min_turning_radius_m.max(2.0 * spacing_m));
        Some(Self { end: end.at, facing, near_m, once_s, radian_s })
    }

    /// The cost of a heading near the end, in place of that of the lattice, whose headings are
    /// coarse.
    fn over(&self, at: Point, ahead: Point, of_lattice_s: f64) -> f64 {
        let part = (1.0 - at.distance(self.end) / self.near_m).max(0.0);
        let off_rad = libm::atan2(self.facing.cross(ahead), self.facing.dot(ahead)).abs();
        let last_s = (off_rad / Self::OFF_RAD).min(1.0) * self.once_s + off_rad * self.radian_s;
        part * last_s + (1.0 - part) * of_lattice_s
    }
}

/// The motions of a robot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Driven<'a> {
    pub(super) limits: &'a Limits,
    pub(super) can_reverse: bool,
    /// Cells over which it may drive backwards; `None` if it sees all around.
    pub(super) seen: Option<Seen<'a>>,
}

impl PoseCost {
    /// Takes a lattice, and determines if headings matter along the path from the robot.
    pub(super) fn fill(
        &mut self,
        (lattice, cost_to_go): (Lattice, &CostToGo),
        room_m: impl Fn(Point) -> f64,
        (ground, driven): (&Ground<'_>, Driven<'_>),
        (robot, ahead): (Point, Point),
        end: &WayEnd,
    ) {
        self.is_active = false;
        let radius_m = driven.limits.min_turning_radius_m;
        if radius_m == 0.0 && !ground.blocked.is_useful() {
            return;
        }
        self.follow((&lattice, cost_to_go), robot, end.at);
        let is_tight = |at: &Point| room_m(*at) < ground.turning_m;
        if !self.way.iter().any(is_tight) && self.is_gentle(ahead, radius_m, end.facing) {
            return;
        }
        let Self { near, fitting, times, tick_s, .. } = self;
        *tick_s = lattice.spacing_m / (STEP_TICKS * driven.limits.v_max_mps);
        let spacing_m = lattice.spacing_m;
        let motions = MotionTicks::new(driven.limits, driven.can_reverse, (*tick_s, spacing_m));
        self.last = LastTurn::new(end, driven, spacing_m);
        // A loop to a heading needs more room than a bend.
        let loops = if self.last.is_some() { 3.0 } else { 1.0 };
        let within_m = 2.0 * ground.turning_m + loops * radius_m;
        near.collect(lattice, &self.way, within_m, motions.longest_step());
        fitting.begin(near);
        if radius_m > 0.0 {
            times.look_behind(near, driven.seen);
        }
        times.fill((near, fitting), (room_m, ground), &motions, end);
        self.most_s = f64::from(times.longest()) * *tick_s;
        self.is_active = true;
    }

    /// True if the path of a point, from a direction on, bends no more than a turning radius
    /// allows, and may end at any heading: then a car-like robot can follow it.
    fn is_gentle(&self, ahead: Point, radius_m: f64, facing: Facing) -> bool {
        if radius_m == 0.0 {
            return true;
        }
        if matches!(facing, Facing::At(_) | Facing::Back(_)) {
            return false;
        }
        let is_beside = |a: Point, b: Point| {
            let turn_rad = libm::atan2(a.cross(b), a.dot(b));
            turn_rad.abs() <= Self::GENTLE_RAD
        };
        let (mut from, mut heading) = (self.way[0], ahead);
        for &to in &self.way[1..] {
            let stretch = to - from;
            if stretch.norm() < Self::GENTLE_RAD * radius_m {
                continue;
            }
            if !is_beside(heading, stretch) {
                return false;
            }
            (from, heading) = (to, stretch);
        }
        // What is left has to lie on an arc that is no tighter than the turning radius.
        let left = self.way.last().map_or(Point::default(), |&end| end - from);
        let bearing_rad = libm::atan2(heading.cross(left), heading.dot(left)).abs();
        let sine = libm::sin(bearing_rad.min(FRAC_PI_2));
        left.norm() >= 2.0 * radius_m * sine
    }

    /// Largest change of the direction from stretch to stretch of a gentle path, each as long as an
    /// arc of this angle \[rad\].
    const GENTLE_RAD: f64 = 0.5;

    /// True if the robot has to turn elsewhere before it stops here.
    pub(super) fn turns_elsewhere(&self, at: Point, ahead: Point) -> bool {
        let turned_s = self.last.map_or(Self::TURNED_S, |last| 0.5 * last.once_s);
        self.of(at, ahead).is_some_and(|heading_s| heading_s > turned_s)
    }

    /// A heading whose cost is below this is right \[s\].
    const TURNED_S: f64 = 0.3;

    /// True if headings matter somewhere along the path.
    pub(super) const fn is_active(&self) -> bool {
        self.is_active
    }

    /// Follows the path of a point from the robot to the end.
    fn follow(&mut self, (lattice, cost_to_go): (&Lattice, &CostToGo), robot: Point, end: Point) {
        self.way.clear();
        let step_m = lattice.spacing_m;
        let mut at = robot;
        self.way.push(at);
        for _ in 0..4 * lattice.side {
            if at.distance(end) <= step_m {
                break;
            }
            let (_, way) = cost_to_go.way(at);
            let norm = way.norm();
            if norm <= 0.0 {
                break;
            }
            at = at + way * (step_m / norm);
            self.way.push(at);
        }
        self.way.push(end);
    }

    /// Cost of a heading at a position, given as a direction of length 1 \[s\]; `None` if
    /// headings do not matter, or away from the path.
    pub(super) fn of(&self, at: Point, ahead: Point) -> Option<f64> {
        if !self.is_active {
            return None;
        }
        let lattice = &self.near.lattice;
        let place = lattice.place(at);
        let (x, y) = (place.x.floor(), place.y.floor());
        let last = (lattice.side - 2) as f64;
        if x < 0.0 || y < 0.0 || x > last || y > last {
            return None;
        }
        let (part_x, part_y) = (place.x - x, place.y - y);
        let corner = self.near.place((x as usize, y as usize));
        let above = corner.wrapping_add_signed(self.near.step((0, 1)));
        let turned = libm::atan2(ahead.y, ahead.x) / HEADING_RAD;
        let low = turned.floor();
        let (part, low) = (turned - low, low as i32);
        let (mut sum_s, mut weights, mut known) = (0.0, 0.0, 0.0);
        for (place, weight) in [
            (corner, (1.0 - part_x) * (1.0 - part_y)),
            (corner + 1, part_x * (1.0 - part_y)),
            (above, (1.0 - part_x) * part_y),
            (above + 1, part_x * part_y),
        ] {
            let Some(number) = self.near.number(place) else { continue };
            known += weight;
            let Some(by_place) = self.times.of_place(number) else { continue };
            for (heading, part) in [(low, 1.0 - part), (low + 1, part)] {
                let heading = heading.rem_euclid(HEADINGS as i32) as usize;
                if let Some(by_pose) = self.times.of_pose(number, heading) {
                    let weight = weight * part;
                    weights += weight;
                    sum_s += weight * f64::from(by_pose.saturating_sub(by_place)) * self.tick_s;
                }
            }
        }
        if known <= 0.0 {
            return None;
        }
        // Tiny weights are rounding errors.
        let heading_s = if weights > 1e-3 { sum_s / weights } else { self.most_s };
        let heading_s = self.last.map_or(heading_s, |last| last.over(at, ahead, heading_s));
        // Rounding must not decide between two trajectories.
        Some(f64::from(heading_s as f32))
    }
}

#[cfg(test)]
#[path = "pose_cost_tests.rs"]
mod tests;
