//! The cost of a heading where the robot cannot turn everywhere: the time to go of places and
//! headings, less that of places.
//!
//! In the open, a robot turns on its way and what is left is that of a point. In a
//! narrow place it is not: a robot that stands nose first in a bay has to get out of it to turn
//! around, and one that is to stand there tail first turns before it. This finds the least time from
//! every place and heading near the way ahead to its end, of motions on a lattice: turning on the
//! spot, ahead and, where the robot can, back, each straight on or with a turn to the next heading.
//! A place is free at a heading where the footprint fits somewhere in the lattice's square around
//! it, at that heading or half-way to the next ones. The time without headings is found on the same
//! lattice, so that what the lattice adds is in both.
//!
//! # Source
//! Dijkstra's search with buckets \[Dial1969\], from the end on.
//!
//! # Cost
//! Nothing for round robots, nor where the robot can turn everywhere on the way that it takes.
//! Otherwise linear in the places near that way, 32 headings each.

use super::cost_to_go::CostToGo;
use super::free_headings::{self as fine, BlockedHeadings};
use super::lattice::Lattice;
use crate::geometry::{Point, wrap_angle};
use crate::map::DistanceField;
use crate::robot::Limits;
use std::f64::consts::{FRAC_PI_4, TAU};

/// Values of the places near the way.
#[derive(Debug, Default)]
pub(super) struct PoseCost {
    lattice: Lattice,
    /// The number of each point of the lattice that is near the way; `NONE` for the others.
    numbers: Vec<u32>,
    /// The points near the way, as indices.
    near: Vec<u32>,
    /// At which headings the footprint fits, and from which it turns to the next one, by point.
    free: Vec<Sectors>,
    turning: Vec<Sectors>,
    /// Time to go by place and heading, and by place, in ticks.
    by_pose: Vec<u16>,
    by_place: Vec<u16>,
    buckets: Vec<Vec<u32>>,
    tick_s: f64,
    /// The cost of a heading that leads nowhere \[s\].
    most_s: f64,
    is_active: bool,
    way: Vec<Point>,
}

/// The end of the way, and how to face there.
#[derive(Clone, Copy, Debug)]
pub(super) struct WayEnd {
    pub(super) at: Point,
    pub(super) facing: Facing,
}

/// The heading at the end of the way \[rad\], from the x axis of the lattice on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Facing {
    /// Any heading is right.
    Any,
    /// At the goal.
    At(f64),
    /// The way goes on in this direction.
    On(f64),
    /// The way goes on backwards, and the robot cannot turn any more.
    Back(f64),
}

/// The ground, and the robot on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground<'a> {
    pub(super) obstacles: &'a DistanceField,
    pub(super) blocked: &'a BlockedHeadings,
    pub(super) limits: &'a Limits,
    /// No heading is free with less room than the first, all are with the second \[m\].
    pub(super) inscribed_m: f64,
    pub(super) turning_m: f64,
    pub(super) can_reverse: bool,
}

/// Angles that differ by less are the same \[rad\].
const ROUNDING_RAD: f64 = 1e-6;

/// A bit for each of the headings of the search; it stands for those up to the next ones.
type Sectors = u32;

const HEADINGS: usize = 32;

/// Between two headings \[rad\].
const HEADING_RAD: f64 = TAU / HEADINGS as f64;

const NONE: u32 = u32::MAX;

/// Not reached.
const NEVER: u16 = u16::MAX;

/// Points of the lattice that a robot comes to next, in 16 directions, and ticks for each.
const STEPS: [(i32, i32, u16); 16] = [
    (1, 0, 4),
    (2, 1, 9),
    (1, 1, 6),
    (1, 2, 9),
    (0, 1, 4),
    (-1, 2, 9),
    (-1, 1, 6),
    (-2, 1, 9),
    (-1, 0, 4),
    (-2, -1, 9),
    (-1, -1, 6),
    (-1, -2, 9),
    (0, -1, 4),
    (1, -2, 9),
    (1, -1, 6),
    (2, -1, 9),
];

/// More than the ticks of the longest motion.
const BUCKETS: usize = 512;

