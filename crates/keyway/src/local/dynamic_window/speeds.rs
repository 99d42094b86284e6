//! Contact and clearance of the candidates of one turn rate.
//!
//! At any time the positions of all speeds lie on a line ([`super::motion`]), and for each box
//! near that line one measurement bounds the distance of all of them from it, by two straight
//! lines over the speed ([`NearObstacles::apart`]). So the speeds are judged together first, then
//! in parts. Each part only inherits the boxes that are still in doubt: those that may be the
//! nearest, or too near. If a robot drives along a wall, both lines are the distance itself, and
//! nothing is measured again. On open ground one query per pose decides for all speeds. All
//! lengths are in cells.

use super::counting::Counting;
use super::motion::{Timing, TurnRatePoses};
use super::stretch::Stretch;
use crate::geometry::{Pose, Velocity};
use crate::map::{Apart, Core, GridFrame, Line, NearObstacles, Placement, Sweep, Turned, on_grid};
use std::ops::Range;

/// Bounds for the speeds that are being judged.
#[derive(Debug, Default)]
pub(super) struct Bounds {
    /// Items in doubt; those of a part follow those of the speeds that it is a part of.
    doubtful: Vec<Doubt>,
    /// Lower bound of the clearance of a single speed at each pose.
    room: Vec<f64>,
    /// Memory for intermediate poses.
    spare: Vec<Turned>,
}

/// Something at a pose that may be too near, or the nearest, with bounds of its distance from the
/// slowest speed to the fastest.
#[derive(Clone, Copy, Debug)]
struct Doubt {
    pose: usize,
    what: What,
    apart: Apart,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    /// All boxes and the border: they have to be searched for.
    Anything,
    Box(u32),
    Border,
}

impl Doubt {
    /// Distances that differ by less than this are equal up to rounding \[cells\].
    const ROUNDING: f64 = 1e-10;

    /// Nothing is known at a pose except for a lower bound of the distance.
    const fn of_anything(pose: usize, at_least: Line) -> Self {
        let apart = Apart { at_least, at_most: Line::level(f64::MAX) };
        Self { pose, what: What::Anything, apart }
    }

    /// True if both bounds are the distance itself.
    fn is_exact(&self) -> bool {
        !self.is_nearer_than(self.apart.at_most)
    }

    /// True if it may be nearer for some speed.
    #[inline]
    fn is_nearer_than(&self, other: Line) -> bool {
        let Line { begin, end } = self.apart.at_least;
        begin < other.begin - Self::ROUNDING || end < other.end - Self::ROUNDING
    }

    /// Bounds for the speeds between two fractions.
    fn between(self, ends: [f64; 2]) -> Self {
        let Apart { at_least, at_most } = self.apart;
        let apart = Apart { at_least: at_least.between(ends), at_most: at_most.between(ends) };
        Self { apart, ..self }
    }
}

/// The speeds of one turn rate.
#[derive(Debug)]
pub(super) struct Speeds<'w, 'a> {
    pub(super) frame: &'w GridFrame,
    pub(super) counting: &'w Counting,
    pub(super) timing: &'w Timing,
    pub(super) motion: &'w TurnRatePoses,
    pub(super) surroundings: &'w mut NearObstacles<'a>,
    pub(super) bounds: &'w mut Bounds,
    pub(super) all_mps: &'w [f64],
    pub(super) omega_radps: f64,
    pub(super) core: &'w Core<'w>,
}

/// A range of consecutive speeds.
#[derive(Clone, Copy, Debug)]
struct Part {
    low_mps: f64,
    high_mps: f64,
    /// Half of the largest motion of any part of the core in the first stretch and in each of the
    /// others.
    half_moves: [f64; 2],
}

impl Part {
    /// Position of a speed between the lowest and the highest, from 0 to 1.
    fn fraction(&self, v_mps: f64) -> f64 {
        let width_mps = self.high_mps - self.low_mps;
        if width_mps > 0.0 { (v_mps - self.low_mps) / width_mps } else { 0.0 }
    }
}

