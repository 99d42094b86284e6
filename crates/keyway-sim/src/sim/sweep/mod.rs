//! Contacts and smallest clearances along one cycle of motion: certified, not sampled.

mod mover;

pub(super) use mover::MoverSweep;

use super::World;
use super::cycle_motion::CycleMotion;
use keyway::robot::Footprint;

/// Length below which an interval is not halved any further \[m\]. It then counts as contact
/// unless it is proven free, and the smallest clearance has this accuracy.
pub(super) const TOLERANCE_M: f64 = 1e-4;

/// Two objects that move during a cycle.
///
/// The distance between two objects changes by at most the distance that their parts move
/// together. Take two places with the clearances `c1` and `c2` between which the objects move by
/// `ds` together. A place after a move of `s` has a clearance of at least
/// `max(c1 - s, c2 - (ds - s))`, which is smallest if both are equal: `(c1 + c2 - ds) / 2`. If
/// that bound does not suffice, the interval is halved.
pub(super) trait Sweep {
    /// Returns the distance between the two objects at a place, at most `reach_m` \[m\].
    fn clearance_m(&self, place: f64, reach_m: f64) -> f64;

    /// Returns the distance to contact at a place \[m\]: the clearance, unless there is contact
    /// with an object that does not count for clearances.
    fn gap_m(&self, place: f64, reach_m: f64) -> f64 {
        self.clearance_m(place, reach_m)
    }

    /// Returns an upper bound of the distance that parts of both objects move together between
    /// two places \[m\].
    fn moved_m(&self, from: f64, to: f64) -> f64;

    /// Returns the first place from `from` to `until` at which the two objects touch, to
    /// [`TOLERANCE_M`]. If the bound cannot exclude contact on a shorter interval (with a gap of
    /// at most half of it), it counts as contact. The two are assumed to be apart at `from`.
    fn first_contact_between(&self, from: f64, until: f64) -> Option<f64> {
        let moved_m = self.moved_m(from, until);
        if moved_m == 0.0 {
            return None;
        }
        // Two clearances of the interval's length always suffice, so larger ones need not be
        // known. The tolerance prevents false contact if the length is below the last digit of
        // the radius.
        let reach_m = moved_m + TOLERANCE_M;
        let probe = |place| Probe { place, clearance_m: self.gap_m(place, reach_m) };
        contact_between(self, probe(from), probe(until), &probe)
    }

    /// Returns the first contact from the motion's beginning to a place.
    fn first_contact(&self, until: f64) -> Option<f64> {
        self.first_contact_between(0.0, until)
    }

    /// Returns the smaller of `known_m` and the smallest clearance between two places on the
    /// motion, accurate to [`TOLERANCE_M`].
    fn least_clearance_between(&self, from: f64, until: f64, known_m: f64) -> f64 {
        // Objects farther away cannot matter on this motion.
        let reach_m = known_m + self.moved_m(from, until);
        let probe = |place| Probe { place, clearance_m: self.clearance_m(place, reach_m) };
        let (a, b) = (probe(from), probe(until));
        let mut least = known_m.min(a.clearance_m).min(b.clearance_m);
        least_within(self, a, b, &probe, &mut least);
        least
    }

    /// Returns the smaller of `known_m` and the smallest clearance from the motion's beginning to
    /// a place.
    fn least_clearance(&self, until: f64, known_m: f64) -> f64 {
        self.least_clearance_between(0.0, until, known_m)
    }
}

/// A robot's footprint and its motion.
#[derive(Clone, Copy)]
pub(super) struct Moving<'a> {
    pub(super) footprint: &'a Footprint,
    pub(super) motion: &'a CycleMotion,
}

/// A robot among the static obstacles that are present when a cycle begins; leaving the map is
/// contact.
pub(super) struct StandingSweep<'a> {
    pub(super) world: &'a World,
    /// Time at which the cycle begins \[s\].
    pub(super) start_s: f64,
    pub(super) robot: Moving<'a>,
}

/// Two robots.
pub(super) struct PairSweep<'a> {
    pub(super) robots: [Moving<'a>; 2],
}

impl Moving<'_> {
    /// Upper bound of the distance that any part moves between two places \[m\].
    fn moved_m(&self, from: f64, to: f64) -> f64 {
        let driven_m = self.motion.driven_m(to) - self.motion.driven_m(from);
        let turned_rad = self.motion.turned_rad(to) - self.motion.turned_rad(from);
        let (core, _) = self.footprint.core();
        core.moves_m(driven_m, turned_rad)
    }
}

impl Sweep for StandingSweep<'_> {
    fn clearance_m(&self, place: f64, reach_m: f64) -> f64 {
        let Moving { footprint, motion } = self.robot;
        self.world.distance_to_standing(footprint, motion.pose(place), self.start_s, reach_m)
    }

    fn gap_m(&self, place: f64, reach_m: f64) -> f64 {
        let Moving { footprint, motion } = self.robot;
        let border_m = self.world.border_distance(footprint, motion.pose(place));
        self.clearance_m(place, reach_m).min(border_m)
    }

    fn moved_m(&self, from: f64, to: f64) -> f64 {
        self.robot.moved_m(from, to)
    }
}

impl Sweep for PairSweep<'_> {
    fn clearance_m(&self, place: f64, reach_m: f64) -> f64 {
        let [a, b] = self.robots;
        let (pose_a, pose_b) = (a.motion.pose(place), b.motion.pose(place));
        a.footprint.distance_to_footprint_m(pose_a, b.footprint, pose_b, reach_m)
    }

    fn moved_m(&self, from: f64, to: f64) -> f64 {
        self.robots.iter().map(|robot| robot.moved_m(from, to)).sum()
    }
}

/// A place on the motion and the clearance there \[m\].
#[derive(Clone, Copy)]
struct Probe {
    place: f64,
    clearance_m: f64,
}

fn contact_between<S: Sweep + ?Sized>(
    sweep: &S,
    a: Probe,
    b: Probe,
    probe: &impl Fn(f64) -> Probe,
) -> Option<f64> {
    let moved_m = sweep.moved_m(a.place, b.place);
    if least_between(a, b, moved_m) > 0.0 {
        return None;
    }
    let half_way = 0.5 * (a.place + b.place);
    // At an extreme velocity, places may be too close to halve before the tolerance is met.
    if moved_m < TOLERANCE_M || half_way <= a.place || half_way >= b.place {
        return Some(a.place);
    }
    let middle = probe(half_way);
    let first = contact_between(sweep, a, middle, probe);
    first.or_else(|| contact_between(sweep, middle, b, probe))
}

fn least_within<S: Sweep + ?Sized>(
    sweep: &S,
    a: Probe,
    b: Probe,
    probe: &impl Fn(f64) -> Probe,
    least: &mut f64,
) {
    let half_way = 0.5 * (a.place + b.place);
    let moved_m = sweep.moved_m(a.place, b.place);
    let enough = least_between(a, b, moved_m) >= *least - TOLERANCE_M;
    if enough || half_way <= a.place || half_way >= b.place {
        return;
    }
    let middle = probe(half_way);
    *least = least.min(middle.clearance_m);
    least_within(sweep, a, middle, probe, least);
    least_within(sweep, middle, b, probe, least);
}

/// Lower bound of the clearance on the interval between two places.
fn least_between(a: Probe, b: Probe, moved_m: f64) -> f64 {
    0.5 * (a.clearance_m + b.clearance_m - moved_m)
}

#[cfg(test)]
mod tests;
