//! What becomes of a command before it is issued.

use super::Controller;
use crate::geometry::{Pose, Velocity};
use crate::local::{MoverRule, Refusal, RefusalCounts, StopRule, Surroundings};
use crate::navigate::{Blocked, Step};
use crate::robot::Robot;
use crate::sense::Tracker;

/// The stop rule, and what it did.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    rule: Option<StopRule>,
    counts: RefusalCounts,
    /// Of the last cycle.
    refusal: Option<Refusal>,
    /// How long it has kept the robot standing \[s\].
    held_s: f64,
}

impl Guard {
    pub(super) fn new(rule: Option<StopRule>) -> Self {
        Self { rule, counts: RefusalCounts::default(), refusal: None, held_s: 0.0 }
    }

    /// Why the last command was changed.
    pub(super) const fn refusal(&self) -> Option<&Refusal> {
        self.refusal.as_ref()
    }

    /// How often commands were changed; none without a stop rule.
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

    fn note(&mut self, refusal: Option<Refusal>, keeps_standing: bool, cycle_s: f64) {
        self.refusal = refusal;
        if let Some(refusal) = &refusal {
            self.counts.add(refusal);
        }
        self.held_s = if keeps_standing { self.held_s + cycle_s } else { 0.0 };
    }
}

impl Controller {
    /// The same step with the command that the stop rule lets pass.
    pub(super) fn guarded(&mut self, step: Step, pose: Pose, velocity: Velocity) -> Step {
        let Some(rule) = &self.guard.rule else { return step };
        let (Step::Drive(asked) | Step::Blocked { command: asked, .. }) = step else {
            return step;
        };
        let mut scratch = std::mem::take(&mut self.scratch);
        let movers = self.tracker.as_ref().map_or(&[][..], Tracker::possible_movers);
        let obstacles = &self.obstacles;
        let delay_s = self.robot.actuation_delay_s;
        let seen = self.seen_cells();
        let around = Surroundings { obstacles, seen, movers, delay_s, pose, velocity };
        let gated = rule.gate(&around, asked, &mut scratch);
        self.scratch = scratch;
        let keeps_standing =
            gated.changed() && self.robot.stands(velocity) && self.robot.stands(gated.command);
        self.guard.note(gated.why, keeps_standing, self.robot.cycle_s);
        match (gated.why, step) {
            (None, step) => step,
            // What was in the way before still is.
            (Some(_), Step::Blocked { why, .. }) => Step::Blocked { command: gated.command, why },
            (Some(why), _) => Step::Blocked { command: gated.command, why: Blocked::Unsafe(why) },
        }
    }

    /// A command of the controller's own, or braking where it leads into something that moves: its
    /// motions are certified among what stands only.
    pub(super) fn beside_movers(
        &self,
        pose: Pose,
        velocity: Velocity,
        command: Velocity,
    ) -> Velocity {
        let Robot { limits, cycle_s, .. } = &*self.robot;
        let horizon_s = 2.0 * cycle_s + limits.stop_s();
        let looks_m = [horizon_s, self.robot.safety_margin_m()];
        let rule = MoverRule::new(&self.robot, &self.movers_then, (pose, velocity), looks_m);
        if rule.refuses(command) { limits.braked(velocity, *cycle_s) } else { command }
    }

    /// Whether something that moves is what kept the robot from driving on.
    pub(super) fn waits_for_mover(&self) -> bool {
        self.evaluation.waits_for_mover()
            || matches!(self.guard.refusal(), Some(Refusal::Mover { .. }))
    }
}
