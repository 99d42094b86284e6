//! A controller drives a robot through a world until it arrives, collides or gives up.

use super::motion::{CycleMotion, Sweep};
use super::{Obstacle, World};
use crate::ConfigError;
use crate::geometry::{Point, Pose, Velocity};
use crate::robot::Robot;
use crate::sense::Scan;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What a controller wants in the next cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Drive at this velocity, as far as the robot's limits allow.
    Drive(Velocity),
    /// It considers itself to be at the goal. The robot brakes; whether it has arrived is the
    /// simulator's judgement ([`RunRules::goal_tolerance_m`]).
    Arrived,
    /// Brake: there is no way on for now.
    Stop,
}

/// A controller's answer to one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// What to do.
    pub action: Action,
    /// Length of the remaining path \[m\], by which progress is judged. NaN or infinity: unknown,
    /// and no progress.
    pub remaining_m: f64,
    /// Number of the route that is followed: a new one may be longer than the last.
    pub route: u32,
}

/// When a run ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RunRules {
    /// The goal is reached when the robot's centre is this near to it \[m\].
    pub goal_tolerance_m: f64,
    /// Simulated time after which a run is given up \[s\].
    pub time_limit_s: f64,
    /// The robot is stuck when the remaining path has not become [`Self::stuck_progress_m`] shorter
    /// for this long \[s\]; after a longer new route, shorter than that one.
    pub stuck_window_s: f64,
    /// What counts as progress of the remaining path \[m\].
    pub stuck_progress_m: f64,
}

impl Default for RunRules {
    fn default() -> Self {
        Self {
            goal_tolerance_m: 0.15,
            time_limit_s: 300.0,
            stuck_window_s: 20.0,
            stuck_progress_m: 0.1,
        }
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Outcome {
    /// The centre came within the goal tolerance.
    Reached,
    /// The footprint touched something.
    Collided {
        /// Pose of the robot at the contact.
        pose: Pose,
        /// What it touched.
        with: Obstacle,
    },
    /// The time limit passed.
    Timeout,
    /// No progress for the stuck window.
    Stuck,
}

/// State of the robot at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Time since the start \[s\].
    pub t_s: f64,
    /// Pose in the world frame.
    pub pose: Pose,
    /// Velocity driven at this instant.
    pub velocity: Velocity,
}

/// What happened in a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// How it ended.
    pub outcome: Outcome,
    /// The start, the end of every cycle, and the contact if there was one.
    pub samples: Vec<Sample>,
    /// Arc length driven \[m\].
    pub length_m: f64,
    /// The footprint's smallest clearance from an obstacle over the whole motion, to 0.1 mm \[m\]; 0
    /// after a contact with one, `None` in a world without obstacles.
    pub min_clearance_m: Option<f64>,
    /// Cycles begun.
    pub cycles: u64,
}

/// Why a run could not be simulated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SimError {
    /// A value of the robot, the rules, the start or the goal cannot be used; the path begins with which.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The controller asked for a velocity that is not a number.
    #[error("the command of cycle {cycle} is not a number: v = {} m/s, omega = {} rad/s",
        command.v, command.omega)]
    Command {
        /// The cycle, from 0.
        cycle: u64,
        /// The command.
        command: Velocity,
    },
}

/// Drives `robot` from rest at `start` towards `goal` (world frame) until an outcome.
///
/// At the start and at the end of every cycle: the goal is tested, then the time limit; then the
/// controller is given the pose, the velocity and a scan, and answers; then progress is tested.
/// During the cycle the velocity changes linearly towards the command as far as the robot's
/// limits allow, and contact is tested along the whole swept motion.
///
/// Deterministic: equal arguments give equal bytes.
///
/// # Errors
/// When an argument cannot be used, or the controller commands NaN.
pub fn simulate(
    world: &World,
    robot: &Robot,
    start: Pose,
    goal: Point,
    rules: &RunRules,
    mut controller: impl FnMut(Pose, Velocity, &Scan) -> Control,
) -> Result<Run, SimError> {
    robot.validate().map_err(|error| error.within("robot"))?;
    rules.validate().map_err(|error| error.within("rules"))?;
    check_places(start, goal)?;
    let mut drive = Drive::new(world, robot, start);
    let mut progress = Progress::new(rules, robot.cycle_s);
    let last_cycle = cycles_within(rules.time_limit_s, robot.cycle_s);
    let mut contact = drive.contact_at_start();
    let outcome = loop {
        if let Some(collision) = contact {
            break collision;
        }
        if drive.pose.point().distance(goal) <= rules.goal_tolerance_m {
            break Outcome::Reached;
        }
        if drive.cycles >= last_cycle {
            break Outcome::Timeout;
        }
        let scan = world.at(drive.time_s()).cast(drive.pose, &robot.sensor);
        let control = controller(drive.pose, drive.velocity, &scan);
        if progress.is_stuck(&control, drive.cycles) {
            break Outcome::Stuck;
        }
        contact = drive.cycle(command(control.action, drive.cycles)?);
    };
    Ok(drive.into_run(outcome))
}

/// The velocity that an action asks for.
fn command(action: Action, cycle: u64) -> Result<Velocity, SimError> {
    match action {
        Action::Drive(command) if command.v.is_nan() || command.omega.is_nan() => {
            Err(SimError::Command { cycle, command })
        }
        Action::Drive(command) => Ok(command),
        Action::Arrived | Action::Stop => Ok(Velocity::ZERO),
    }
}

