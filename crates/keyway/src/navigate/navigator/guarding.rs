//! The final safety check of a command.

use super::{Deciding, Record};
use crate::geometry::{Pose, Velocity};
use crate::local::{MoverRule, Refusal, RefusalCounts, StopRule, Surroundings};
use crate::navigate::recovery::Moment;
use crate::navigate::world::World;
use crate::navigate::{Blocked, Step};
use crate::robot::Robot;
use crate::sense::{MovingPoint, Tracker};
use serde::{Deserialize, Serialize};

/// The stop rule and its statistics.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    rule: Option<StopRule>,
    counts: RefusalCounts,
    /// Result of the last cycle.
    refusal: Option<Refusal>,
    /// Time for which the rule has kept the robot stationary \[s\].
    held_s: f64,
}

/// A guard without its rule, in serialised form.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct StoredGuard {
    counts: RefusalCounts,
    refusal: Option<Refusal>,
    held_s: f64,
}

impl Guard {
    pub(super) const fn stored(&self) -> StoredGuard {
        let Self { counts, refusal, held_s, .. } = *self;
        StoredGuard { counts, refusal, held_s }
    }

    pub(super) const fn restored(rule: Option<StopRule>, stored: StoredGuard) -> Self {
        let StoredGuard { counts, refusal, held_s } = stored;
        Self { rule, counts, refusal, held_s }
    }

    pub(super) fn new(rule: Option<StopRule>) -> Self {
        Self { rule, counts: RefusalCounts::default(), refusal: None, held_s: 0.0 }
    }

    /// The reason why the last command was changed.
    pub(super) const fn refusal(&self) -> Option<&Refusal> {
        self.refusal.as_ref()
    }

    /// Counts of changed commands; none without a stop rule.
    pub(super) fn counts(&self) -> Option<RefusalCounts> {
        self.rule.as_ref().map(|_| self.counts)
    }

    pub(super) const fn held_s(&self) -> f64 {
        self.held_s
    }

    /// Resets the result of the cycle.
    pub(super) const fn pause(&mut self) {
        self.refusal = None;
    }

    fn note(&mut self, refusal: Option<Refusal>, keeps_standing: bool, elapsed_s: f64) {
        self.refusal = refusal;
        if let Some(refusal) = &refusal {
            self.counts.add(refusal);
        }
        self.held_s = if keeps_standing { self.held_s + elapsed_s } else { 0.0 };
    }
}

impl Deciding<'_> {
    /// The same step with the command that passes the stop rule.
    pub(super) fn guarded(&mut self, step: Step) -> Step {
        let moment = self.moment();
        self.record.guarded(self.world, &moment, step)
    }

    /// [`beside_movers`] for this decision.
    pub(super) fn beside_movers(&self, command: Velocity) -> Velocity {
        beside_movers(self.world, &self.moment(), command)
    }

    /// True if a moving obstacle kept the robot from driving on.
    pub(super) fn waits_for_mover(&self) -> bool {
        self.record.evaluation.waits_for_mover()
    }
}

impl Record {
    /// The same step with the command that passes the stop rule.
    pub(super) fn guarded(&mut self, world: &World, moment: &Moment<'_>, step: Step) -> Step {
        let step = beside_surfaces(world, moment, step);
        let &Moment { robot, pose, velocity, robot_then, elapsed_s, .. } = moment;
        let Some(rule) = &self.guard.rule else { return step };
        let (Step::Drive(asked) | Step::Blocked { command: asked, .. }) = step else {
            return step;
        };
        let movers = world.tracker.as_ref().map_or(&[][..], Tracker::possible_movers);
        let (obstacles, seen) = (&world.obstacles, world.seen_cells());
        let delay_s = world.motors.delay_s() + world.scan_age_s();
        let jerk_limited = world.jerk_limited(robot_then);
        let around =
            Surroundings { obstacles, seen, movers, delay_s, pose, velocity, jerk_limited };
        let gated = rule.gate(&around, asked, &mut self.scratch);
        let keeps_standing = gated.changed() && moment.stands() && robot.stands(gated.command);
        self.guard.note(gated.why, keeps_standing, elapsed_s);
        match (gated.why, step) {
            (None, step) => step,
            // The earlier reason still holds.
            (Some(_), Step::Blocked { why, .. }) => Step::Blocked { command: gated.command, why },
            (Some(why), _) => Step::Blocked { command: gated.command, why: Blocked::Unsafe(why) },
        }
    }
}

