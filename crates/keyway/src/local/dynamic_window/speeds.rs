//! The candidates of one turn rate: which of them touch something, and how near the others come to obstacles.
//!
//! At any time the places of all speeds lie on a line ([`super::motion`]), and what is measured in its middle bounds
//! them all: no speed is farther from there than half the line is long. So the speeds are judged together first, then in
//! parts, and with each part only the poses go on that leave a doubt: that may be the nearest, or too near. In open
//! ground one look per pose decides for all speeds. All lengths are in cells.

use super::motion::{Motion, Timing};
use super::stretch::Stretch;
use crate::geometry::{Pose, Velocity};
use crate::map::{Core, GridFrame, Placement, Surroundings, Turned, on_grid};
use std::ops::Range;

/// What counts as contact and as near.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counting {
    /// Anything nearer than this to the core is contact.
    pub(super) contact: f64,
    /// Distances that are at least this count as this.
    pub(super) farthest: f64,
    /// Whether the nearest of all poses counts, or the last one alone.
    pub(super) counts_all: bool,
    /// Whether the map's border can matter.
    pub(super) is_near_border: bool,
}

/// Lower bounds at a predicted pose.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bound {
    /// Of the distance to obstacles.
    pub(super) distance: f64,
    /// Of the distance to obstacles and to the map's border.
    pub(super) room: f64,
}

/// What is known of the poses of the speeds that are being judged.
#[derive(Debug, Default)]
pub(super) struct Bounds {
    at: Vec<Bound>,
    /// Poses in doubt: those of a part after those of the speeds that it is a part of.
    doubtful: Vec<Doubt>,
    /// Memory for poses between.
    spare: Vec<Turned>,
}

/// A pose in doubt.
#[derive(Clone, Copy, Debug)]
struct Doubt {
    index: usize,
    at_least: Bound,
}

/// The speeds of one turn rate.
#[derive(Debug)]
pub(super) struct Speeds<'w, 'a> {
    pub(super) frame: &'w GridFrame,
    pub(super) counting: &'w Counting,
    pub(super) timing: &'w Timing,
    pub(super) motion: &'w Motion,
    pub(super) surroundings: &'w mut Surroundings<'a>,
    pub(super) bounds: &'w mut Bounds,
    pub(super) all_mps: &'w [f64],
    pub(super) omega_radps: f64,
    pub(super) core: &'w Core<'w>,
}

/// Some speeds that follow one another.
#[derive(Clone, Copy, Debug)]
struct Part {
    middle_mps: f64,
    half_width_mps: f64,
    /// Half of what any part of the core moves in the first stretch and in each of the others.
    half_moves: [f64; 2],
}

/// Bounds at a pose.
struct Between {
    at_least: Bound,
    /// Of the distance to obstacles.
    at_most: f64,
}

/// A stretch that is looked at in pieces.
struct Way {
    number: usize,
    begin: Pose,
    candidate: Velocity,
}

/// A place on a stretch, from 0 to 1.
#[derive(Clone, Copy)]
struct Stop<'t> {
    fraction: f64,
    placement: Placement<'t>,
}

impl Speeds<'_, '_> {
    /// Speeds are judged together, then in so many parts, and so on.
    const PARTS: usize = 8;

    /// After so many halvings, a piece of a stretch that cannot be shown to be free counts as contact.
    const MOST_HALVINGS: u32 = 8;

    /// Reports for each speed the core's smallest distance at the poses, up to what counts, or `None` on
    /// contact. Of the first pose, which they share, the bounds are exact.
    pub(super) fn judge(&mut self, first: Bound, mut report: impl FnMut(usize, Option<f64>)) {
        let poses = self.motion.poses();
        self.bounds.at.clear();
        self.bounds.at.resize(poses, first);
        self.bounds.doubtful.clear();
        let nothing = Bound { distance: 0.0, room: f64::NEG_INFINITY };
        let doubts = (0..poses).map(|index| Doubt { index, at_least: nothing });
        self.bounds.doubtful.extend(doubts);
        let all = 0..self.all_mps.len();
        self.judge_part(all, 0..poses, self.counting.farthest, &mut report);
    }

