//! Least times from places, and from places and headings, to the end of a path.
//!
//! There are few durations of motions, and the poses settled at a time are stored together. So
//! the poses reached at a time are found from those settled the right number of ticks before, for
//! each duration, and no pose is reached twice: no queue, and a bit for each pose.
//!
//! # Source
//! Dijkstra's search, backwards from the end; by places with buckets \[Dial1969\].

use super::fitting::{Fitting, Ground, Sectors};
use super::near::Near;
use crate::geometry::{Point, wrap_angle};
use crate::local::rear::Seen;
use crate::robot::Limits;
use std::f64::consts::{FRAC_PI_4, TAU};
use std::ops::Range;

/// Times by place and heading, and by place, in ticks.
#[derive(Debug, Default)]
pub(super) struct PoseTimes {
    by_pose: Vec<[u16; HEADINGS]>,
    by_place: Vec<u16>,
    buckets: Buckets,
    /// The free headings at each place that are not reached yet.
    open: Vec<Sectors>,
    /// The settled poses: all of them, and by kinds of steps that lead to them.
    all: Done,
    along: [Done; KINDS],
    /// The poses at the end of the path, by their times.
    ends: Vec<(u16, u32, Sectors)>,
    /// The headings at each place at which a car-like robot may arrive backwards.
    behind: Vec<Sectors>,
}

/// The end of the path, and the required heading there.
#[derive(Clone, Copy, Debug)]
pub(super) struct WayEnd {
    pub(super) at: Point,
    pub(super) facing: Facing,
}

/// Heading at the end of the path \[rad\], from the x axis of the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Facing {
    /// Any heading is right.
    Any,
    /// Heading at the goal.
    At(f64),
    /// The path continues in this direction.
    On(f64),
    /// The path continues backwards, and the robot cannot turn any more.
    Back(f64),
}

/// Number of headings of a search.
pub(super) const HEADINGS: usize = Sectors::BITS as usize;

/// Angle between two headings \[rad\].
pub(super) const HEADING_RAD: f64 = TAU / HEADINGS as f64;

/// Angles that differ by less are the same \[rad\].
const ROUNDING_RAD: f64 = 1e-6;

/// Marks a place or pose that is not reached.
const NEVER: u16 = u16::MAX;

/// Time at which the search ends.
const END: u16 = NEVER - 2 * Done::TICKS as u16;

/// Ticks of a step to the next point ahead.
pub(super) const STEP_TICKS: f64 = 4.0;

/// Ticks of a step ahead, by kinds.
const AHEAD: [u16; KINDS] = [4, 9, 6];

/// Steps to the next points of the lattice, in 16 directions.
const STEPS: [(i32, i32); 16] = [
    (1, 0),
    (2, 1),
    (1, 1),
    (1, 2),
    (0, 1),
    (-1, 2),
    (-1, 1),
    (-2, 1),
    (-1, 0),
    (-2, -1),
    (-1, -1),
    (-1, -2),
    (0, -1),
    (1, -2),
    (1, -1),
    (2, -1),
];

/// Kinds of steps: straight, between, diagonal.
const KINDS: usize = 3;

/// The kind of a direction.
const fn kind(direction: usize) -> usize {
    [0, 1, 2, 1][direction % 4]
}

