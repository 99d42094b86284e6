//! The common part of all planners with a dynamic window: velocities that can be reached within a
//! cycle are rolled out, those that touch something or could not stop in time are refused, and
//! the rest are ranked by the terms of the planner.
//!
//! # Source
//! \[Fox1997\], in the form of \[You2021\]: equations (4) to (8) and (10), tables 2 and 3.
//!
//! | paper | here | unit | table 3 |
//! |---|---|---|---|
//! | dt | `prediction_step_s` | s | 0.1 |
//! | dv | `v_step_mps` | m/s | 0.01 |
//! | d omega | `omega_step_radps` | rad/s | 1 deg/s |
//! | prediction time | `horizon_s` | s | 3 |
//! | time of the comparison with the guide point | `judged_s` | s | 3, at the end |
//! | time of the comparison with moving obstacles | `movers_s` | s | |
//! | dist(v, omega) | the footprint's distance along the rollout | m | |
//! | Vm, Vd, Va, Vr | limits, window, admissible, all of them together | | |
//!
//! # Where this differs from the paper
//! - `dist` is capped at `distance_cap_m`, the sensing range.
//! - [`WindowConfig::for_robot`] does without (7) ([`Admissible::Rollout`]), and compares with the
//!   guide point earlier.
//! - Contact anywhere on a rollout refuses the candidate, wherever `dist` is measured. `dist` of
//!   (7) and that of the evaluation may be measured at different places.
//! - In (10) a term whose sum over the candidates is 0 contributes 0.
//! - (7) bounds the turn rate's magnitude, in radians, and does not apply on the spot, where
//!   contact is refused anyway and nothing else can come nearer.
//! - The window of \[You2021\] is centred on the present velocity; here its ends are candidates,
//!   too. It ends at the speed from which the robot still stops at its goal.
//! - The footprint may be a polygon; the paper's robot is a point.
//! - A candidate that leads into a moving obstacle, if moving obstacles are tracked, is refused
//!   by a separate rule; `dist` is the clearance to moving obstacles if that is less. (7) is
//!   about stationary obstacles.
//! - If nothing is admissible, the robot brakes so that it stays on its arc. At standstill, a
//!   round robot turns towards the guide point.
//!
//! # Safety
//! With [`Prediction::Arcs`] the braking motion after a command is part of that command's
//! rollout: a cycle in which the velocity changes to the candidate, then the candidate's arc.
//! Braking keeps the arc, and the robot covers as much of it as it would cover at the unchanged
//! velocity in [`Limits::brakes_within_s`](crate::robot::Limits::brakes_within_s), counted in
//! whole cycles; the horizon is at least a cycle longer. So the robot may brake after each
//! command, and if nothing is admissible it does just that. By induction over the cycles, among
//! stationary obstacles in view, a robot that starts free never touches anything.
//!
//! # Errors / cost
//! [`NoCommand`] if nothing is admissible. Cost: one look-up if nothing is within reach of any
//! candidate, and one per turn rate and pose if nothing is near to it. Near obstacles, if the
//! speeds of a turn rate have to be distinguished, at most one exact distance per candidate, pose
//! and near box, and usually a few per candidate. Twice that if (7) and the evaluation measure
//! the distance at different poses.

mod body;
mod config;
mod contacts;
mod counting;
mod evaluation;
mod explain;
mod motion;
mod roller;
mod rollout;
mod rollouts;
mod speeds;
mod stretch;
mod window;

pub use config::WindowConfig;
pub use evaluation::{Term, TermValue, Weighing};
pub use rollout::{Admissible, DistanceAt, Prediction, Rollout};

use evaluation::Candidate;

use super::{Decision, Evaluation, MoverRule, NoCommand, Rejections, Scene, Scratch};
use crate::ConfigError;
use crate::geometry::{Point, Velocity};
use crate::given::Given;
use crate::robot::{Footprint, Robot};
use body::Standing;
use evaluation::Ranking;
use motion::Timing;
use roller::{RollMemory, Roller};
use rollouts::{Distances, Rollouts};
use std::sync::Arc;
use window::{Lattice, Window};

