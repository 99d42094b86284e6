//! Jerk limits, as a moving average over a motion that is limited in acceleration only.
//!
//! # Method
//! The motion of a robot is planned as a *reference*: a velocity for the end of each cycle, within
//! the limits of speed and acceleration. The command of a cycle is the mean of the last n
//! reference velocities. From one command to the next it changes by the mean of the last n changes
//! of the reference, so it keeps the acceleration limits, too. That change itself changes by the
//! difference of two changes of the reference, n cycles apart, over n. With changes from -b c to a
//! c in cycles of duration c, the jerk is at most (a + b) / (n c), and n follows from the jerk
//! limit ([`Limits::smoothing_cycles`]).
//!
//! There is one exception: if acceleration and deceleration differ and the reference reverses
//! within n cycles, a command may change by the larger limit although the motors only achieve the
//! smaller one. The motors then lag behind the command for some cycles.
//!
//! The mean preserves the distance: on a straight, the robot travels as far as the reference, but
//! (n - 1) / 2 cycles later. So the reference has a pose at any time
//! ([`CommandWindow::reference_pose`]), ahead of the robot by the distance that is still in its
//! commands. That is exact on an arc of constant curvature and when turning in place. At changes
//! of curvature the robot cuts the corner slightly, so a collision check has to follow the
//! commands ([`CommandWindow::commands`]).
//!
//! # Source
//! Moving average filters for set points: \[Biagiotti2012\].
//!
//! # Cost
//! A command costs n additions, a manoeuvre of k cycles n + k. Only [`CommandWindow::of`]
//! allocates.

use super::{Limits, Robot};
use crate::ConfigError;
use crate::geometry::{Pose, Velocity};
use crate::given::Given;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

impl Limits {
    /// Maximum averaging time of commands \[s\]: with a longer one, the robot would no longer do
    /// what it is commanded to.
    const LONGEST_SMOOTHING_S: f64 = 2.0;

    /// The number of cycles over which commands are averaged to keep the jerk limits; 1 without
    /// limits.
    pub fn smoothing_cycles(&self, cycle_s: f64) -> usize {
        let cycles = |(_, jerk, range, _): (&str, Option<f64>, f64, &str)| {
            // Rounding must not make a window that is just long enough one cycle longer.
            jerk.map_or(1.0, |jerk| (range / (jerk * cycle_s) - 1e-9).ceil().max(1.0))
        };
        self.jerks().map(cycles).into_iter().fold(1.0, f64::max) as usize
    }

    /// Each jerk limit: its field, its value, the largest difference of two accelerations, and the
    /// fields of those.
    fn jerks(&self) -> [(&'static str, Option<f64>, f64, &'static str); 2] {
        // If a robot backs up, or turns to either side, two successive accelerations may both have
        // the larger magnitude.
        let either = |a: f64, b: f64| 2.0 * a.max(b);
        let (a, b) = (self.acceleration_mps2, self.deceleration_mps2);
        let straight = if self.v_min_mps < 0.0 { either(a, b) } else { a + b };
        let turning = either(self.angular_acceleration_radps2, self.angular_deceleration_radps2);
        [
            ("limits.jerk_mps3", self.jerk_mps3, straight, "accelerations"),
            (
                "limits.angular_jerk_radps3",
                self.angular_jerk_radps3,
                turning,
                "angular accelerations",
            ),
        ]
    }

    /// Refuses jerk limits that are not positive numbers, or that need too long a window.
    pub(super) fn check_jerks(&self, cycle_s: f64) -> Result<(), ConfigError> {
        let most = (Self::LONGEST_SMOOTHING_S / cycle_s + 1e-9).floor().max(1.0);
        for (field, jerk, range, accelerations) in self.jerks() {
            let Some(jerk) = jerk else { continue };
            ConfigError::unless_positive(field, jerk)?;
            let least = range / (most * cycle_s);
            if jerk < least * (1.0 - 1e-9) {
                // Rounded up, so that the value in the message is valid.
                let least = Given((least * 1e6).ceil() / 1e6);
                let expected = format!(
                    "at least {least}, so that commands are averaged over at most 2 s (reduce the \
                     {accelerations} to allow less)"
                );
                return Err(ConfigError::must_be(field, &expected, jerk));
            }
        }
        Ok(())
    }
}

impl Robot {
    /// Time by which a robot with jerk limits lags behind its reference \[s\]; 0 without limits.
    pub fn smoothing_lag_s(&self) -> f64 {
        let cycles = self.limits.smoothing_cycles(self.cycle_s);
        0.5 * (cycles - 1) as f64 * self.cycle_s
    }
}