impl PoseTimes {
    /// Computes the times, in ticks, to the end of a path from everything near it. Evaluates all
    /// points that are reached.
    pub(super) fn fill(
        &mut self,
        (near, fitting): (&Near, &mut Fitting),
        (room_m, ground): (impl Fn(Point) -> f64, &Ground<'_>),
        motions: &MotionTicks,
        end: &WayEnd,
    ) {
        self.grow_places(near, end.at, |number| {
            fitting.look(number, near, &room_m, ground);
            fitting.free(number) != 0
        });
        self.grow_poses(near, fitting, motions, end);
    }

    /// Notes where a car-like robot may drive backwards: its rear stays on observed ground. One
    /// that turns in place can look there first.
    pub(super) fn look_behind(&mut self, near: &Near, seen: Option<Seen<'_>>) {
        self.behind.clear();
        self.behind.resize(near.place_count(), Sectors::MAX);
        let Some(seen) = seen else { return };
        let rears: [Point; HEADINGS] = std::array::from_fn(|heading| {
            let (sin, cos) = libm::sincos(HEADING_RAD * heading as f64);
            Point::new(cos, sin) * seen.rearmost_m()
        });
        for &place in near.places() {
            let (x, y) = near.point(place as usize);
            let at = near.lattice.position(x, y);
            let is_seen = |heading: &usize| seen.holds_point(at + rears[*heading]);
            self.behind[place as usize] =
                (0..HEADINGS).filter(is_seen).fold(0, |headings, heading| headings | 1 << heading);
        }
    }

    /// Time from a place, in any direction; `None` if no path exists.
    pub(super) fn of_place(&self, number: usize) -> Option<u16> {
        Some(self.by_place[number]).filter(|&ticks| ticks != NEVER)
    }

    /// Time from a place and a heading.
    pub(super) fn of_pose(&self, number: usize, heading: usize) -> Option<u16> {
        Some(self.by_pose[number][heading]).filter(|&ticks| ticks != NEVER)
    }

    /// The longest of all times from a place and a heading.
    pub(super) fn longest(&self) -> u16 {
        let all = self.by_pose.as_flattened().iter().copied();
        all.filter(|&ticks| ticks != NEVER).max().unwrap_or_default()
    }

    /// Computes the times of places: those around the end unconditionally, others if some heading
    /// fits.
    fn grow_places(&mut self, near: &Near, end: Point, mut fits: impl FnMut(usize) -> bool) {
        self.by_place.clear();
        self.by_place.resize(near.count(), NEVER);
        for number in near.around(end) {
            fits(number);
            self.by_place[number] = 0;
            self.buckets.push(0, number);
        }
        while let Some((now, number)) = self.buckets.pop() {
            if self.by_place[number] != now {
                continue;
            }
            let place = near.places()[number] as usize;
            for (direction, step) in STEPS.into_iter().enumerate() {
                let next = place.wrapping_add_signed(near.step(step));
                let Some(next) = near.number(next) else { continue };
                let time = now + AHEAD[kind(direction)];
                if time < self.by_place[next] && fits(next) {
                    self.by_place[next] = time;
                    self.buckets.push(time, next);
                }
            }
        }
    }

    /// Computes the times of poses.
    fn grow_poses(&mut self, near: &Near, fitting: &Fitting, motions: &MotionTicks, end: &WayEnd) {
        self.by_pose.clear();
        self.by_pose.resize(near.count(), [NEVER; HEADINGS]);
        self.open.clear();
        self.open.resize(near.place_count(), 0);
        for (number, &place) in near.places().iter().enumerate() {
            self.open[place as usize] = fitting.free(number);
        }
        self.all.clear();
        self.along.iter_mut().for_each(Done::clear);
        self.begin_at_ends(near, motions, end);
        let longest = motions.longest();
        let (mut now, mut last, mut ends) = (0, 0, 0);
        while now < END && (ends < self.ends.len() || now - last <= longest) {
            let done = self.all.count();
            while let Some(&(_, place, headings)) =
                self.ends.get(ends).filter(|(time, ..)| *time == now)
            {
                self.reach(near, place as usize, headings, now);
                ends += 1;
            }
            if motions.turns_in_place {
                self.turn_to(now, (near, fitting), motions);
            }
            for (kind, ahead) in AHEAD.into_iter().enumerate() {
                let back = motions.can_reverse.then_some((kind, motions.back[kind], false));
                for step in [(kind, ahead, true)].into_iter().chain(back) {
                    if motions.turns_in_place {
                        self.step_to(now, near, step, motions.turn);
                    } else {
                        self.arc_to(now, near, step, motions);
                    }
                }
            }
            self.all.end(now);
            self.along.iter_mut().for_each(|done| done.end(now));
            if self.all.count() > done {
                last = now;
            }
            now += 1;
        }
    }

    /// Collects the poses at the end of the path.
    fn begin_at_ends(&mut self, near: &Near, motions: &MotionTicks, end: &WayEnd) {
        self.ends.clear();
        for number in near.around(end.at) {
            self.ends.extend((0..HEADINGS).filter_map(|heading| {
                let time = motions.at_end(heading, end.facing)?;
                Some((time, near.places()[number], 1 << heading))
            }));
        }
        self.ends.sort_unstable();
    }

    /// Reaches the headings from which the robot turns to those settled one turn before.
    fn turn_to(&mut self, now: u16, (near, fitting): (&Near, &Fitting), motions: &MotionTicks) {
        for index in self.all.before(now, motions.turn) {
            let Pose { place, heading, .. } = self.all.get(index);
            let Some(number) = near.number(place) else { continue };
            let (own, turning) = (1 << heading, fitting.turning(number));
            let turned = (own & turning).rotate_left(1) | own.rotate_right(1) & turning;
            self.reach(near, place, turned, now);
        }
    }

    /// Reaches the poses from which the robot drives a step of a kind to those settled this many
    /// ticks before; meanwhile it may turn to the next heading, if that does not take longer.
    fn step_to(
        &mut self,
        now: u16,
        near: &Near,
        (kind, ticks, is_ahead): (usize, u16, bool),
        turn: u16,
    ) {
        let steps = STEPS.map(|(dx, dy)| near.step(if is_ahead { (-dx, -dy) } else { (dx, dy) }));
        let sides = |own: Sectors| own.rotate_left(1) | own.rotate_right(1);
        let is_slower = ticks >= turn;
        for index in self.along[kind].before(now, ticks) {
            let Pose { place, heading, direction } = self.along[kind].get(index);
            let own = 1 << heading;
            let headings = if is_slower { own | sides(own) } else { own };
            self.reach(near, place.wrapping_add_signed(steps[direction]), headings, now);
        }
        if is_slower {
            return;
        }
        for index in self.along[kind].before(now, turn) {
            let Pose { place, heading, direction } = self.along[kind].get(index);
            let headings = sides(1 << heading);
            self.reach(near, place.wrapping_add_signed(steps[direction]), headings, now);
        }
    }

    /// Reaches the poses from which a car-like robot drives a step of a kind, or an arc to the next
    /// heading, to those settled as many ticks before.
    fn arc_to(
        &mut self,
        now: u16,
        near: &Near,
        (kind, ticks, is_ahead): (usize, u16, bool),
        motions: &MotionTicks,
    ) {
        let steps = motions.arc_steps[kind];
        let arc = (ticks * steps).max(motions.turn).min(Done::TICKS as u16 - 1);
        let sides = |own: Sectors| own.rotate_left(1) | own.rotate_right(1);
        for (count, ticks, turns) in [(1, ticks, false), (steps, arc, true)] {
            let signed = if is_ahead { -i32::from(count) } else { i32::from(count) };
            let offsets = STEPS.map(|(dx, dy)| near.step((signed * dx, signed * dy)));
            for index in self.along[kind].before(now, ticks) {
                let Pose { place, heading, direction } = self.along[kind].get(index);
                let own = 1 << heading;
                if !is_ahead && self.behind[place] & own == 0 {
                    continue;
                }
                let headings = if turns { sides(own) } else { own };
                self.reach(near, place.wrapping_add_signed(offsets[direction]), headings, now);
            }
        }
    }

    /// Reaches those of the headings at a place that are free, and were not reached before.
    #[inline]
    fn reach(&mut self, near: &Near, place: usize, headings: Sectors, now: u16) {
        let mut new = self.open[place] & headings;
        if new == 0 {
            return;
        }
        self.open[place] &= !new;
        let Some(number) = near.number(place) else { return };
        while new != 0 {
            let heading = new.trailing_zeros() as usize;
            new &= new - 1;
            self.by_pose[number][heading] = now;
            let direction = heading / 2;
            self.all.push(Pose { place, heading, direction });
            self.along[kind(direction)].push(Pose { place, heading, direction });
            // Headings between two directions take both.
            if heading % 2 == 1 {
                let direction = (direction + 1) % STEPS.len();
                self.along[kind(direction)].push(Pose { place, heading, direction });
            }
        }
    }
}

/// A pose, and a direction in which the robot drives there.
#[derive(Clone, Copy, Debug)]
struct Pose {
    place: usize,
    heading: usize,
    direction: usize,
}

/// Poses in the order of their times.
#[derive(Debug, Default)]
struct Done {
    /// Place << 9 | heading << 4 | direction.
    poses: Vec<u32>,
    /// Number of poses at the end of each of the last ticks.
    ends: Vec<u32>,
}

impl Done {
    /// More ticks than the longest motion takes.
    const TICKS: usize = 512;

