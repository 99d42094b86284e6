//! Why a dynamic window decides as it does: every candidate with its fate, and what would free a robot that cannot
//! drive.
//!
//! Nothing here is used by a decision, which only counts. Each candidate is judged as there, by the same rollouts and
//! rules; a property test compares the two.
//!
//! # What would free it
//! Where no candidate drives, the [`Change`]s are tried in turn, each alone: it is made, and all candidates are judged
//! again. So each answer is the planner's own. Of turns, the smallest multiple of 15 degrees that helps is given, of the
//! two sides first that of the guide point; of margins and footprints the least change, found by bisection.
//!
//! # Errors / cost
//! None. Those of a decision, and about twelve rollouts in addition for a candidate that touches something; where none
//! drives, up to 40 times as many candidates.

use super::roller::{RollMemory, Roller};
use super::rollout::{Prediction, Rollout};
use super::window::Lattice;
use super::{CONTACT, Candidate, DynamicWindow, MOVER, RULES, Value, Weighing, WindowConfig};
use crate::geometry::{Point, Pose, Velocity};
use crate::local::{Change, Explanation, Fate, JudgedCandidate, Remedy, Scene};
use crate::robot::{Limits, Robot};
use std::borrow::Cow;
use std::f64::consts::PI;

/// Poses of a candidate.
const POSES: u32 = 10;

/// The time of a contact is found to this \[s\].
const CONTACT_S: f64 = 1e-3;

/// Turns that are tried are multiples of this \[rad\].
const TURN_STEP_RAD: f64 = PI / 12.0;

/// How exactly the largest margin and the largest footprint that help are found \[m\].
const MARGIN_STEP_M: f64 = 1e-4;
const FOOTPRINT_STEP_M: f64 = 1e-3;

