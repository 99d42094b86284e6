//! A robot and a moving obstacle, which may jump.

use super::{Moving, Sweep, TOLERANCE_M};
use crate::sim::MovingObstacle;
use crate::sim::cycle_motion::CycleMotion;
use crate::sim::world::to_circle;
use keyway::geometry::Disc;

/// A robot and a moving obstacle. The motion is split at each jump of the obstacle: before that
/// instant the old position counts, from then on the new one.
pub(in crate::sim) struct MoverSweep<'a> {
    pub(in crate::sim) mover: &'a MovingObstacle,
    pub(in crate::sim) robot: Moving<'a>,
    /// Time at the motion's beginning \[s\].
    pub(in crate::sim) start_s: f64,
}

impl<'a> MoverSweep<'a> {
    /// Returns the first place before `until` at which the two touch, to [`TOLERANCE_M`].
    pub(in crate::sim) fn first_contact(&self, until: f64) -> Option<f64> {
        self.stretches(until).find_map(|stretch| {
            // The obstacle may have jumped there.
            if stretch.clearance_m(stretch.from, TOLERANCE_M) <= 0.0 {
                return Some(stretch.from);
            }
            stretch.first_contact_between(stretch.from, stretch.to)
        })
    }

    /// Returns the smaller of `known_m` and the smallest clearance up to a place on the motion,
    /// accurate to [`TOLERANCE_M`].
    pub(in crate::sim) fn least_clearance(&self, until: f64, known_m: f64) -> f64 {
        self.stretches(until).fold(known_m, |known_m, stretch| {
            stretch.least_clearance_between(stretch.from, stretch.to, known_m)
        })
    }

    /// True if the obstacle jumped within one cycle time before a place.
    pub(in crate::sim) fn jumped_before(&self, place: f64) -> bool {
        let since_s = |stretch: Stretch<'_>| {
            let jump_s = self.mover.motion().last_jump_s(stretch.from_s)?;
            Some(stretch.time_s(place) - jump_s)
        };
        let since_s = self.stretch_of(place).and_then(since_s);
        since_s.is_some_and(|since_s| since_s <= self.robot.motion.duration_s())
    }

    /// Speed of the obstacle at a place \[m/s\].
    pub(in crate::sim) fn mover_speed_mps(&self, place: f64) -> f64 {
        self.stretch_of(place).map_or(0.0, |stretch| self.mover.speed_mps(stretch.time_s(place)))
    }

    /// Returns the last section that has begun at a place.
    fn stretch_of(&self, place: f64) -> Option<Stretch<'a>> {
        // All sections are searched, because another one may begin at the place itself.
        self.stretches(CycleMotion::END).take_while(|stretch| stretch.from <= place).last()
    }

    /// Sections of the motion up to a place, separated by jumps.
    fn stretches(&self, until: f64) -> impl Iterator<Item = Stretch<'a>> {
        let Self { mover, robot, start_s } = *self;
        let from_to = move |from: f64, from_s: f64| {
            let to_s = mover.motion().next_jump_s(from_s).unwrap_or(f64::INFINITY);
            let to = robot.motion.place(to_s - start_s).clamp(from, until);
            Stretch { mover, robot, start_s, from, to, from_s, to_s }
        };
        let first = (until >= 0.0).then(|| from_to(0.0, start_s));
        std::iter::successors(first, move |last| {
            (last.to < until).then(|| from_to(last.to, last.to_s))
        })
    }
}

/// A section of the motion without a jump. Times stay from `from_s` to `to_s`. At `to_s` the
/// obstacle is at its position just before the jump, regardless of rounding.
struct Stretch<'a> {
    mover: &'a MovingObstacle,
    robot: Moving<'a>,
    start_s: f64,
    from: f64,
    to: f64,
    from_s: f64,
    to_s: f64,
}

impl Stretch<'_> {
    fn time_s(&self, place: f64) -> f64 {
        (self.start_s + self.robot.motion.elapsed_s(place)).max(self.from_s).min(self.to_s)
    }
}

impl Sweep for Stretch<'_> {
    fn clearance_m(&self, place: f64, reach_m: f64) -> f64 {
        let Moving { footprint, motion } = self.robot;
        let t_s = self.time_s(place);
        let moves = self.mover.motion();
        let centre = if t_s < self.to_s { moves.position(t_s) } else { moves.position_before(t_s) };
        let circle = Disc::new(centre, self.mover.radius_m());
        to_circle(footprint, motion.pose(place), &circle, reach_m)
    }

    fn moved_m(&self, from: f64, to: f64) -> f64 {
        let speed_mps = self.mover.motion().speed_bound_mps(self.time_s(from), self.time_s(to));
        let elapsed_s = self.robot.motion.elapsed_s(to) - self.robot.motion.elapsed_s(from);
        self.robot.moved_m(from, to) + speed_mps * elapsed_s
    }
}
