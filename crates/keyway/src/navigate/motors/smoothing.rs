//! Commands of a robot with limits of jerk: averages of what was decided.
//!
//! The average is one of decisions and not of measurements, so noise of odometry does not shake it.
//! Only where the robot for a while does not at all drive as it was told (somebody has stopped it,
//! or drives it), or has not been told anything, it begins anew with what was measured.

use crate::geometry::Velocity;
use crate::navigate::time::Time;
use crate::robot::{CommandWindow, Limits, Robot};
use serde::{Deserialize, Serialize};

/// The average, and how far the robot drives by it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Smoothing {
    pub(super) window: CommandWindow,
    /// Time of the last command; `None` where the robot may do anything.
    given: Option<Time>,
    /// Since when the robot does not drive as it was told.
    astray: Option<Time>,
}

impl Smoothing {
    /// The patience with a robot that does not drive as it was told \[s\], or three cycles.
    const PATIENCE_S: f64 = 0.3;

    /// A robot that was not told anything for so long drives as it does \[s\], or three cycles.
    const LONGEST_S: f64 = 1.0;

    /// That of a robot at rest; `None` where nothing is averaged.
    pub(super) fn of(robot: &Robot) -> Option<Self> {
        Some(Self { window: CommandWindow::of(robot)?, given: None, astray: None })
    }

    /// Compares the velocity that was measured with the command that acts.
    pub(super) fn note(&mut self, time: Time, (now, told): (Velocity, Velocity), robot: &Drive) {
        if robot.follows(now, told) {
            self.astray = None;
        } else {
            self.astray.get_or_insert(time);
        }
    }

    /// Begins a cycle: where what is averaged means nothing, anew with the velocity of the robot.
    pub(super) fn begin(&mut self, now: Time, velocity: Velocity, drive: &Drive) {
        let since = |time: Time, least_s: f64| now.since_s(time) > least_s.max(3.0 * drive.cycle_s);
        let is_astray = self.astray.is_some_and(|since_then| since(since_then, Self::PATIENCE_S));
        if is_astray || self.given.is_none_or(|last| since(last, Self::LONGEST_S)) {
            self.window.refill(drive.limits.clamped(velocity));
            (self.given, self.astray) = (Some(now), None);
        }
    }

    /// The command for a reference that goes on towards a velocity.
    pub(super) fn smooth(&mut self, now: Option<Time>, to: Velocity, drive: &Drive) -> Velocity {
        self.given = self.given.and(now.or(self.given));
        let Drive { limits, cycle_s } = drive;
        let command = self.window.push(limits.reached(self.window.reference(), to, *cycle_s));
        // A mean of full speeds may be one more by its last bit.
        limits.clamped(command)
    }

    /// Begins the next cycle with the velocity that the robot then has.
    pub(super) const fn begin_anew(&mut self) {
        (self.given, self.astray) = (None, None);
    }
}

/// A drive, as far as it is to follow commands.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    pub(super) limits: Limits,
    pub(super) cycle_s: f64,
}

impl Drive {
    /// True if a robot drives nearly as it is told: but for what it makes up for within two cycles,
    /// and half of its speed.
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