impl DynamicWindow {
    /// What [`Self::decide`] does with the same scene, candidate by candidate.
    pub(in crate::local) fn explain<const TERMS: usize>(
        &self,
        scene: &Scene<'_>,
        weighing: &Weighing<TERMS>,
        terms: impl Fn(Velocity, &Rollout) -> [Value; TERMS],
    ) -> Explanation {
        let mut shrunk = Vec::new();
        let mut judge = Judge::new(self, scene, &mut shrunk);
        let lattice = self.lattice(scene);
        let mut explanation = Explanation::default();
        let (mut admissible, mut places) = (Vec::new(), Vec::new());
        for (velocity, judged) in lattice.candidates().zip(judge.judge(&lattice)) {
            let fate = match judged {
                Ok(rollout) => {
                    admissible.push(Candidate { velocity, values: terms(velocity, &rollout) });
                    places.push(explanation.candidates.len());
                    // The score follows when all of them are known.
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
        (explanation.chosen, explanation.runner_up) = best_two(&explanation.candidates, &places);
        if admissible.iter().all(|candidate| candidate.velocity.v == 0.0) {
            explanation.remedies = self.remedies(scene);
        }
        explanation
    }

    fn lattice(&self, scene: &Scene<'_>) -> Lattice {
        let mut lattice = Lattice::default();
        self.fill(&mut lattice, scene);
        lattice
    }

    /// Whether some candidate drives.
    fn drives(&self, scene: &Scene<'_>) -> bool {
        let mut shrunk = Vec::new();
        let lattice = self.lattice(scene);
        let judged = Judge::new(self, scene, &mut shrunk).judge(&lattice);
        let mut judged = lattice.candidates().zip(judged);
        judged.any(|(velocity, judged)| velocity.v != 0.0 && judged.is_ok())
    }

    /// What would let a robot drive that cannot.
    fn remedies(&self, scene: &Scene<'_>) -> Vec<Remedy> {
        let (standing, duration_s) = self.stopped(scene);
        let wait = Remedy {
            change: Change::Wait { duration_s },
            frees: standing.is_some_and(|standing| self.drives(&standing)),
        };
        let mut remedies = vec![wait, self.turn(standing.as_ref())];
        remedies.extend(self.back_up(standing.as_ref()));
        remedies.extend(self.smaller_margin(scene));
        remedies.extend(self.smaller_footprint(scene));
        remedies
    }

    /// The scene in which the robot stands after braking on its arc, and how long that takes \[s\], at least a cycle;
    /// no scene where it would touch something before.
    fn stopped<'a>(&self, scene: &Scene<'a>) -> (Option<Scene<'a>>, f64) {
        let Robot { limits, cycle_s, footprint, .. } = &self.robot;
        let (mut standing, mut duration_s) = (*scene, 0.0);
        let mut is_free = true;
        loop {
            let (from, to) = (standing.velocity, limits.braked(standing.velocity, *cycle_s));
            standing.pose = standing.pose.after_ramp(from, to, *cycle_s);
            standing.velocity = to;
            duration_s += cycle_s;
            is_free &= from == Velocity::ZERO || footprint.is_free(standing.pose, scene.obstacles);
            if to == Velocity::ZERO {
                return (is_free.then_some(standing), duration_s);
            }
        }
    }

    fn turn(&self, standing: Option<&Scene<'_>>) -> Remedy {
        let not = Remedy { change: Change::Turn { by_rad: PI }, frees: false };
        let Some(scene) = standing else { return not };
        let (point, theta) = (scene.pose.point(), scene.pose.theta);
        let towards_rad = TURN_STEP_RAD.copysign(scene.pose.bearing_to(scene.guide));
        let steps = (PI / TURN_STEP_RAD).round() as u32;
        let turns = (1..=steps).map(f64::from).flat_map(|k| [k * towards_rad, -k * towards_rad]);
        let frees = |by_rad: &f64| {
            let turned = Scene { pose: Pose::new(point.x, point.y, theta + by_rad), ..*scene };
            self.robot.footprint.is_free_turn(point, theta, *by_rad, scene.obstacles)
                && self.drives(&turned)
        };
        let found = turns.into_iter().find(frees);
        found.map_or(not, |by_rad| Remedy { change: Change::Turn { by_rad }, frees: true })
    }

    /// Backing up as fast as can be reached in a cycle; `None` for a robot that may anyway.
    fn back_up(&self, standing: Option<&Scene<'_>>) -> Option<Remedy> {
        let Robot { limits, cycle_s, .. } = &self.robot;
        let can_reverse = limits.v_min_mps < 0.0;
        if can_reverse && self.config.backwards {
            return None;
        }
        let by_a_cycle_mps = -(limits.acceleration_mps2 * cycle_s).min(limits.v_max_mps);
        let v_min_mps = if can_reverse { limits.v_min_mps } else { by_a_cycle_mps };
        let limits = Limits { v_min_mps, ..limits.clone() };
        let robot = Robot { limits, ..self.robot.clone() };
        let config = WindowConfig { backwards: true, ..self.config.clone() };
        let changed = Self::new(config, robot);
        let frees =
            changed.is_ok_and(|changed| standing.is_some_and(|standing| changed.drives(standing)));
        Some(Remedy { change: Change::BackUp { v_min_mps }, frees })
    }

    /// `None` where there is no margin.
    fn smaller_margin(&self, scene: &Scene<'_>) -> Option<Remedy> {
        let kept_m = self.config.safety_margin_m;
        if kept_m == 0.0 {
            return None;
        }
        let frees = |safety_margin_m: f64| {
            let config = WindowConfig { safety_margin_m, ..self.config.clone() };
            Self::new(config, self.robot.clone()).is_ok_and(|changed| changed.drives(scene))
        };
        let without_frees = frees(0.0);
        let (mut safety_margin_m, mut too_large_m) = (0.0, kept_m);
        // Near 0 numbers are dense: this ends however large the margin is.
        while without_frees && too_large_m - safety_margin_m > MARGIN_STEP_M {
            let middle_m = 0.5 * (safety_margin_m + too_large_m);
            *(if frees(middle_m) { &mut safety_margin_m } else { &mut too_large_m }) = middle_m;
        }
        Some(Remedy { change: Change::SafetyMargin { safety_margin_m }, frees: without_frees })
    }

    /// `None` for a point.
    fn smaller_footprint(&self, scene: &Scene<'_>) -> Option<Remedy> {
        let footprint = &self.robot.footprint;
        // Almost a point: a polygon needs some ground.
        let most_m = 0.99 * footprint.inscribed_radius_m();
        if most_m == 0.0 {
            return None;
        }
        let frees = |smaller_by_m| {
            let Some(footprint) = footprint.smaller_by(smaller_by_m) else { return false };
            let robot = Robot { footprint, ..self.robot.clone() };
            Self::new(self.config.clone(), robot).is_ok_and(|changed| changed.drives(scene))
        };
        let found_m = least(most_m, FOOTPRINT_STEP_M, frees);
        let change = Change::Footprint { smaller_by_m: found_m.unwrap_or(most_m) };
        Some(Remedy { change, frees: found_m.is_some() })
    }
}

/// A change up to `most` that helps, such that one that is smaller by `step` does not (where more always helps more).
fn least(most: f64, step: f64, helps: impl Fn(f64) -> bool) -> Option<f64> {
    if !helps(most) {
        return None;
    }
    let (mut low, mut high) = (0.0, most);
    while high - low > step {
        let middle = 0.5 * (low + high);
        *(if helps(middle) { &mut high } else { &mut low }) = middle;
    }
    Some(high)
}

/// The best and the second best of the admissible candidates; of equals the first.
fn best_two(
    candidates: &[JudgedCandidate],
    admissible: &[usize],
) -> (Option<usize>, Option<usize>) {
    let score = |place: usize| candidates[place].score().unwrap_or(f64::NEG_INFINITY);
    let better = |best: usize, place: usize| if score(place) > score(best) { place } else { best };
    let chosen = admissible.iter().copied().reduce(better);
    let others = admissible.iter().copied().filter(|&place| Some(place) != chosen);
    (chosen, others.reduce(better))
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

    /// Where each candidate leads, or the rule that refuses it.
    fn judge(&mut self, lattice: &Lattice) -> Vec<Result<Rollout, &'static str>> {
        self.roller.roll(lattice, &mut self.memory);
        let mover_rule = self.window.mover_rule(self.roller.scene);
        let judged = |(velocity, rollout): (Velocity, &Option<Rollout>)| {
            let rollout = rollout.ok_or(CONTACT)?;
            if let Some(rule) = self.window.refused_by(velocity, rollout.distance_m) {
                return Err(rule);
            }
            rollout.beside_movers(mover_rule.room_m(velocity)).ok_or(MOVER)
        };
        lattice.candidates().zip(self.memory.rollouts()).map(judged).collect()
    }

    fn refused(&mut self, velocity: Velocity, rule: &'static str) -> Fate {
        let because = RULES.iter().find(|(name, _)| *name == rule).map_or("", |(_, why)| *why);
        let free_for_s = (rule == CONTACT).then(|| self.free_for_s(velocity));
        Fate::Refused { rule: Cow::Borrowed(rule), because: Cow::Borrowed(because), free_for_s }
    }

    /// How long the rollout of a candidate that touches something is free.
    fn free_for_s(&mut self, velocity: Velocity) -> f64 {
        let WindowConfig { horizon_s, prediction, .. } = self.window.config;
        self.only.fill_with(velocity);
        let parts = match prediction {
            Prediction::Arcs => (horizon_s / CONTACT_S).ceil() as u32,
            // A part of a step would be another step.
            Prediction::Euler => self.steps(),
        };
        let part_s = horizon_s / f64::from(parts);
        let (mut free, mut touching) = (0, parts);
        while touching - free > 1 {
            let middle = u32::midpoint(free, touching);
            let timing = self.window.timing(self.roller.scene, f64::from(middle) * part_s);
            Roller { timing, ..self.roller }.roll(&self.only, &mut self.memory);
            let is_free = self.memory.rollouts()[0].is_some();
            *(if is_free { &mut free } else { &mut touching }) = middle;
        }
        f64::from(free) * part_s
    }

    /// Steps of equal length between two predicted poses, as in a rollout by [`Prediction::Euler`].
    fn steps(&self) -> u32 {
        (self.roller.timing.steps as u32).max(1)
    }

    /// Poses on the way, up to the contact.
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
