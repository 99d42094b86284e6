//! Commands of a robot with jerk limits: averages of the decided velocities.
//!
//! The average is taken over decisions, not measurements, so it is insensitive to odometry noise.
//! It restarts from the measured velocity only if the robot has not followed its commands at all
//! for a while (it has been stopped or driven by something else), or has had no commands.

use crate::geometry::Velocity;
use crate::navigate::time::Time;
use crate::robot::{CommandWindow, Limits, Robot};
use serde::{Deserialize, Serialize};

/// The averaging window, and its validity.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Smoothing {
    pub(super) window: CommandWindow,
    /// Time of the last command; `None` if the state of the robot is open.
    given: Option<Time>,
    /// Time since which the robot has not followed its commands.
    astray: Option<Time>,
}

impl Smoothing {
    /// Tolerated time without following commands \[s\], or three cycles.
    const PATIENCE_S: f64 = 0.3;

    /// Longest time without commands after which the window is still valid \[s\], or three
    /// cycles.
    const LONGEST_S: f64 = 1.0;

    /// The window of a robot at rest; `None` if nothing is averaged.
    pub(super) fn of(robot: &Robot) -> Option<Self> {
        Some(Self { window: CommandWindow::of(robot)?, given: None, astray: None })
    }

    /// Compares the measured velocity with the acting command.
    pub(super) fn note(&mut self, time: Time, (now, told): (Velocity, Velocity), robot: &Drive) {
        if robot.follows(now, told) {
            self.astray = None;
        } else {
            self.astray.get_or_insert(time);
        }
    }

    /// Begins a cycle: if the window is invalid, it is refilled with the velocity of the robot.
    pub(super) fn begin(&mut self, now: Time, velocity: Velocity, drive: &Drive) {
        let since = |time: Time, least_s: f64| now.since_s(time) > least_s.max(3.0 * drive.cycle_s);
        let is_astray = self.astray.is_some_and(|since_then| since(since_then, Self::PATIENCE_S));
        if is_astray || self.given.is_none_or(|last| since(last, Self::LONGEST_S)) {
            self.window.refill(drive.limits.clamped(velocity));
            (self.given, self.astray) = (Some(now), None);
        }
    }

    /// The command for a reference that moves towards a velocity.
    pub(super) fn smooth(&mut self, now: Option<Time>, to: Velocity, drive: &Drive) -> Velocity {
        self.given = self.given.and(now.or(self.given));
        let Drive { limits, cycle_s } = drive;
        let command = self.window.push(limits.reached(self.window.reference(), to, *cycle_s));
        // A mean of full speeds may exceed full speed in its last bit.
        limits.clamped(command)
    }

    /// Restarts the next cycle from the velocity that the robot then has.
    pub(super) const fn begin_anew(&mut self) {
        (self.given, self.astray) = (None, None);
    }
}

/// The drive properties that matter for following commands.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    pub(super) limits: Limits,
    pub(super) cycle_s: f64,
}

impl Drive {
    /// True if a robot follows its commands approximately: within the change that is possible in
    /// two cycles, plus half of its speed.
    fn follows(&self, now: Velocity, told: Velocity) -> bool {
        let is_near = |now: f64, told: f64, deceleration: f64| {
            let sheds = 2.0 * deceleration * self.cycle_s;
            (now - told).abs() <= sheds + 0.5 * now.abs().max(told.abs())
        };
        let Limits { deceleration_mps2, angular_deceleration_radps2, .. } = self.limits;
        is_near(now.v, told.v, deceleration_mps2)
            && is_near(now.omega, told.omega, angular_deceleration_radps2)
    }
}