    fn clear(&mut self) {
        self.poses.clear();
        self.ends.clear();
        self.ends.resize(Self::TICKS, 0);
    }

    fn count(&self) -> usize {
        self.poses.len()
    }

    #[inline]
    fn push(&mut self, Pose { place, heading, direction }: Pose) {
        self.poses.push((place << 9 | heading << 4 | direction) as u32);
    }

    #[inline]
    fn get(&self, index: usize) -> Pose {
        let packed = self.poses[index] as usize;
        Pose { place: packed >> 9, heading: packed >> 4 & 31, direction: packed & 15 }
    }

    /// Closes a time: no more poses are added to it.
    fn end(&mut self, now: u16) {
        self.ends[usize::from(now) % Self::TICKS] = self.poses.len() as u32;
    }

    /// The poses settled this many ticks before.
    fn before(&self, now: u16, ticks: u16) -> Range<usize> {
        let Some(then) = now.checked_sub(ticks) else { return 0..0 };
        let end = |at: u16| self.ends[usize::from(at) % Self::TICKS] as usize;
        then.checked_sub(1).map_or(0, end)..end(then)
    }
}

/// Waiting places, by time.
#[derive(Debug, Default)]
struct Buckets {
    waiting: Vec<Vec<u32>>,
    now: u16,
    count: usize,
}

impl Buckets {
    /// More than the ticks of the longest step.
    const COUNT: usize = 16;