impl PoseCost {
    /// Takes a lattice in, and looks whether headings matter on the way from the robot.
    pub(super) fn fill(
        &mut self,
        (lattice, cost_to_go): (Lattice, &CostToGo),
        room_m: impl Fn(Point) -> f64,
        ground: &Ground<'_>,
        robot: Point,
        end: &WayEnd,
    ) {
        self.is_active = false;
        if !ground.blocked.is_useful() {
            return;
        }
        self.lattice = lattice;
        self.follow(cost_to_go, robot, end.at);
        let is_tight = |at: &Point| room_m(*at) < ground.turning_m;
        if !self.way.iter().any(is_tight) {
            return;
        }
        self.collect(2.0 * ground.turning_m);
        self.free.clear();
        self.turning.clear();
        for &index in &self.near {
            let (x, y) = (index as usize % lattice.side, index as usize / lattice.side);
            let room_m = room_m(lattice.position(x, y));
            let (free, turning) = self.free_headings((x, y), room_m, ground);
            self.free.push(free);
            self.turning.push(turning);
        }
        self.grow(ground, end);
        self.is_active = true;
    }

    /// True if headings matter somewhere on the way.
    pub(super) const fn is_active(&self) -> bool {
        self.is_active
    }

    /// Follows the way of a point from the robot to the end.
    fn follow(&mut self, cost_to_go: &CostToGo, robot: Point, end: Point) {
        self.way.clear();
        let step_m = self.lattice.spacing_m;
        let mut at = robot;
        self.way.push(at);
        for _ in 0..4 * self.lattice.side {
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

    /// Collects the points that are no farther than this from the way.
    fn collect(&mut self, within_m: f64) {
        let lattice = self.lattice;
        self.numbers.clear();
        self.numbers.resize(lattice.count(), NONE);
        self.near.clear();
        let reach = within_m / lattice.spacing_m;
        let mut last: Option<Point> = None;
        for &at in &self.way {
            if last.is_some_and(|last| last.distance(at) < 0.25 * within_m) {
                continue;
            }
            last = Some(at);
            let place = lattice.place(at);
            let [columns, rows] = lattice.within(place, reach);
            for y in rows {
                for x in columns.clone() {
                    let index = y * lattice.side + x;
                    let is_near = Point::new(x as f64, y as f64).distance(place) <= reach;
                    if is_near && self.numbers[index] == NONE {
                        self.numbers[index] = self.near.len() as u32;
                        self.near.push(index as u32);
                    }
                }
            }
        }
    }

    /// At which headings the footprint fits somewhere in the square around a point, and from which
    /// of them it can turn to the next one there.
    fn free_headings(
        &self,
        (x, y): (usize, usize),
        room_m: f64,
        ground: &Ground<'_>,
    ) -> (Sectors, Sectors) {
        let half_m = std::f64::consts::FRAC_1_SQRT_2 * self.lattice.spacing_m;
        if room_m >= ground.turning_m {
            return (Sectors::MAX, Sectors::MAX);
        }
        if room_m + half_m < ground.inscribed_m {
            return (0, 0);
        }
        let halves_per_m = 2.0 / ground.obstacles.frame().resolution_m();
        let middle = self.lattice.position(x, y) * halves_per_m;
        let side = (self.lattice.spacing_m * halves_per_m).round() as i32;
        let parts = side.clamp(1, 4);
        // The same to both sides of the middle.
        let halves = |middle: f64, part: i32| {
            let off = 0.5 * f64::from(side * (2 * part - parts)) / f64::from(parts);
            (middle + off.round()).round() as i32
        };
        let mut free = 0;
        let places = (0..=parts).flat_map(|row| (0..=parts).map(move |column| (column, row)));
        for (column, row) in places {
            let at = (halves(middle.x, column), halves(middle.y, row));
            free |= ground.blocked.free_at(at, ground.obstacles);
            if free == fine::Headings::MAX {
                break;
            }
        }
        let beside = free.rotate_left(1) | free.rotate_right(1);
        (every_other(free | beside), every_other(free.rotate_right(1)))
    }

    /// Finds all times.
    fn grow(&mut self, ground: &Ground<'_>, end: &WayEnd) {
        let Limits { v_max_mps, v_min_mps, omega_max_radps, .. } = *ground.limits;
        self.tick_s = 0.25 * self.lattice.spacing_m / v_max_mps;
        let ticks = |time_s: f64| (time_s / self.tick_s).round().clamp(1.0, 255.0) as u16;
        let turn = ticks(HEADING_RAD / omega_max_radps);
        let slower =
            if ground.can_reverse { (v_max_mps / -v_min_mps).clamp(1.0, 25.0) } else { 0.0 };
        let motions = Motions { turn, slower };
        self.buckets.resize_with(BUCKETS, Vec::new);
        self.grow_places(end.at);
        self.grow_poses(&motions, end);
        let farthest = self.by_pose.iter().filter(|&&ticks| ticks != NEVER).max();
        self.most_s = f64::from(farthest.copied().unwrap_or_default()) * self.tick_s;
    }

    /// The points around a place, whose squares it lies in or beside.
    fn around(&self, at: Point) -> impl Iterator<Item = usize> + use<> {
        let [columns, rows] = self.lattice.within(self.lattice.place(at), 1.0);
        let side = self.lattice.side;
        let indices: arrayvec::ArrayVec<usize, 9> =
            rows.flat_map(|y| columns.clone().map(move |x| y * side + x)).take(9).collect();
        indices.into_iter()
    }

    fn number_of(&self, index: usize) -> Option<usize> {
        self.numbers.get(index).filter(|&&number| number != NONE).map(|&number| number as usize)
    }

    /// The point a step away, if it is near the way.
    fn next(&self, number: usize, (dx, dy): (i32, i32)) -> Option<usize> {
        let side = self.lattice.side as i32;
        let index = self.near[number] as i32;
        let (x, y) = (index % side + dx, index / side + dy);
        ((0..side).contains(&x) && (0..side).contains(&y))
            .then(|| self.number_of((y * side + x) as usize))
            .flatten()
    }

    /// Times of a point, in any direction.
    fn grow_places(&mut self, end: Point) {
        self.by_place.clear();
        self.by_place.resize(self.near.len(), NEVER);
        let mut waiting = 0;
        for index in self.around(end) {
            if let Some(number) = self.number_of(index) {
                self.by_place[number] = 0;
                self.buckets[0].push(number as u32);
                waiting += 1;
            }
        }
        let mut now = 0_usize;
        while waiting > 0 && now < usize::from(NEVER) - BUCKETS {
            while let Some(number) = self.buckets[now % BUCKETS].pop() {
                waiting -= 1;
                if usize::from(self.by_place[number as usize]) != now {
                    continue;
                }
                for (dx, dy, ticks) in STEPS {
                    let Some(next) = self.next(number as usize, (dx, dy)) else { continue };
                    let time = now as u16 + ticks;
                    if self.free[next] != 0 && time < self.by_place[next] {
                        self.by_place[next] = time;
                        self.buckets[usize::from(time) % BUCKETS].push(next as u32);
                        waiting += 1;
                    }
                }
            }
            now += 1;
        }
        self.buckets.iter_mut().for_each(Vec::clear);
    }

    /// Times of poses.
    fn grow_poses(&mut self, motions: &Motions, end: &WayEnd) {
        self.by_pose.clear();
        self.by_pose.resize(self.near.len() * HEADINGS, NEVER);
        let mut waiting = 0;
        for index in self.around(end.at) {
            let Some(number) = self.number_of(index) else { continue };
            for heading in 0..HEADINGS {
                let Some(time) = motions.at_end(heading, end.facing) else { continue };
                let state = number * HEADINGS + heading;
                if self.free[number] >> heading & 1 == 1 {
                    self.by_pose[state] = time;
                    self.buckets[usize::from(time) % BUCKETS].push(state as u32);
                    waiting += 1;
                }
            }
        }
        let mut now = 0_usize;
        while waiting > 0 && now < usize::from(NEVER) - 2 * BUCKETS {
            while let Some(state) = self.buckets[now % BUCKETS].pop() {
                waiting -= 1;
                if usize::from(self.by_pose[state as usize]) == now {
                    waiting += self.pass_on(state as usize, now as u16, motions);
                }
            }
            now += 1;
        }
        self.buckets.iter_mut().for_each(Vec::clear);
    }

    /// Lowers the times of the poses from which the robot comes to one that is done; returns how
    /// many it lowers.
    fn pass_on(&mut self, state: usize, now: u16, motions: &Motions) -> usize {
        let (number, heading) = (state / HEADINGS, state % HEADINGS);
        let sides = [(heading + 1) % HEADINGS, (heading + HEADINGS - 1) % HEADINGS];
        let mut added = 0;
        for (side, from) in [(sides[0], heading), (sides[1], sides[1])] {
            if self.turning[number] >> from & 1 == 1 {
                added += self.lower(number, side, now + motions.turn);
            }
        }
        // Headings between two directions take both.
        let directions = [heading / 2, heading.div_ceil(2) % STEPS.len()];
        for direction in &directions[..=heading % 2] {
            let (dx, dy, ticks) = STEPS[*direction];
            if let Some(from) = self.next(number, (-dx, -dy)) {
                added += self.lower(from, heading, now + ticks);
                for side in sides {
                    added += self.lower(from, side, now + ticks.max(motions.turn));
                }
            }
            if motions.slower == 0.0 {
                continue;
            }
            if let Some(from) = self.next(number, (dx, dy)) {
                let ticks = (f64::from(ticks) * motions.slower).round() as u16;
                added += self.lower(from, heading, now + ticks);
                for side in sides {
                    added += self.lower(from, side, now + ticks.max(motions.turn));
                }
            }
        }
        added
    }

    fn lower(&mut self, number: usize, heading: usize, time: u16) -> usize {
        let state = number * HEADINGS + heading;
        if self.free[number] >> heading & 1 == 0 || time >= self.by_pose[state] {
            return 0;
        }
        self.by_pose[state] = time;
        self.buckets[usize::from(time) % BUCKETS].push(state as u32);
        1
    }

    /// The cost of a heading at a place, a direction of length 1 \[s\]; `None` where headings do
    /// not matter, or away from the way.
    pub(super) fn of(&self, at: Point, ahead: Point) -> Option<f64> {
        if !self.is_active {
            return None;
        }
        let lattice = &self.lattice;
        let place = lattice.place(at);
        let (x, y) = (place.x.floor(), place.y.floor());
        let last = (lattice.side - 2) as f64;
        if x < 0.0 || y < 0.0 || x > last || y > last {
            return None;
        }
        let (part_x, part_y) = (place.x - x, place.y - y);
        let corner = y as usize * lattice.side + x as usize;
        let turned = libm::atan2(ahead.y, ahead.x) / HEADING_RAD;
        let low = turned.floor();
        let (part, low) = (turned - low, low as i32);
        let (mut sum_s, mut weights, mut known) = (0.0, 0.0, 0.0);
        for (index, weight) in [
            (corner, (1.0 - part_x) * (1.0 - part_y)),
            (corner + 1, part_x * (1.0 - part_y)),
            (corner + lattice.side, (1.0 - part_x) * part_y),
            (corner + lattice.side + 1, part_x * part_y),
        ] {
            let Some(number) = self.number_of(index) else { continue };
            known += weight;
            let by_place = self.by_place[number];
            if by_place == NEVER {
                continue;
            }
            for (heading, part) in [(low, 1.0 - part), (low + 1, part)] {
                let heading = heading.rem_euclid(HEADINGS as i32) as usize;
                let by_pose = self.by_pose[number * HEADINGS + heading];
                if by_pose != NEVER {
                    let weight = weight * part;
                    weights += weight;
                    sum_s += weight * f64::from(by_pose.saturating_sub(by_place)) * self.tick_s;
                }
            }
        }
        if known <= 0.0 {
            return None;
        }
        // Weights that are hardly any are rounding.
        let heading_s = if weights > 1e-3 { sum_s / weights } else { self.most_s };
        // What rounding adds must not decide between two courses.
        Some(f64::from(heading_s as f32))
    }
}

/// The bits with even numbers.
fn every_other(bits: u64) -> u32 {
    let mut even = bits & 0x5555_5555_5555_5555;
    even = (even | even >> 1) & 0x3333_3333_3333_3333;
    even = (even | even >> 2) & 0x0f0f_0f0f_0f0f_0f0f;
    even = (even | even >> 4) & 0x00ff_00ff_00ff_00ff;
    even = (even | even >> 8) & 0x0000_ffff_0000_ffff;
    (even | even >> 16) as u32
}

/// Costs of motions, in ticks.
#[derive(Clone, Copy, Debug)]
struct Motions {
    /// To the next heading.
    turn: u16,
    /// A way back takes so many times as long as one ahead; 0 where the robot cannot reverse.
    slower: f64,
}

impl Motions {
    /// The time that is left at the end of the way at a heading; `None` where the way does not end
    /// there.
    fn at_end(&self, heading: usize, facing: Facing) -> Option<u16> {
        let off_rad = |wanted_rad: f64| wrap_angle(HEADING_RAD * heading as f64 - wanted_rad).abs();
        match facing {
            Facing::Any => Some(0),
            Facing::At(wanted_rad) => {
                (off_rad(wanted_rad) <= HEADING_RAD + ROUNDING_RAD).then_some(0)
            }
            Facing::Back(wanted_rad) => {
                (off_rad(wanted_rad) <= FRAC_PI_4 + ROUNDING_RAD).then_some(0)
            }
            // About as far aside it goes on as well.
            Facing::On(wanted_rad) => {
                let aside_rad = (off_rad(wanted_rad) - FRAC_PI_4).max(0.0);
                let ticks = (aside_rad / HEADING_RAD).round() as u16 * self.turn;
                // No wait is longer than there are buckets.
                Some(ticks.min(BUCKETS as u16 - 1))
            }
        }
    }
}

#[cfg(test)]
#[path = "pose_cost_tests.rs"]
mod tests;