/// Knowledge about the speeds that a part is taken from.
#[derive(Clone, Copy, Debug)]
struct Known {
    part: Part,
    /// Upper bound of the distance of each speed. If it is exact, it may be missing among the
    /// doubts.
    nearest: Doubt,
}

/// Upper bound of the distance of each speed of a part.
#[derive(Clone, Copy, Debug)]
struct Nearest {
    doubt: Doubt,
    /// True if it was known before.
    is_known: bool,
}

/// A stretch that is checked in pieces.
struct Way {
    number: usize,
    begin: Pose,
    candidate: Velocity,
}

/// A pose on a stretch, by its fraction from 0 to 1.
#[derive(Clone, Copy)]
struct Stop<'t> {
    fraction: f64,
    placement: Placement<'t>,
}

impl Speeds<'_, '_> {
    /// Number of parts into which speeds are split, repeatedly.
    const PARTS: usize = 8;

    /// After this many halvings, a piece of a stretch that cannot be shown to be free counts as
    /// contact.
    const MOST_HALVINGS: u32 = 8;

    /// Reports for each speed the core's smallest distance at the poses, up to the farthest that
    /// counts, or `None` on contact. Some speeds are known to be `touching` something; at the
    /// poses outside of `near` nothing is near enough to count.
    pub(super) fn judge(
        &mut self,
        near: &Range<usize>,
        touching: &[bool],
        mut report: impl FnMut(usize, Option<f64>),
    ) {
        let mut first = 0;
        for speeds in touching.chunk_by(|one, next| one == next) {
            let (is_touching, speeds) = (speeds[0], first..first + speeds.len());
            first = speeds.end;
            if is_touching {
                speeds.for_each(|index| report(index, None));
            } else if near.is_empty() {
                speeds.for_each(|index| report(index, Some(self.counting.farthest)));
            } else {
                self.judge_unknown(speeds, near.clone(), &mut report);
            }
        }
    }

    /// The same for speeds about which nothing is known.
    fn judge_unknown<R: FnMut(usize, Option<f64>)>(
        &mut self,
        speeds: Range<usize>,
        near: Range<usize>,
        report: &mut R,
    ) {
        let unknown = |pose| Doubt::of_anything(pose, Line::level(f64::MIN));
        let known = Known { part: self.part(&speeds), nearest: unknown(0) };
        let count = near.len();
        self.bounds.doubtful.clear();
        self.bounds.doubtful.extend(near.map(unknown));
        self.judge_part(speeds, 0..count, &known, report);
    }

    /// The same for a part, in which only some items are in doubt.
    fn judge_part<R: FnMut(usize, Option<f64>)>(
        &mut self,
        speeds: Range<usize>,
        doubtful: Range<usize>,
        known: &Known,
        report: &mut R,
    ) {
        let begin = self.bounds.doubtful.len();
        let part = self.part(&speeds);
        let looked = self.look(&part, doubtful, known);
        let doubtful = begin..self.bounds.doubtful.len();
        match looked {
            Some(nearest) if doubtful.is_empty() => speeds.for_each(|index| {
                let distance = nearest.apart.at_most.at(part.fraction(self.all_mps[index]));
                report(index, Some(distance.min(self.counting.farthest)));
            }),
            Some(nearest) if speeds.len() == 1 => {
                let is_free = self.is_free(&part, doubtful);
                let distance = nearest.apart.at_most.begin.min(self.counting.farthest);
                report(speeds.start, is_free.then_some(distance));
            }
            Some(nearest) => {
                let step = speeds.len().div_ceil(Self::PARTS);
                let known = Known { part, nearest };
                for first in speeds.clone().step_by(step) {
                    let some = first..(first + step).min(speeds.end);
                    self.judge_part(some, doubtful.clone(), &known, report);
                }
            }
            None => speeds.for_each(|index| report(index, None)),
        }
        self.bounds.doubtful.truncate(begin);
    }