impl RunRules {
    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used.
    pub fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_not_negative("goal_tolerance_m", self.goal_tolerance_m)?;
        ConfigError::unless_positive("time_limit_s", self.time_limit_s)?;
        ConfigError::unless_positive("stuck_window_s", self.stuck_window_s)?;
        ConfigError::unless_positive("stuck_progress_m", self.stuck_progress_m)
    }
}

fn check_places(start: Pose, goal: Point) -> Result<(), ConfigError> {
    let values = [
        ("start.x", start.x),
        ("start.y", start.y),
        ("start.theta", start.theta),
        ("goal.x", goal.x),
        ("goal.y", goal.y),
    ];
    match values.into_iter().find(|(_, value)| !value.is_finite()) {
        Some((path, value)) => Err(ConfigError::must_be(path, "finite", value)),
        None => Ok(()),
    }
}

/// Cycles until at least `duration_s` have passed: counted, so that times never drift. 0.14 s is
/// seven cycles of 0.02 s although their quotient is rounded to more than 7.
fn cycles_within(duration_s: f64, cycle_s: f64) -> u64 {
    (duration_s / cycle_s * (1.0 - 1e-9)).ceil() as u64
}

/// The best remaining path so far, and its time.
struct Progress {
    step_m: f64,
    window_cycles: u64,
    /// The remaining length that has to be undercut. A new route may be longer than the last: then
    /// progress is measured on the new one.
    reference_m: f64,
    since_cycle: u64,
    route: Option<u32>,
}

impl Progress {
    fn new(rules: &RunRules, cycle_s: f64) -> Self {
        Self {
            step_m: rules.stuck_progress_m,
            window_cycles: cycles_within(rules.stuck_window_s, cycle_s),
            reference_m: f64::INFINITY,
            since_cycle: 0,
            route: None,
        }
    }

    fn is_stuck(&mut self, control: &Control, cycle: u64) -> bool {
        let remaining_m = control.remaining_m;
        if remaining_m.is_finite() {
            if self.route != Some(control.route) {
                let is_first = self.route.replace(control.route).is_none();
                self.reference_m =
                    if is_first { remaining_m } else { self.reference_m.max(remaining_m) };
            }
            if remaining_m <= self.reference_m - self.step_m {
                (self.reference_m, self.since_cycle) = (remaining_m, cycle);
            }
        }
        cycle - self.since_cycle >= self.window_cycles
    }
}

/// A run under way.
struct Drive<'a> {
    world: &'a World,
    robot: &'a Robot,
    pose: Pose,
    velocity: Velocity,
    cycles: u64,
    length_m: f64,
    /// Infinite without obstacles.
    min_clearance_m: f64,
    samples: Vec<Sample>,
}

impl<'a> Drive<'a> {
    fn new(world: &'a World, robot: &'a Robot, pose: Pose) -> Self {
        let velocity = Velocity::ZERO;
        Self {
            world,
            robot,
            pose,
            velocity,
            cycles: 0,
            length_m: 0.0,
            min_clearance_m: world.at(0.0).distance(&robot.footprint, pose, f64::INFINITY),
            samples: vec![Sample { t_s: 0.0, pose, velocity }],
        }
    }

    /// Time at the beginning of the next cycle \[s\].
    fn time_s(&self) -> f64 {
        self.cycles as f64 * self.robot.cycle_s
    }

    fn contact_at_start(&mut self) -> Option<Outcome> {
        let border_m = self.world.at(0.0).border_distance(&self.robot.footprint, self.pose);
        (self.min_clearance_m.min(border_m) <= 0.0).then(|| self.collided(0.0))
    }

    /// One cycle; the contact, if there was one.
    fn cycle(&mut self, command: Velocity) -> Option<Outcome> {
        let cycle_s = self.robot.cycle_s;
        let reached = self.robot.limits.reached(self.velocity, command, cycle_s);
        let motion = CycleMotion::new(self.pose, self.velocity, reached, cycle_s);
        let footprint = &self.robot.footprint;
        let start_s = self.time_s();
        let sweep = Sweep { world: self.world, motion: &motion, footprint, start_s };
        let contact = sweep.first_contact();
        let end = contact.unwrap_or(CycleMotion::END);
        if self.min_clearance_m.is_finite() {
            self.min_clearance_m = sweep.least_clearance(end, self.min_clearance_m);
        }
        self.pose = motion.pose(end);
        self.velocity = motion.velocity(end);
        self.length_m += motion.driven_m(end);
        let t_s = (self.cycles as f64 + end / CycleMotion::END) * cycle_s;
        self.cycles += 1;
        self.samples.push(Sample { t_s, pose: self.pose, velocity: self.velocity });
        contact.map(|_| self.collided(t_s))
    }

    fn collided(&mut self, t_s: f64) -> Outcome {
        let with = self.world.at(t_s).nearest(&self.robot.footprint, self.pose);
        if with != Obstacle::Border {
            self.min_clearance_m = 0.0;
        }
        Outcome::Collided { pose: self.pose, with }
    }

    fn into_run(self, outcome: Outcome) -> Run {
        Run {
            outcome,
            samples: self.samples,
            length_m: self.length_m,
            min_clearance_m: self.min_clearance_m.is_finite().then_some(self.min_clearance_m),
            cycles: self.cycles,
        }
    }
}

#[cfg(test)]
mod tests;
