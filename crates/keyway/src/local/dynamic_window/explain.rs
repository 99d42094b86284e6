//! Explains the decision of a dynamic window: every candidate with its fate, and the changes that
//! would free a robot that cannot drive.
//!
//! A decision uses nothing from here; it only counts. Each candidate is judged as in a decision,
//! by the same rollouts and rules; a property test compares the two.
//!
//! The remedies are found as for every planner (`remedies.rs`).
//!
//! # Errors / cost
//! None. The cost is that of a decision, and about twelve rollouts in addition for a candidate
//! that touches something; if none drives, up to 40 times as many candidates.

use super::roller::{RollMemory, Roller};
use super::rollout::{Prediction, Rollout};
use super::window::Lattice;
use super::{CONTACT, Candidate, DynamicWindow, RULES, TermValue, Weighing, WindowConfig};
use crate::geometry::{Point, Pose, Velocity};
use crate::local::remedies::{self, Remediable};
use crate::local::{Explanation, Fate, JudgedCandidate, Scene};
use crate::robot::Robot;
use std::borrow::Cow;

/// Number of poses of a candidate.
const POSES: u32 = 10;

/// Resolution of the time of a contact \[s\].
const CONTACT_S: f64 = 1e-3;

impl DynamicWindow {
    /// Explains the result of [`Self::decide`] for the same scene, candidate by candidate. Costs
    /// many times as much as the decision.
    pub fn explain<const TERMS: usize>(
        &self,
        scene: &Scene<'_>,
        weighing: &Weighing<TERMS>,
        terms: impl Fn(Velocity, &Rollout) -> [TermValue; TERMS],
    ) -> Explanation {
        let mut shrunk = Vec::new();
        let mut judge = Judge::new(self, scene, &mut shrunk);
        let lattice = self.lattice(scene);
        let mut explanation = Explanation { target: Some(scene.guide), ..Explanation::default() };
        let (mut admissible, mut places) = (Vec::new(), Vec::new());
        for (velocity, judged) in lattice.candidates().zip(judge.judge(&lattice)) {
            let fate = match judged {
                Ok(rollout) => {
                    admissible.push(Candidate { velocity, values: terms(velocity, &rollout) });
                    places.push(explanation.candidates.len());
                    // The score is filled in once all of them are known.
                    Fate::Admissible { shares: [].into_iter().collect(), score: 0.0 }
                }
                Err(rule) => judge.refused(velocity, rule),
            };
            let poses = judge.poses(velocity, &fate);
            explanation.candidates.push(JudgedCandidate { velocity, fate, poses });
        }
        for (&place, shares) in places.iter().zip(weighing.all_shares(&admissible)) {
            let score = shares.total();
            explanation.candidates[place].fate = Fate::Admissible { shares, score };
        }
        explanation.rank();
        if admissible.iter().all(|candidate| candidate.velocity.v == 0.0) {
            explanation.remedies = remedies::of(self, scene);
        }
        explanation
    }

    fn lattice(&self, scene: &Scene<'_>) -> Lattice {
        let mut lattice = Lattice::default();
        self.fill(&mut lattice, scene);
        lattice
    }
}

impl Remediable for DynamicWindow {
    fn robot(&self) -> &Robot {
        &self.robot
    }

    fn drives(&self, scene: &Scene<'_>) -> bool {
        let mut shrunk = Vec::new();
        let lattice = self.lattice(scene);
        let judged = Judge::new(self, scene, &mut shrunk).judge(&lattice);
        let mut judged = lattice.candidates().zip(judged);
        judged.any(|(velocity, judged)| velocity.v != 0.0 && judged.is_ok())
    }

    fn for_other(&self, robot: Robot) -> Option<Self> {
        Self::new(self.config.clone(), robot).ok()
    }

    fn backs_up(&self) -> bool {
        self.config.backwards
    }

    fn backing_up(&self, robot: Robot) -> Option<Self> {
        let config = WindowConfig { backwards: true, ..self.config.clone() };
        Self::new(config, robot).ok()
    }

    fn margin_m(&self) -> f64 {
        self.config.safety_margin_m
    }