    fn part(&self, speeds: &Range<usize>) -> Part {
        let (low_mps, high_mps) = (self.all_mps[speeds.start], self.all_mps[speeds.end - 1]);
        let fastest = Velocity::new(low_mps.abs().max(high_mps.abs()), self.omega_radps);
        let half = |number| 0.5 * self.stretch(number, fastest).moves_m / self.frame.resolution_m();
        Part { low_mps, high_mps, half_moves: [half(0), half(1)] }
    }

    fn stretch(&self, number: usize, candidate: Velocity) -> Stretch {
        Stretch::new(self.timing, number, candidate, self.core.swing_m())
    }

    /// Measures the items in doubt and appends those that remain in doubt, the nearest first.
    /// Returns an upper bound of the distance of every speed; `None` if all touch something.
    fn look(&mut self, part: &Part, doubtful: Range<usize>, known: &Known) -> Option<Doubt> {
        let begin = self.bounds.doubtful.len();
        let ends = [part.low_mps, part.high_mps].map(|v_mps| known.part.fraction(v_mps));
        let mut nearest = Nearest { doubt: known.nearest.between(ends), is_known: true };
        for position in doubtful {
            let doubt = self.bounds.doubtful[position].between(ends);
            if !self.is_in_doubt(part, &doubt, &nearest) {
                continue;
            }
            if doubt.what == What::Anything {
                self.look_around(part, doubt.pose, &mut nearest)?;
            } else if doubt.is_exact() {
                self.count(doubt, &mut nearest)?;
            } else {
                let sweep = self.motion.sweep(doubt.pose, [part.low_mps, part.high_mps]);
                self.look_at(part, &sweep, doubt, &mut nearest)?;
            }
        }
        let mut kept = begin;
        for position in begin..self.bounds.doubtful.len() {
            let doubt = self.bounds.doubtful[position];
            if self.is_in_doubt(part, &doubt, &nearest) {
                self.bounds.doubtful[kept] = doubt;
                let middle = |doubt: &Doubt| doubt.apart.at_most.middle();
                if middle(&doubt) < middle(&self.bounds.doubtful[begin]) {
                    self.bounds.doubtful.swap(begin, kept);
                }
                kept += 1;
            }
        }
        self.bounds.doubtful.truncate(kept);
        Some(nearest.doubt)
    }

    /// True if something may be too near, or the nearest.
    #[inline]
    fn is_in_doubt(&self, part: &Part, doubt: &Doubt, nearest: &Nearest) -> bool {
        let least = doubt.apart.at_least.least();
        least < self.needed_room(part, doubt.pose)
            || self.counts(doubt)
                && least < self.counting.farthest
                && doubt.is_nearer_than(nearest.doubt.apart.at_most)
    }

    /// Searches for boxes near a pose and appends those that remain in doubt; `None` if all touch
    /// something.
    #[inline]
    fn look_around(&mut self, part: &Part, pose: usize, nearest: &mut Nearest) -> Option<()> {
        let sweep = self.motion.sweep(pose, [part.low_mps, part.high_mps]);
        let (origin, is_near_border) = (sweep.middle.origin, self.counting.is_near_border);
        let enough = self.enough(part, pose, nearest);
        if !is_near_border && self.surroundings.is_beyond(origin, enough + sweep.half_length) {
            return Some(());
        }
        let begin = self.bounds.doubtful.len();
        let unknown = Doubt::of_anything(pose, Line::level(f64::MIN));
        if is_near_border {
            let apart = self.surroundings.border_apart(&sweep);
            self.count(Doubt { what: What::Border, apart, ..unknown }, nearest)?;
        }
        let around = self.surroundings.around(origin);
        for near in around.boxes() {
            let enough = self.enough(part, pose, nearest);
            if !self.surroundings.may_be_nearer(near, enough + sweep.half_length) {
                break;
            }
            self.look_at(part, &sweep, Doubt { what: What::Box(near), ..unknown }, nearest)?;
        }
        let to_others = self.surroundings.to_others(&around) - sweep.half_length;
        if to_others < self.enough(part, pose, nearest) {
            // A box that is farther away in the middle may be nearer at an end.
            self.forget(pose, begin, to_others);
        }
        Some(())
    }