/// The dynamic window of a robot: everything that the planners with a window share, except for
/// the terms of their evaluation. The example `own_evaluation_term` is a planner with a term of
/// its own.
#[derive(Clone, Debug)]
pub struct DynamicWindow {
    config: WindowConfig,
    robot: Arc<Robot>,
}

/// The footprint would touch something or leave the map.
const CONTACT: &str = "contact";

/// v > sqrt(2 dist deceleration), eq. (7): it could not stop in time.
const CANNOT_STOP: &str = "cannot-stop";

/// |omega| > sqrt(2 dist angular deceleration), eq. (7): it could not stop turning in time.
const TURNS_TOO_FAST: &str = "turns-too-fast";

/// It leads into a moving obstacle ([`MoverRule`]).
const MOVER: &str = Rejections::MOVER;

/// The wheels of a car-like robot cannot do it: it is tighter than its turning radius, or passes
/// through standstill.
const TURNING_RADIUS: &str = "turning-radius";

/// Rounding of turn rates.
const ROUNDING_RADPS: f64 = 1e-9;

const RULES: [(&str, &str); 5] = [
    (CONTACT, "touch something"),
    (CANNOT_STOP, "could not stop in time"),
    (TURNS_TOO_FAST, "turn too fast"),
    (MOVER, "lead into a moving obstacle"),
    (TURNING_RADIUS, "turn too tightly, or change the direction without a stop"),
];

/// Working memory of a decision.
#[derive(Debug, Default)]
struct Work {
    lattice: Lattice,
    rolling: RollMemory,
    shrunk: Vec<Point>,
}

impl DynamicWindow {
    /// Upper limit of the candidates in one cycle; more are an error in the config.
    const MAX_CANDIDATES: f64 = 100_000.0;

    /// Upper limit of the predicted poses of one candidate; more are an error in the config.
    const MAX_POSES: f64 = 10_000.0;

    /// Upper limit of the horizon: no robot needs more than a minute to stop.
    const LONGEST_HORIZON_S: f64 = 1000.0;

    /// Upper limit of the prediction of moving obstacles, in horizons.
    const MOST_HORIZONS: f64 = 100.0;

    /// Creates the window of a robot.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] if a value of the robot or the config is invalid, or the two do
    /// not fit together (a horizon too short to stop within it, or steps too small for one
    /// cycle); the error names the field.
    pub fn new(config: WindowConfig, robot: impl Into<Arc<Robot>>) -> Result<Self, ConfigError> {
        let robot = robot.into();
        robot.validate().map_err(|error| error.within("robot"))?;
        Self::check(&config, &robot).map_err(|error| error.within("window"))?;
        Ok(Self { config, robot })
    }

    fn check(config: &WindowConfig, robot: &Robot) -> Result<(), ConfigError> {
        config.validate()?;
        let (cycle_s, limits) = (robot.cycle_s, &robot.limits);
        let refuse =
            |field, expected: &str, value| Err(ConfigError::must_be(field, expected, value));
        if config.admissible == Admissible::Rollout && config.prediction == Prediction::Euler {
            let reason = "cannot be `rollout` with the prediction `euler`, in which the braking \
                          motion is not part of the trajectory; use stopping-distance";
            return Err(ConfigError::new("admissible", reason));
        }
        let least_s = cycle_s + limits.stop_s().max(limits.brakes_within_s(cycle_s));
        let least_s = least_s * (1.0 - 1e-9);
        if config.prediction == Prediction::Arcs && config.horizon_s < least_s {
            // Rounded up, so that the value in the message is valid.
            let least = Given((least_s * 1e6).ceil() / 1e6);
            let expected = format!("at least {least}, for a cycle and the time to stop");
            return refuse("horizon_s", &expected, config.horizon_s);
        }
        if config.horizon_s > Self::LONGEST_HORIZON_S {
            return refuse("horizon_s", "at most 1000", config.horizon_s);
        }
        let from_s = if config.prediction == Prediction::Arcs { cycle_s } else { 0.0 };
        if !(from_s..=config.horizon_s).contains(&config.judged_s) {
            let expected = "at most horizon_s, and with the prediction `arcs` at least a cycle";
            return refuse("judged_s", expected, config.judged_s);
        }
        if config.movers_s > Self::MOST_HORIZONS * config.horizon_s {
            let expected = "at most a hundred times horizon_s";
            return refuse("movers_s", expected, config.movers_s);
        }
        if config.horizon_s / config.prediction_step_s > Self::MAX_POSES {
            let horizon = Given(config.horizon_s);
            let expected = format!("at least a 10000th of horizon_s, which is {horizon}");
            return refuse("prediction_step_s", &expected, config.prediction_step_s);
        }
        let widest = Window::widest(limits, cycle_s);
        let count =
            (widest.v / config.v_step_mps + 3.0) * (widest.omega / config.omega_step_radps + 3.0);
        if count > Self::MAX_CANDIDATES {
            let expected = "larger: with omega_step_radps it gives over 100000 candidates";
            return refuse("v_step_mps", expected, config.v_step_mps);
        }
        Ok(())
    }

