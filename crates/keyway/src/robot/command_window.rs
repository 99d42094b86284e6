//! Limits of jerk, as a moving average behind a motion that is limited in acceleration only.
//!
//! # The method
//! The motion of a robot is planned as a *reference*: a velocity for the end of each cycle, which
//! keeps the limits of speed and acceleration. The command of a cycle is the mean of the last n of
//! them. From one command to the next it changes by the mean of the last n changes of the
//! reference, so it keeps the limits of acceleration, too; and that change changes by the
//! difference of two changes of the reference, n cycles apart, over n. With changes from -b c to
//! a c in cycles of duration c, the jerk is (a + b) / (n c) at most, and n follows from its limit
//! ([`Limits::smoothing_cycles`]). Only where acceleration and deceleration differ, and the
//! reference turns round within n cycles, a command may change by the larger one where the motors
//! do the smaller one: then they are behind it for some cycles.
//!
//! The mean neither adds nor takes way: the robot comes along a straight as far as the reference,
//! later by (n - 1) / 2 cycles. So at any time there is a place at which the reference is
//! ([`CommandWindow::reference_pose`]): ahead of the robot by what its commands still owe it. On an
//! arc of constant curvature, and turning on the spot, that is exact; where the curvature changes,
//! the robot cuts the corner a little, and whoever asks what it touches has to follow the commands
//! ([`CommandWindow::commands`]).
//!
//! # Source
//! Filters of moving averages for set points: \[Biagiotti2012\].
//!
//! # Cost
//! A command costs n additions, a manoeuvre of k cycles n + k. Nothing is allocated but by
//! [`CommandWindow::of`].

use super::{Limits, Robot};
use crate::ConfigError;
use crate::geometry::{Pose, Velocity};
use crate::given::Given;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

impl Limits {
    /// Commands are the mean of no longer time than this \[s\]: for longer, the robot would not do
    /// what it was asked for.
    const LONGEST_SMOOTHING_S: f64 = 2.0;

    /// The number of cycles over which commands are averaged to keep the limits of jerk; 1 where
    /// there are none.
    pub fn smoothing_cycles(&self, cycle_s: f64) -> usize {
        let cycles = |(_, jerk, range, _): (&str, Option<f64>, f64, &str)| {
            // A window that is just long enough is not one cycle longer for a rounding error.
            jerk.map_or(1.0, |jerk| (range / (jerk * cycle_s) - 1e-9).ceil().max(1.0))
        };
        self.jerks().map(cycles).into_iter().fold(1.0, f64::max) as usize
    }

    /// Each limit of jerk: its field, its value, the widest difference of two accelerations, and
    /// the fields of those.
    fn jerks(&self) -> [(&'static str, Option<f64>, f64, &'static str); 2] {
        // Between two accelerations of a robot that backs up, or turns to either side, both may be
        // the larger one.
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

    /// Refuses limits of jerk that are no numbers, or need too long a window.
    pub(super) fn check_jerks(&self, cycle_s: f64) -> Result<(), ConfigError> {
        let most = (Self::LONGEST_SMOOTHING_S / cycle_s + 1e-9).floor().max(1.0);
        for (field, jerk, range, accelerations) in self.jerks() {
            let Some(jerk) = jerk else { continue };
            ConfigError::unless_positive(field, jerk)?;
            let least = range / (most * cycle_s);
            if jerk < least * (1.0 - 1e-9) {
                // Rounded up, so that what the message says can be used.
                let least = Given((least * 1e6).ceil() / 1e6);
                let expected = format!(
                    "at least {least}, to be kept by commands that are spread over 2 s (lower the {accelerations} for less)"
                );
                return Err(ConfigError::must_be(field, &expected, jerk));
            }
        }
        Ok(())
    }
}

impl Robot {
    /// Time by which a robot with limits of jerk is behind its reference \[s\]; 0 without them.
    pub fn smoothing_lag_s(&self) -> f64 {
        let cycles = self.limits.smoothing_cycles(self.cycle_s);
        0.5 * (cycles - 1) as f64 * self.cycle_s
    }
}

/// The reference of the last cycles, of which a command is the mean.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CommandWindow {
    /// As many as are averaged, the oldest first.
    references: VecDeque<Velocity>,
}

impl CommandWindow {
    /// That of a robot at rest; `None` for a robot whose commands are not averaged.
    pub fn of(robot: &Robot) -> Option<Self> {
        let cycles = robot.limits.smoothing_cycles(robot.cycle_s);
        (cycles > 1).then(|| Self { references: VecDeque::from(vec![Velocity::ZERO; cycles]) })
    }

    /// The present velocity of the reference.
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

    /// Goes on for a cycle at whose end the reference has a velocity; the command of that cycle.
    pub fn push(&mut self, reference: Velocity) -> Velocity {
        self.references.pop_front();
        self.references.push_back(reference);
        self.command()
    }

    /// Begins anew with a robot that drives with a velocity.
    pub fn refill(&mut self, velocity: Velocity) {
        self.references.iter_mut().for_each(|reference| *reference = velocity);
    }

    /// Those velocities of the reference that are still averaged.
    pub(crate) fn references(&self) -> impl Iterator<Item = Velocity> {
        self.references.iter().copied()
    }

    /// True if it has as many velocities as another one, and all are numbers.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        let is_number = |velocity: Velocity| velocity.v.is_finite() && velocity.omega.is_finite();
        self.references.len() == other.references.len() && self.references().all(is_number)
    }

    /// True if nothing is left of any motion.
    pub(crate) fn is_still(&self, robot: &Robot) -> bool {
        self.references().all(|velocity| robot.stands(velocity))
    }

    /// True if every velocity of it is 0.
    pub(crate) fn is_zero(&self) -> bool {
        self.references().all(|velocity| velocity == Velocity::ZERO)
    }

    /// The coming commands, while the reference has some velocities, and then stands, until nothing
    /// of it is left.
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
            // Nothing is left, not a rounding error.
            Some(if left == 1 { Velocity::ZERO } else { mean(sum, cycles) })
        })
    }

    /// Pose of the reference, for a robot at a pose with a velocity: on a straight, and on an arc,
    /// a robot whose reference stopped there at once would stop there.
    pub(crate) fn reference_pose(&self, pose: Pose, velocity: Velocity, cycle_s: f64) -> Pose {
        if self.is_zero() {
            return pose;
        }
        let follow = |(pose, from): (Pose, Velocity), to| (pose.after_ramp(from, to, cycle_s), to);
        let stop = std::iter::once(Velocity::ZERO);
        let (end, _) = self.commands(stop).fold((pose, velocity), follow);
        // A velocity changes linearly in a cycle: at once is half of one earlier.
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
