//! The cost of a heading if the robot cannot turn everywhere: the time to go by position and
//! heading, less that by position.
//!
//! On open ground, a robot turns while it drives, and its time to go is that of a point. In a
//! narrow passage it is not: a robot that is nose first in a bay has to leave it to turn around,
//! and one that is to be there tail first turns before it. This computes the least time from
//! every position and heading near the path ahead to its end, over motions on a lattice: turning
//! on the spot, ahead and, if the robot can, back, each straight on or with a turn to the next
//! heading. A place is free at a heading if the footprint fits somewhere in the lattice's square
//! around it, at that heading or halfway to the next ones. The time without headings is computed
//! on the same lattice, so that both contain the same discretization error.
//!
//! # Cost
//! None for round robots, nor if the robot can turn everywhere along its path. Otherwise linear
//! in the places near that path, with 32 headings each; headings are checked only at places that
//! the search reaches.

use super::cost_to_go::CostToGo;
use super::fitting::{Fitting, Ground};
use super::lattice::Lattice;
use super::near::Near;
use super::pose_times::{HEADING_RAD, HEADINGS, MotionTicks, PoseTimes, STEP_TICKS, WayEnd};
use crate::geometry::Point;
use crate::robot::Limits;

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
}

/// The motions of a robot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Driven<'a> {
    pub(super) limits: &'a Limits,
    pub(super) can_reverse: bool,
}

impl PoseCost {
    /// Takes a lattice, and determines if headings matter along the path from the robot.
    pub(super) fn fill(
        &mut self,
        (lattice, cost_to_go): (Lattice, &CostToGo),
        room_m: impl Fn(Point) -> f64,
        (ground, driven): (&Ground<'_>, Driven<'_>),
        robot: Point,
        end: &WayEnd,
    ) {
        self.is_active = false;
        if !ground.blocked.is_useful() {
            return;
        }
        self.follow((&lattice, cost_to_go), robot, end.at);
        let is_tight = |at: &Point| room_m(*at) < ground.turning_m;
        if !self.way.iter().any(is_tight) {
            return;
        }
        let Self { near, fitting, times, tick_s, .. } = self;
        near.collect(lattice, &self.way, 2.0 * ground.turning_m);
        fitting.begin(near);
        *tick_s = lattice.spacing_m / (STEP_TICKS * driven.limits.v_max_mps);
        let motions = MotionTicks::new(driven.limits, driven.can_reverse, *tick_s);
        times.fill((near, fitting), (room_m, ground), &motions, end);
        self.most_s = f64::from(times.longest()) * *tick_s;
        self.is_active = true;
    }

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
        // Rounding must not decide between two trajectories.
        Some(f64::from(heading_s as f32))
    }
}

#[cfg(test)]
#[path = "pose_cost_tests.rs"]
mod tests;
