//! The least times from places, and from places and headings, to the end of a way.
//!
//! # Source
//! Dijkstra's search with buckets \[Dial1969\], from the end on.

use super::fitting::{Fitting, Ground, Sectors};
use super::near::Near;
use crate::geometry::{Point, wrap_angle};
use crate::robot::Limits;
use std::f64::consts::{FRAC_PI_4, TAU};

/// Times by place and heading, and by place, in ticks.
#[derive(Debug, Default)]
pub(super) struct PoseTimes {
    by_pose: Vec<[u16; HEADINGS]>,
    by_place: Vec<u16>,
    buckets: Buckets,
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

/// The headings of a search.
pub(super) const HEADINGS: usize = Sectors::BITS as usize;

/// Between two headings \[rad\].
pub(super) const HEADING_RAD: f64 = TAU / HEADINGS as f64;

/// Angles that differ by less are the same \[rad\].
const ROUNDING_RAD: f64 = 1e-6;

/// Not reached.
const NEVER: u16 = u16::MAX;

/// Ticks of a step to the next point ahead.
pub(super) const STEP_TICKS: f64 = 4.0;

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

impl PoseTimes {
    /// Finds the times to the end of a way of everything near it, in ticks of `tick_s`. Looks at all
    /// points that are reached.
    pub(super) fn fill(
        &mut self,
        (near, fitting): (&Near, &mut Fitting),
        (room_m, ground): (impl Fn(Point) -> f64, &Ground<'_>),
        motions: &Motions,
        end: &WayEnd,
    ) {
        self.grow_places(near, end.at, |number| {
            fitting.look(number, near, &room_m, ground);
            fitting.free(number) != 0
        });
        self.grow_poses(near, fitting, motions, end);
    }

    /// The time from a place, in any direction; `None` where no way leads on.
    pub(super) fn of_place(&self, number: usize) -> Option<u16> {
        Some(self.by_place[number]).filter(|&ticks| ticks != NEVER)
    }

    /// The time from a place and a heading.
    pub(super) fn of_pose(&self, number: usize, heading: usize) -> Option<u16> {
        Some(self.by_pose[number][heading]).filter(|&ticks| ticks != NEVER)
    }

    /// The longest of all times from a place and a heading.
    pub(super) fn longest(&self) -> u16 {
        let all = self.by_pose.as_flattened().iter().copied();
        all.filter(|&ticks| ticks != NEVER).max().unwrap_or_default()
    }

    /// Times of places: those around the end, whatever is there, and others where something fits.
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
            let point = near.point(number);
            for (dx, dy, ticks) in STEPS {
                let Some(next) = near.beside(point, (dx, dy)) else { continue };
                let time = now + ticks;
                if time < self.by_place[next] && fits(next) {
                    self.by_place[next] = time;
                    self.buckets.push(time, next);
                }
            }
        }
    }

    /// Times of poses.
    fn grow_poses(&mut self, near: &Near, fitting: &Fitting, motions: &Motions, end: &WayEnd) {
        self.by_pose.clear();
        self.by_pose.resize(near.count(), [NEVER; HEADINGS]);
        for number in near.around(end.at) {
            for heading in 0..HEADINGS {
                if let Some(time) = motions.at_end(heading, end.facing) {
                    self.lower(number, heading, (time, fitting.free(number)));
                }
            }
        }
        while let Some((now, pose)) = self.buckets.pop() {
            let (number, heading) = (pose / HEADINGS, pose % HEADINGS);
            if self.by_pose[number][heading] == now {
                self.pass_on((number, heading), now, (near, fitting), motions);
            }
        }
    }

    /// Lowers the times of the poses from which the robot comes to one that is done.
    fn pass_on(
        &mut self,
        (number, heading): (usize, usize),
        now: u16,
        (near, fitting): (&Near, &Fitting),
        motions: &Motions,
    ) {
        let (left, right) = ((heading + 1) % HEADINGS, (heading + HEADINGS - 1) % HEADINGS);
        let (free, turning) = (fitting.free(number), fitting.turning(number));
        let turned = now + motions.turn;
        if turning >> heading & 1 == 1 {
            self.lower(number, left, (turned, free));
        }
        if turning >> right & 1 == 1 {
            self.lower(number, right, (turned, free));
        }
        let point = near.point(number);
        let mut come_from = |step: (i32, i32), ticks: u16| {
            if let Some(from) = near.beside(point, step) {
                let (free, then) = (fitting.free(from), now + ticks);
                self.lower(from, heading, (then, free));
                let then = then.max(turned);
                self.lower(from, left, (then, free));
                self.lower(from, right, (then, free));
            }
        };
        let mut come_along = |direction: usize| {
            let (dx, dy, ahead) = STEPS[direction];
            come_from((-dx, -dy), ahead);
            if motions.can_reverse {
                come_from((dx, dy), motions.back[direction]);
            }
        };
        come_along(heading / 2);
        // Headings between two directions take both.
        if heading % 2 == 1 {
            come_along((heading / 2 + 1) % STEPS.len());
        }
    }

    #[inline]
    fn lower(&mut self, number: usize, heading: usize, (time, free): (u16, Sectors)) {
        let known = &mut self.by_pose[number][heading];
        if free >> heading & 1 == 1 && time < *known {
            *known = time;
            self.buckets.push(time, number * HEADINGS + heading);
        }
    }
}

/// What waits for its time.
#[derive(Debug, Default)]
struct Buckets {
    waiting: Vec<Vec<u32>>,
    now: u16,
    count: usize,
}

impl Buckets {
    /// More than the ticks of the longest motion.
    const COUNT: usize = 512;

    /// Later times are as good as none.
    const END: u16 = NEVER - 2 * Self::COUNT as u16;

    #[inline]
    fn push(&mut self, time: u16, what: usize) {
        if self.waiting.is_empty() {
            self.waiting.resize_with(Self::COUNT, Vec::new);
        }
        self.waiting[usize::from(time) % Self::COUNT].push(what as u32);
        self.count += 1;
    }

    /// What comes first, and its time. At the end it begins anew.
    fn pop(&mut self) -> Option<(u16, usize)> {
        while self.count > 0 && self.now < Self::END {
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

/// Costs of motions, in ticks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motions {
    /// To the next heading.
    turn: u16,
    can_reverse: bool,
    /// Back, in each direction.
    back: [u16; STEPS.len()],
}

impl Motions {
    /// Those of a robot, in ticks of `tick_s`.
    pub(super) fn new(limits: &Limits, can_reverse: bool, tick_s: f64) -> Self {
        let Limits { v_max_mps, v_min_mps, omega_max_radps, .. } = *limits;
        let ticks = |time_s: f64| (time_s / tick_s).round().clamp(1.0, 255.0) as u16;
        let turn = ticks(HEADING_RAD / omega_max_radps);
        let slower = if can_reverse { (v_max_mps / -v_min_mps).clamp(1.0, 25.0) } else { 0.0 };
        let back = STEPS.map(|(_, _, ahead)| (f64::from(ahead) * slower).round() as u16);
        Self { turn, can_reverse, back }
    }

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
                Some(ticks.min(Buckets::COUNT as u16 - 1))
            }
        }
    }
}