/// A command of the navigator itself, or braking if it leads into a moving obstacle: these
/// motions are certified among stationary obstacles only.
pub(super) fn beside_movers(world: &World, moment: &Moment<'_>, command: Velocity) -> Velocity {
    let &Moment { robot, pose, velocity, .. } = moment;
    let Robot { limits, cycle_s, .. } = robot;
    let horizon_s = 2.0 * cycle_s + limits.stop_s();
    let looks_m = [horizon_s, robot.safety_margin_or_default_m()];
    let rule = MoverRule::new(robot, &world.movers_then, (pose, velocity), looks_m);
    if rule.refuses(command) { limits.braked(velocity, *cycle_s) } else { command }
}

/// Distance to the sensed surface of obstacles that hardly move \[m\]. The margin of a robot,
/// which may be a millimetre, is for obstacles that do not approach it.
const BESIDE_MOVERS_M: f64 = 0.05;

/// The same step, or braking if the robot could no longer stop before it comes closer than
/// [`BESIDE_MOVERS_M`] to the sensed surface of a moving obstacle that may as well be stationary,
/// and closer than it would be at its present position. The disc that represents a moving
/// obstacle may leave out a corner of it.
///
/// Beside walking pedestrians the robot does not brake for that: they would run into it.
/// [`MoverRule`] evaluates a velocity that is kept; this check evaluates the position at which
/// the robot comes to rest.
fn beside_surfaces(world: &World, moment: &Moment<'_>, step: Step) -> Step {
    let (Step::Drive(command) | Step::Blocked { command, .. }) = step else { return step };
    let &Moment { robot, pose, velocity, .. } = moment;
    if !comes_too_near(robot, &world.surfaces_then, (pose, velocity), command) {
        return step;
    }
    step.commanding(robot.limits.braked(velocity, robot.cycle_s))
}

/// True if a robot that executes a command and then brakes comes too close to a moving point, and
/// closer than it would be if it stayed.
fn comes_too_near(
    robot: &Robot,
    points: &[MovingPoint],
    (pose, velocity): (Pose, Velocity),
    command: Velocity,
) -> bool {
    /// Samples per cycle.
    const PARTS: u32 = 4;
    if points.is_empty() || command == Velocity::ZERO {
        return false;
    }
    let (margin_m, cycle_s) =
        (robot.safety_margin_or_default_m().max(BESIDE_MOVERS_M), robot.cycle_s);
    let (core, radius_m) = robot.footprint.core();
    let reach_m = robot.footprint.circumscribed_radius_m() + margin_m;
    let comes_near = |at: Pose, after_s: f64| {
        points.iter().any(|point| {
            let place = point.place + point.velocity_mps * after_s;
            if (at.point() - place).norm_sq() > reach_m * reach_m {
                return false;
            }
            let room_m = |at: Pose| core.distance_to_m(at, place) - radius_m;
            let moved_m = room_m(at);
            moved_m < margin_m && moved_m < room_m(pose) - MoverRule::ROUNDING_M
        })
    };
    let mut motions = robot.motion_to_stop(pose, velocity, command).zip(0u32..);
    motions.any(|(motion, cycle)| {
        (1..=PARTS).any(|part| {
            let share = f64::from(part) / f64::from(PARTS);
            let to = motion.from.lerp(motion.to, share);
            let at = motion.start.after_ramp(motion.from, to, share * cycle_s);
            comes_near(at, (f64::from(cycle) + share) * cycle_s)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::robot::Footprint;

    /// A square of 0.4 m at the origin, and a point to the left of its left front corner.
    #[test]
    fn a_corner_does_not_turn_into_what_is_seen_of_a_mover() {
        let footprint = Footprint::rectangle(0.4, 0.4).unwrap();
        let robot = Robot { footprint, safety_margin_m: Some(0.02), ..Robot::small() };
        let rest = (Pose::default(), Velocity::ZERO);
        let point = |x: f64, y: f64| {
            [MovingPoint { place: Point::new(x, y), velocity_mps: Point::default() }]
        };
        let turn = |radps: f64| Velocity::new(0.0, radps);
        let (left, right) = (turn(0.25), turn(-0.25));
        // It rotates by 0.0125 rad in the first cycle, and by as much again until it stops.
        let beside = point(0.19, 0.253);
        assert!(comes_too_near(&robot, &beside, rest, left));
        assert!(!comes_too_near(&robot, &beside, rest, right), "away");
        assert!(!comes_too_near(&robot, &point(0.19, 0.26), rest, left), "with room");
        assert!(!comes_too_near(&robot, &beside, rest, Velocity::ZERO));
        assert!(!comes_too_near(&robot, &[], rest, left));
        let goes_on = [MovingPoint { velocity_mps: Point::new(0.0, 1.0), ..beside[0] }];
        assert!(!comes_too_near(&robot, &goes_on, rest, left), "gone by then");
    }
}