    /// The same for a part, in which only some poses are in doubt, and each speed comes as near as `nearest`.
    fn judge_part<R: FnMut(usize, Option<f64>)>(
        &mut self,
        speeds: Range<usize>,
        doubtful: Range<usize>,
        nearest: f64,
        report: &mut R,
    ) {
        let begin = self.bounds.doubtful.len();
        let part = self.part(&speeds);
        let looked = self.look(&part, doubtful, nearest);
        let doubtful = begin..self.bounds.doubtful.len();
        match looked {
            Some(nearest) if doubtful.is_empty() => {
                speeds.for_each(|index| report(index, Some(nearest)));
            }
            Some(nearest) if speeds.len() == 1 => {
                let is_free = self.is_free(&part, doubtful);
                report(speeds.start, is_free.then_some(nearest));
            }
            Some(nearest) => {
                let step = speeds.len().div_ceil(Self::PARTS);
                for first in speeds.clone().step_by(step) {
                    let some = first..(first + step).min(speeds.end);
                    self.judge_part(some, doubtful.clone(), nearest, report);
                }
            }
            None => speeds.for_each(|index| report(index, None)),
        }
        self.bounds.doubtful.truncate(begin);
    }

    fn part(&self, speeds: &Range<usize>) -> Part {
        let (low, high) = (self.all_mps[speeds.start], self.all_mps[speeds.end - 1]);
        let fastest = Velocity::new(low.abs().max(high.abs()), self.omega_radps);
        let half = |number| 0.5 * self.stretch(number, fastest).moves_m / self.frame.resolution_m();
        let (middle_mps, half_width_mps) = (0.5 * (low + high), 0.5 * (high - low));
        Part { middle_mps, half_width_mps, half_moves: [half(0), half(1)] }
    }

    fn stretch(&self, number: usize, candidate: Velocity) -> Stretch {
        Stretch::new(self.timing, number, candidate, self.core.swing_m())
    }

    /// Looks at the poses in doubt and appends those that are still in doubt, the nearest first. Gives a distance
    /// that every speed comes as near as; `None` when all touch something.
    fn look(&mut self, part: &Part, doubtful: Range<usize>, mut nearest: f64) -> Option<f64> {
        let begin = self.bounds.doubtful.len();
        for position in doubtful {
            let Doubt { index, at_least } = self.bounds.doubtful[position];
            let needed = self.needed_room(part, index);
            let counts = self.counts(index);
            if at_least.room >= needed && !(counts && at_least.distance < nearest) {
                self.bounds.at[index] = at_least;
                continue;
            }
            let enough = if counts { nearest.max(needed) } else { needed };
            let Between { at_least, at_most } = self.bound(part, index, enough)?;
            if counts {
                nearest = nearest.min(at_most);
            }
            self.bounds.at[index] = at_least;
            self.bounds.doubtful.push(Doubt { index, at_least });
        }
        let mut kept = begin;
        for position in begin..self.bounds.doubtful.len() {
            let doubt = self.bounds.doubtful[position];
            let Doubt { index, at_least: Bound { distance, room } } = doubt;
            if room < self.needed_room(part, index) || self.counts(index) && distance < nearest {
                self.bounds.doubtful[kept] = doubt;
                if distance < self.bounds.doubtful[begin].at_least.distance {
                    self.bounds.doubtful.swap(begin, kept);
                }
                kept += 1;
            }
        }
        self.bounds.doubtful.truncate(kept);
        Some(nearest)
    }