    fn with_margin(&self, safety_margin_m: f64) -> Option<Self> {
        let config = WindowConfig { safety_margin_m, ..self.config.clone() };
        Self::new(config, self.robot.clone()).ok()
    }
}

/// Judges candidates as a decision does.
struct Judge<'a> {
    window: &'a DynamicWindow,
    roller: Roller<'a>,
    memory: RollMemory,
    only: Lattice,
}

impl<'a> Judge<'a> {
    fn new(window: &'a DynamicWindow, scene: &'a Scene<'a>, shrunk: &'a mut Vec<Point>) -> Self {
        let roller = window.roller(scene, shrunk);
        Self { window, roller, memory: RollMemory::default(), only: Lattice::default() }
    }

    /// The rollout of each candidate, or the rule that refuses it.
    fn judge(&mut self, lattice: &Lattice) -> Vec<Result<Rollout, &'static str>> {
        self.roller.roll(lattice, &mut self.memory);
        let scene = self.roller.scene;
        let mover_rule = self.window.mover_rule(scene);
        let rollouts = self.memory.rollouts();
        let judged = |(index, (velocity, rollout)): (usize, (Velocity, Option<Rollout>))| {
            let rollout = rollout.ok_or(CONTACT)?;
            let distances_m = rollouts.distances(index, rollout.distance_m);
            let distance_m = self.window.admitted((scene, &mover_rule), velocity, distances_m)?;
            Ok(Rollout { distance_m, ..rollout })
        };
        rollouts.all(lattice).enumerate().map(judged).collect()
    }

    fn refused(&mut self, velocity: Velocity, rule: &'static str) -> Fate {
        let because = RULES.iter().find(|(name, _)| *name == rule).map_or("", |(_, why)| *why);
        let free_for_s = (rule == CONTACT).then(|| self.free_for_s(velocity));
        Fate::Refused { rule: Cow::Borrowed(rule), because: Cow::Borrowed(because), free_for_s }
    }

    /// Time for which the rollout of a candidate that touches something is free.
    fn free_for_s(&mut self, velocity: Velocity) -> f64 {
        let WindowConfig { horizon_s, prediction, .. } = self.window.config;
        self.only.fill_with(velocity);
        let parts = match prediction {
            Prediction::Arcs => (horizon_s / CONTACT_S).ceil() as u32,
            // A fraction of a step would be a different step.
            Prediction::Euler => self.steps(),
        };
        let part_s = horizon_s / f64::from(parts);
        let (mut free, mut touching) = (0, parts);
        while touching - free > 1 {
            let middle = u32::midpoint(free, touching);
            let timing = self.window.timing(self.roller.scene, f64::from(middle) * part_s);
            Roller { timing, ..self.roller }.roll(&self.only, &mut self.memory);
            let is_free = self.memory.rollouts().admissible(&self.only).next().is_some();
            *(if is_free { &mut free } else { &mut touching }) = middle;
        }
        f64::from(free) * part_s
    }

    /// Number of steps of equal length between predicted poses, as in a rollout by
    /// [`Prediction::Euler`].
    fn steps(&self) -> u32 {
        (self.roller.timing.steps as u32).max(1)
    }

    /// Poses along the rollout, up to the contact.
    fn poses(&self, velocity: Velocity, fate: &Fate) -> Vec<Pose> {
        let until_s = match *fate {
            Fate::Refused { free_for_s: Some(free_for_s), .. } => free_for_s,
            _ => self.window.config.horizon_s,
        };
        let time_s = |i: u32| until_s * f64::from(i) / f64::from(POSES);
        (1..=POSES).map(|i| self.pose_after(velocity, time_s(i))).collect()
    }

    /// The pose after a time, predicted as in a rollout; Euler's at the nearest step.
    fn pose_after(&self, velocity: Velocity, time_s: f64) -> Pose {
        let WindowConfig { horizon_s, prediction, .. } = self.window.config;
        let step_s = horizon_s / f64::from(self.steps());
        let time_s = match prediction {
            Prediction::Arcs => time_s,
            Prediction::Euler => (time_s / step_s).round() * step_s,
        };
        self.window.timing(self.roller.scene, time_s).end(velocity)
    }
}

#[cfg(test)]
#[path = "explain_tests.rs"]
mod tests;