    /// The robot that is driven.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Returns the best of the reachable and admissible velocities, by the values that `terms`
    /// gives each of them and its rollout, in the order of `weighing`. Ties go to the slowest,
    /// and among these to the one farthest to the right.
    ///
    /// # Errors
    /// Returns [`NoCommand`] if no velocity is admissible; the error holds the velocity with
    /// which the robot brakes.
    pub fn decide<const TERMS: usize>(
        &self,
        scene: &Scene<'_>,
        scratch: &mut Scratch,
        weighing: &Weighing<TERMS>,
        terms: impl Fn(Velocity, &Rollout) -> [TermValue; TERMS],
    ) -> Result<Decision, NoCommand> {
        let Work { lattice, rolling, shrunk } = scratch.part();
        self.fill(lattice, scene);
        self.roller(scene, shrunk).roll(lattice, rolling);
        let evaluation = self.refuse(scene, lattice, rolling.rollouts_mut());
        let candidates = rolling
            .rollouts()
            .admissible(lattice)
            .map(|(velocity, rollout)| Candidate { velocity, values: terms(velocity, &rollout) });
        match weighing.rank(candidates) {
            Some(Ranking { command, chosen, runner_up }) => {
                Ok(Decision { command, evaluation: Evaluation { chosen, runner_up, ..evaluation } })
            }
            None => Err(NoCommand { fallback: self.fallback(scene), evaluation }),
        }
    }

    /// Applies the rules to the candidates, and counts. Contact has been refused already.
    fn refuse(&self, scene: &Scene<'_>, lattice: &Lattice, rollouts: &mut Rollouts) -> Evaluation {
        let candidates = lattice.len() as u32;
        let limits = &self.robot.limits;
        // Only a car-like robot knows the last rule.
        let rules = &RULES[..RULES.len() - usize::from(limits.turns_in_place())];
        let mut rejected = Rejections::none_by(rules);
        rejected.add_many(CONTACT, candidates - rollouts.count(lattice, |_| true));
        let is_ruled = self.config.admissible != Admissible::Rollout
            || !scene.movers.is_empty()
            || !limits.turns_in_place();
        if is_ruled {
            let mover_rule = self.mover_rule(scene);
            rollouts.retain(lattice, |velocity, distances_m| {
                let admitted = self.admitted((scene, &mover_rule), velocity, distances_m);
                admitted.map_err(|rule| rejected.add(rule)).ok()
            });
        }
        let driving = rollouts.count(lattice, |v_mps| v_mps != 0.0);
        Evaluation { candidates, driving, rejected, ..Evaluation::default() }
    }