    /// Replaces the items found at a pose, from a position on, by a lower bound of their
    /// distance.
    fn forget(&mut self, pose: usize, begin: usize, to_others: f64) {
        let (mut kept, mut at_least) = (begin, Line::level(to_others));
        for position in begin..self.bounds.doubtful.len() {
            let doubt = self.bounds.doubtful[position];
            if doubt.pose == pose {
                at_least = at_least.below(doubt.apart.at_least);
            } else {
                self.bounds.doubtful[kept] = doubt;
                kept += 1;
            }
        }
        self.bounds.doubtful.truncate(kept);
        self.bounds.doubtful.push(Doubt::of_anything(pose, at_least));
    }

    /// Measures an item again and appends it if it remains in doubt; `None` if all touch it.
    #[inline]
    fn look_at(
        &mut self,
        part: &Part,
        sweep: &Sweep<'_>,
        doubt: Doubt,
        nearest: &mut Nearest,
    ) -> Option<()> {
        let enough = self.enough(part, doubt.pose, nearest);
        let apart = match doubt.what {
            What::Box(near) => self.surroundings.apart(near, sweep, enough),
            _ => Some(self.surroundings.border_apart(sweep)),
        };
        let Some(apart) = apart else {
            return Some(());
        };
        self.count(Doubt { apart, ..doubt }, nearest)
    }

    /// Appends a measured item; `None` if all touch it.
    #[inline]
    fn count(&mut self, doubt: Doubt, nearest: &mut Nearest) -> Option<()> {
        let at_most = doubt.apart.at_most;
        if at_most.most() < self.counting.contact {
            return None;
        }
        if self.counts(&doubt) && at_most.middle() < nearest.doubt.apart.at_most.middle() {
            let before = std::mem::replace(nearest, Nearest { doubt, is_known: false });
            if before.is_known && before.doubt.is_exact() {
                // It may still be the nearest of some speeds.
                self.bounds.doubtful.push(before.doubt);
            }
        }
        self.bounds.doubtful.push(doubt);
        Some(())
    }

    /// Distance from a pose beyond which no doubt remains.
    #[inline]
    fn enough(&self, part: &Part, pose: usize, nearest: &Nearest) -> f64 {
        let needed = self.needed_room(part, pose);
        if !self.counts_pose(pose) {
            return needed;
        }
        nearest.doubt.apart.at_most.most().min(self.counting.farthest).max(needed)
    }

    /// True if an item counts for the smallest distance; the border does not.
    #[inline]
    fn counts(&self, doubt: &Doubt) -> bool {
        doubt.what != What::Border && self.counts_pose(doubt.pose)
    }

    /// Distance from obstacles and border; exact up to `most`.
    fn room(&mut self, at: &Placement<'_>, most: f64) -> f64 {
        let distance = self.surroundings.distance(at, most);
        let is_near_border = self.counting.is_near_border;
        if is_near_border { distance.min(self.surroundings.to_border(at)) } else { distance }
    }

    #[inline]
    fn counts_pose(&self, pose: usize) -> bool {
        self.counting.counts_all || pose + 1 == self.motion.poses()
    }

    /// Clearance at a pose with which half of the stretches before and after it are free.
    #[inline]
    fn needed_room(&self, part: &Part, index: usize) -> f64 {
        let [first, other] = part.half_moves;
        self.counting.certain + if index < 2 { first.max(other) } else { other }
    }

    /// True if a single speed touches nothing, given the items that may leave too little
    /// clearance.
    fn is_free(&mut self, part: &Part, doubtful: Range<usize>) -> bool {
        let candidate = Velocity::new(part.low_mps, self.omega_radps);
        let last = self.motion.poses() - 1;
        let (first_in_doubt, last_in_doubt) = self.fill_room(part, doubtful);
        let is_in_doubt = |this: &Self, pose| this.bounds.room[pose] < this.needed_room(part, pose);
        (first_in_doubt..=last_in_doubt).all(|pose| {
            !is_in_doubt(self, pose)
                || (pose == 0 || self.is_stretch_free(pose - 1, candidate))
                    && (pose == last
                        || is_in_doubt(self, pose + 1)
                        || self.is_stretch_free(pose, candidate))
        })
    }