    /// Bounds at a pose that hold for all speeds of a part, where more than `enough` is not told apart; `None` when
    /// all touch something there.
    #[inline]
    fn bound(&mut self, part: &Part, index: usize, enough: f64) -> Option<Between> {
        if index == 0 {
            let at_least = self.bounds.at[0];
            return Some(Between { at_least, at_most: at_least.distance });
        }
        let motion = self.motion;
        let at = motion.placement(index, part.middle_mps);
        let spread = motion.spread(index, part.half_width_mps);
        if !self.counting.is_near_border && self.surroundings.is_beyond(at.origin, enough + spread)
        {
            let at_least = Bound { distance: enough, room: enough };
            return Some(Between { at_least, at_most: f64::INFINITY });
        }
        let Bound { distance, room } = self.measure(&at, enough + spread);
        // From outside the map the distance is only a lower bound.
        let is_exact = !self.counting.is_near_border || self.surroundings.is_inside(at.origin);
        let at_most = if is_exact { distance + spread } else { f64::INFINITY };
        (room + spread >= self.counting.contact).then_some(Between {
            at_least: Bound { distance: distance - spread, room: room - spread },
            at_most,
        })
    }

    /// Distance up to `most`, and room.
    #[inline]
    fn measure(&mut self, at: &Placement<'_>, most: f64) -> Bound {
        let distance = self.surroundings.distance(at, most);
        let is_near_border = self.counting.is_near_border;
        let border = if is_near_border { self.surroundings.to_border(at) } else { f64::INFINITY };
        Bound { distance, room: distance.min(border) }
    }

    #[inline]
    fn counts(&self, index: usize) -> bool {
        self.counting.counts_all || index + 1 == self.motion.poses()
    }

    /// With so much room at a pose, half of the stretches before and after it are free.
    #[inline]
    fn needed_room(&self, part: &Part, index: usize) -> f64 {
        let [first, other] = part.half_moves;
        self.counting.contact + if index < 2 { first.max(other) } else { other }
    }

    /// Whether a single speed touches nothing, given the poses at which it has too little room to say.
    fn is_free(&mut self, part: &Part, doubtful: Range<usize>) -> bool {
        let candidate = Velocity::new(part.middle_mps, self.omega_radps);
        let last = self.motion.poses() - 1;
        doubtful.into_iter().all(|position| {
            let Doubt { index, .. } = self.bounds.doubtful[position];
            let is_next_in_doubt =
                index < last && self.bounds.at[index + 1].room < self.needed_room(part, index + 1);
            (index == 0 || self.is_stretch_free(index - 1, candidate))
                && (index == last || is_next_in_doubt || self.is_stretch_free(index, candidate))
        })
    }

    /// Whether the way from a pose to the next is free. After a move by s, of l in all, there is at least the
    /// room r1 - s and r2 - (l - s), so with r1 + r2 - l >= 2 c it is at least c everywhere;
    /// otherwise the way is looked at as a straight line, and each half of it.
    fn is_stretch_free(&mut self, number: usize, candidate: Velocity) -> bool {
        let (Stretch { moves_m, deviation_m }, cell_m) =
            (self.stretch(number, candidate), self.frame.resolution_m());
        let room = self.bounds.at[number].room + self.bounds.at[number + 1].room;
        if room - moves_m / cell_m >= 2.0 * self.counting.contact {
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
        let is_free = self.measure(&middle.placement, contact.abs() + 1.0).room >= contact
            && [[from, middle], [middle, to]].into_iter().all(|[from, to]| {
                self.is_straight_way_free(from, to, 0.25 * deviation)
                    || halvings > 1
                        && self.is_free_in_halves(way, [from, to], 0.25 * deviation, halvings - 1)
            });
        self.bounds.spare.push(turned);
        is_free
    }

    /// Whether a way that deviates so little from a straight line is free. The border's distance is concave, so
    /// it is smallest at an end.
    fn is_straight_way_free(&mut self, from: Stop<'_>, to: Stop<'_>, deviation: f64) -> bool {
        let (from, to) = (&from.placement, &to.placement);
        let least = self.counting.contact + deviation;
        let is_inside = !self.counting.is_near_border
            || self.surroundings.to_border(from).min(self.surroundings.to_border(to)) >= least;
        is_inside && self.surroundings.is_kept(from, to, least)
    }
}
