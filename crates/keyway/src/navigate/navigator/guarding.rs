//! The last look at a command before it is issued.

use super::{Deciding, Record};
use crate::geometry::Velocity;
use crate::local::{MoverRule, Refusal, RefusalCounts, StopRule, Surroundings};
use crate::navigate::recovery::Moment;
use crate::navigate::world::World;
use crate::navigate::{Blocked, Step};
use crate::robot::Robot;
use crate::sense::Tracker;
use serde::{Deserialize, Serialize};

/// The stop rule, and what it did.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    rule: Option<StopRule>,
    counts: RefusalCounts,
    /// Of the last cycle.
    refusal: Option<Refusal>,
    /// Time for which it has kept the robot standing \[s\].
    held_s: f64,
}

/// A guard without its rule, as it is stored.
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

    /// Nothing has been asked in this cycle yet.
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
    /// The same step with the command that the stop rule lets pass.
    pub(super) fn guarded(&mut self, step: Step) -> Step {
        let moment = self.moment();
        self.record.guarded(self.world, &moment, step)
    }

    /// [`beside_movers`] for this decision.
    pub(super) fn beside_movers(&self, command: Velocity) -> Velocity {
        beside_movers(self.world, &self.moment(), command)
    }

    /// True if something that moves is what kept the robot from driving on.
    pub(super) fn waits_for_mover(&self) -> bool {
        self.record.evaluation.waits_for_mover()
    }
}

impl Record {
    /// The same step with the command that the stop rule lets pass.
    pub(super) fn guarded(&mut self, world: &World, moment: &Moment<'_>, step: Step) -> Step {
        let &Moment { robot, pose, velocity, robot_then, elapsed_s, .. } = moment;
        let Some(rule) = &self.guard.rule else { return step };
        let (Step::Drive(asked) | Step::Blocked { command: asked, .. }) = step else {
            return step;
        };
        let movers = world.tracker.as_ref().map_or(&[][..], Tracker::possible_movers);
        let (obstacles, seen) = (&world.obstacles, world.seen_cells());
        let delay_s = world.motors.delay_s() + world.scan_age_s();
        let smoothed = world.smoothed(robot_then);
        let around = Surroundings { obstacles, seen, movers, delay_s, pose, velocity, smoothed };
        let gated = rule.gate(&around, asked, &mut self.scratch);
        let keeps_standing = gated.changed() && moment.stands() && robot.stands(gated.command);
        self.guard.note(gated.why, keeps_standing, elapsed_s);
        match (gated.why, step) {
            (None, step) => step,
            // What was in the way before still is.
            (Some(_), Step::Blocked { why, .. }) => Step::Blocked { command: gated.command, why },
            (Some(why), _) => Step::Blocked { command: gated.command, why: Blocked::Unsafe(why) },
        }
    }
}

/// A command of the navigator's own, or braking where it leads into something that moves: its
/// motions are certified among what stands only.
pub(super) fn beside_movers(world: &World, moment: &Moment<'_>, command: Velocity) -> Velocity {
    let &Moment { robot, pose, velocity, .. } = moment;
    let Robot { limits, cycle_s, .. } = robot;
    let horizon_s = 2.0 * cycle_s + limits.stop_s();
    let looks_m = [horizon_s, robot.safety_margin_m()];
    let rule = MoverRule::new(robot, &world.movers_then, (pose, velocity), looks_m);
    if rule.refuses(command) { limits.braked(velocity, *cycle_s) } else { command }
}