/// The reference velocities of the last cycles, whose mean is the command.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CommandWindow {
    /// The velocities that are averaged, the oldest first.
    references: VecDeque<Velocity>,
}

impl CommandWindow {
    /// The window of a robot at rest; `None` for a robot whose commands are not averaged.
    pub fn of(robot: &Robot) -> Option<Self> {
        let cycles = robot.limits.smoothing_cycles(robot.cycle_s);
        (cycles > 1).then(|| Self { references: VecDeque::from(vec![Velocity::ZERO; cycles]) })
    }

    /// The current velocity of the reference.
    pub fn reference(&self) -> Velocity {
        self.references.back().copied().unwrap_or(Velocity::ZERO)
    }

    /// The last command: the mean.
    pub fn command(&self) -> Velocity {
        mean(self.sum(), self.references.len())
    }

    fn sum(&self) -> Velocity {
        self.references.iter().fold(Velocity::ZERO, |sum, &velocity| plus(sum, velocity, 1.0))
    }

    /// Advances by a cycle at whose end the reference has this velocity; returns the command of
    /// that cycle.
    pub fn push(&mut self, reference: Velocity) -> Velocity {
        self.references.pop_front();
        self.references.push_back(reference);
        self.command()
    }

    /// Restarts with a robot that drives at this velocity.
    pub fn refill(&mut self, velocity: Velocity) {
        self.references.iter_mut().for_each(|reference| *reference = velocity);
    }

    /// The velocities of the reference that are still averaged.
    pub(crate) fn references(&self) -> impl Iterator<Item = Velocity> {
        self.references.iter().copied()
    }

    /// True if both windows have the same length, and all velocities of this one are finite.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        let is_number = |velocity: Velocity| velocity.v.is_finite() && velocity.omega.is_finite();
        self.references.len() == other.references.len() && self.references().all(is_number)
    }

    /// True if every velocity counts as stationary.
    pub(crate) fn is_still(&self, robot: &Robot) -> bool {
        self.references().all(|velocity| robot.stands(velocity))
    }

    /// True if every velocity is 0.
    pub(crate) fn is_zero(&self) -> bool {
        self.references().all(|velocity| velocity == Velocity::ZERO)
    }

    /// The coming commands, while the reference follows some velocities and then stays at rest,
    /// until the commands are 0, too.
    pub(crate) fn commands<I>(&self, coming: I) -> impl Iterator<Item = Velocity>
    where
        I: Iterator<Item = Velocity> + Clone,
    {
        let cycles = self.references.len();
        let mut leaving = self.references().chain(coming.clone());
        let (mut coming, mut sum) = (coming.fuse(), self.sum());
        let mut left = cycles;
        std::iter::from_fn(move || {
            let entering = coming.next();
            left -= usize::from(entering.is_none()).min(left);
            if left == 0 {
                return None;
            }
            sum = plus(sum, entering.unwrap_or(Velocity::ZERO), 1.0);
            sum = plus(sum, leaving.next().unwrap_or(Velocity::ZERO), -1.0);
            // The last command is exactly 0, not a rounding error.
            Some(if left == 1 { Velocity::ZERO } else { mean(sum, cycles) })
        })
    }

    /// Pose of the reference, for a robot at a pose with a velocity. If the reference stopped
    /// instantly, the robot would come to rest at this pose, on a straight and on an arc.
    pub(crate) fn reference_pose(&self, pose: Pose, velocity: Velocity, cycle_s: f64) -> Pose {
        if self.is_zero() {
            return pose;
        }
        let follow = |(pose, from): (Pose, Velocity), to| (pose.after_ramp(from, to, cycle_s), to);
        let stop = std::iter::once(Velocity::ZERO);
        let (end, _) = self.commands(stop).fold((pose, velocity), follow);
        // The velocity changes linearly in a cycle, so an instant stop is half a cycle earlier.
        end.after_arc(self.reference(), -0.5 * cycle_s)
    }
}

fn plus(a: Velocity, b: Velocity, sign: f64) -> Velocity {
    Velocity::new(a.v + sign * b.v, a.omega + sign * b.omega)
}

fn mean(sum: Velocity, count: usize) -> Velocity {
    Velocity::new(sum.v / count as f64, sum.omega / count as f64)
}

#[cfg(test)]
#[path = "command_window_tests.rs"]
mod tests;