    /// The distance that counts for a candidate that touches nothing \[m\], or the rule that
    /// refuses it.
    #[inline]
    fn admitted(
        &self,
        (scene, mover_rule): (&Scene<'_>, &MoverRule<'_>),
        velocity: Velocity,
        Distances { stopping_m, evaluated_m }: Distances,
    ) -> Result<f64, &'static str> {
        if !self.can_drive(scene.velocity, velocity) {
            return Err(TURNING_RADIUS);
        }
        if let Some(rule) = self.refused_by(velocity, stopping_m) {
            return Err(rule);
        }
        let room_m = mover_rule.room_m(velocity).ok_or(MOVER)?;
        Ok(evaluated_m.min(room_m))
    }

    /// True if the wheels can have a velocity, coming from another.
    fn can_drive(&self, from: Velocity, Velocity { v, omega, .. }: Velocity) -> bool {
        let limits = &self.robot.limits;
        let is_wide = omega.abs() <= limits.turn_rate_at(v) + ROUNDING_RADPS;
        limits.turns_in_place() || is_wide && from.v * v >= 0.0
    }

    /// Fills in all candidates of a cycle.
    fn fill(&self, lattice: &mut Lattice, scene: &Scene<'_>) {
        let WindowConfig { v_step_mps, omega_step_radps, backwards, .. } = self.config;
        let window = Window::of(&self.robot, scene.velocity, scene.remaining_m, backwards);
        lattice.fill(&window, v_step_mps, omega_step_radps);
    }

    fn roller<'a>(&'a self, scene: &'a Scene<'a>, shrunk: &'a mut Vec<Point>) -> Roller<'a> {
        let WindowConfig { horizon_s, distance_cap_m: cap_m, distance_at, .. } = self.config;
        let stopping_at = match self.config.admissible {
            Admissible::StoppingDistance => self.config.stopping_distance_at,
            Admissible::Rollout => distance_at,
        };
        Roller {
            scene,
            body: Standing { robot: &self.robot, scene, reach_m: cap_m }
                .body(self.config.safety_margin_m, shrunk),
            timing: self.timing(scene, horizon_s),
            evaluated_at: distance_at,
            stopping_at,
            distance_cap_m: cap_m,
        }
    }

    /// The rule that keeps the robot clear of moving obstacles.
    fn mover_rule<'a>(&'a self, scene: &'a Scene<'a>) -> MoverRule<'a> {
        let WindowConfig { horizon_s, movers_s, safety_margin_m, .. } = self.config;
        let movers_s = movers_s.max(horizon_s);
        let start = (scene.pose, scene.velocity);
        MoverRule::new(&self.robot, scene.movers, start, [movers_s, safety_margin_m])
    }

    fn timing(&self, scene: &Scene<'_>, horizon_s: f64) -> Timing {
        let WindowConfig { judged_s, prediction_step_s, prediction, .. } = self.config;
        let start = (scene.pose, scene.velocity);
        let times_s = [horizon_s, judged_s.min(horizon_s), prediction_step_s];
        Timing::new(prediction, start, self.robot.cycle_s, times_s)
    }

    /// The rule of Va, eq. (7), that refuses a candidate, if it is used. Within the safety margin
    /// the robot may creep, and on the spot it may turn at any rate: contact is refused anyway.
    fn refused_by(&self, velocity: Velocity, dist_m: f64) -> Option<&'static str> {
        if self.config.admissible == Admissible::Rollout {
            return None;
        }
        let limits = &self.robot.limits;
        let dist_m = dist_m.max(self.config.safety_margin_m);
        if velocity.v.abs() > (2.0 * dist_m * limits.deceleration_mps2).sqrt() {
            return Some(CANNOT_STOP);
        }
        let is_turning_on_the_spot = velocity.v == 0.0;
        let fastest_radps = (2.0 * dist_m * limits.angular_deceleration_radps2).sqrt();
        (!is_turning_on_the_spot && velocity.omega.abs() > fastest_radps).then_some(TURNS_TOO_FAST)
    }

    /// Brakes along the present arc. At standstill, a round robot, which always may, turns
    /// towards the guide point.
    fn fallback(&self, scene: &Scene<'_>) -> Velocity {
        let is_driving =
            scene.velocity.v.abs() > self.robot.limits.standing_mps(self.robot.cycle_s);
        let is_round = matches!(self.robot.footprint, Footprint::Circle(_));
        if is_driving || !is_round {
            return self.robot.limits.braked(scene.velocity, self.robot.cycle_s);
        }
        let wanted = scene.pose.bearing_to(scene.guide) / self.robot.cycle_s;
        let limits = &self.robot.limits;
        limits.reached(scene.velocity, Velocity::new(0.0, wanted), self.robot.cycle_s)
    }
}

#[cfg(test)]
mod rollout_tests;
#[cfg(test)]
mod tests;