    /// Fills in the clearance of a speed at the poses with items in doubt, and at those before
    /// and after them. Returns the first and the last of the former.
    fn fill_room(&mut self, part: &Part, doubtful: Range<usize>) -> (usize, usize) {
        let count = self.motion.poses();
        let poses = self.bounds.doubtful[doubtful.clone()].iter().map(|doubt| doubt.pose);
        let (first, last) =
            poses.fold((count, 0), |(first, last), pose| (first.min(pose), last.max(pose)));
        self.bounds.room.resize(count, 0.0);
        for pose in first.saturating_sub(1)..(last + 2).min(count) {
            self.bounds.room[pose] = self.needed_room(part, pose);
        }
        for doubt in &self.bounds.doubtful[doubtful] {
            let room = &mut self.bounds.room[doubt.pose];
            *room = room.min(doubt.apart.at_least.least());
        }
        (first, last)
    }

    /// True if the motion from a pose to the next is free. After a motion by s, of l in all, the
    /// clearance is at least r1 - s and r2 - (l - s), so with r1 + r2 - l >= 2 c it is at least c
    /// everywhere. Otherwise the motion is checked as a straight line, and then each half of it.
    fn is_stretch_free(&mut self, number: usize, candidate: Velocity) -> bool {
        let (Stretch { moves_m, deviation_m }, cell_m) =
            (self.stretch(number, candidate), self.frame.resolution_m());
        let room = self.bounds.room[number] + self.bounds.room[number + 1];
        if room - moves_m / cell_m >= 2.0 * self.counting.certain {
            return true;
        }
        let motion = self.motion;
        let stop = |index: usize, fraction| Stop {
            fraction,
            placement: motion.placement(index, candidate.v),
        };
        let (from, to) = (stop(number, 0.0), stop(number + 1, 1.0));
        let deviation = deviation_m / cell_m;
        if self.is_straight_way_free(from, to, deviation) {
            return true;
        }
        let begin = self.motion.pose(self.timing, number, candidate.v, self.frame);
        let way = Way { number, begin, candidate };
        self.is_free_in_halves(&way, [from, to], deviation, Self::MOST_HALVINGS)
    }

    fn is_free_in_halves(
        &mut self,
        way: &Way,
        [from, to]: [Stop<'_>; 2],
        deviation: f64,
        halvings: u32,
    ) -> bool {
        let fraction = 0.5 * (from.fraction + to.fraction);
        let pose = self.timing.between(way.number, way.begin, way.candidate, fraction);
        let (origin, ahead) = on_grid(pose, self.frame);
        let mut turned = self.bounds.spare.pop().unwrap_or_default();
        turned.turn(self.core, ahead);
        let middle = Stop { fraction, placement: Placement { origin, turned: &turned } };
        let contact = self.counting.contact;
        let is_free = self.room(&middle.placement, contact.abs() + 1.0) >= contact
            && [[from, middle], [middle, to]].into_iter().all(|[from, to]| {
                self.is_straight_way_free(from, to, 0.25 * deviation)
                    || halvings > 1
                        && self.is_free_in_halves(way, [from, to], 0.25 * deviation, halvings - 1)
            });
        self.bounds.spare.push(turned);
        is_free
    }

    /// True if a motion with this deviation from a straight line is free. The border's distance
    /// is concave, so it is smallest at an end.
    fn is_straight_way_free(&mut self, from: Stop<'_>, to: Stop<'_>, deviation: f64) -> bool {
        let (from, to) = (&from.placement, &to.placement);
        let least = self.counting.contact + deviation;
        let is_inside = !self.counting.is_near_border
            || self.surroundings.to_border(from).min(self.surroundings.to_border(to)) >= least;
        is_inside && self.surroundings.is_kept(from, to, least)
    }
}