    #[inline]
    fn push(&mut self, time: u16, what: usize) {
        if self.waiting.is_empty() {
            self.waiting.resize_with(Self::COUNT, Vec::new);
        }
        self.waiting[usize::from(time) % Self::COUNT].push(what as u32);
        self.count += 1;
    }

    /// Removes the earliest place, and returns it with its time. Resets itself at the end.
    fn pop(&mut self) -> Option<(u16, usize)> {
        while self.count > 0 && self.now < END {
            if let Some(what) = self.waiting[usize::from(self.now) % Self::COUNT].pop() {
                self.count -= 1;
                return Some((self.now, what as usize));
            }
            self.now += 1;
        }
        self.waiting.iter_mut().for_each(Vec::clear);
        (self.now, self.count) = (0, 0);
        None
    }
}

/// Motions of a robot, and their durations in ticks.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionTicks {
    /// Turn to the next heading.
    turn: u16,
    turns_in_place: bool,
    /// Steps of an arc to the next heading, by kinds, of a robot that does not turn in place.
    arc_steps: [u16; KINDS],
    can_reverse: bool,
    /// Step back, by kinds.
    back: [u16; KINDS],
}

impl MotionTicks {
    /// An arc of more points along an axis could lead across a wall: no point within an inscribed
    /// radius of it is free.
    const MOST_ARC_STEPS: f64 = 6.0;

    /// Limit of the time of a step back, in steps ahead.
    pub(super) const MOST_SLOWER: f64 = 25.0;

    /// Motions of a robot, in ticks of `tick_s` and steps of `step_m`.
    pub(super) fn new(limits: &Limits, can_reverse: bool, (tick_s, step_m): (f64, f64)) -> Self {
        let Limits { v_max_mps, v_min_mps, omega_max_radps, min_turning_radius_m, .. } = *limits;
        let ticks = |time_s: f64| (time_s / tick_s).round().clamp(1.0, 255.0) as u16;
        let turn = ticks(HEADING_RAD / omega_max_radps);
        let slower =
            if can_reverse { (v_max_mps / -v_min_mps).clamp(1.0, Self::MOST_SLOWER) } else { 0.0 };
        let back = AHEAD.map(|ahead| (f64::from(ahead) * slower).round() as u16);
        let arc_m = min_turning_radius_m * HEADING_RAD;
        let arc_steps = AHEAD.map(|ahead| {
            let points = f64::from(ahead) / STEP_TICKS;
            let most = (Self::MOST_ARC_STEPS / points).floor();
            (arc_m / (points * step_m)).round().clamp(1.0, most) as u16
        });
        Self { turn, turns_in_place: limits.turns_in_place(), arc_steps, can_reverse, back }
    }

    /// Duration of the longest motion.
    fn longest(&self) -> u16 {
        let steps = self.back.into_iter().chain(AHEAD).fold(self.turn, u16::max);
        if self.turns_in_place { steps } else { Done::TICKS as u16 - 1 }
    }

    /// Number of points along an axis from the beginning of a motion to its end, at most.
    pub(super) fn longest_step(&self) -> usize {
        usize::from(2 * self.arc_steps.into_iter().fold(1, u16::max))
    }

    /// Time to go at the end of the path at a heading; `None` if the path does not end there.
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
            // The path continues equally well up to this angle aside.
            Facing::On(wanted_rad) => {
                let aside_rad = (off_rad(wanted_rad) - FRAC_PI_4).max(0.0);
                let ticks = (aside_rad / HEADING_RAD).round() as u16 * self.turn;
                Some(ticks.min(Done::TICKS as u16 - 1))
            }
        }
    }
}

#[cfg(test)]
#[path = "pose_times_tests.rs"]
mod tests;
