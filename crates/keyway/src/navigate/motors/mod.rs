//! The motors, as far as a navigator knows them: the commands that are on their way to them, and
//! how they do what they are told, learned while the robot drives.
//!
//! A robot's description says how late its motors act, and it is often wrong: a driver waits for
//! its own clock, a bus is slow, wheels follow their controllers, poses are stamped when they
//! arrive. So commands are compared with velocities ([`DelayFilter`]); where the description does
//! not fit what is seen, what was learned takes its place in everything that looks ahead.

mod dead_band;
mod delay_filter;
mod odometry;
#[cfg(test)]
mod tests;
mod under_way;

use super::time::Time;
use crate::geometry::{Pose, Velocity};
use crate::robot::Robot;
use dead_band::DeadBand;
use delay_filter::DelayFilter;
use odometry::Odometry;
use serde::{Deserialize, Serialize};
use under_way::UnderWay;

/// The commands that were given to the motors, and their ways.
#[derive(Clone, Debug)]
pub(super) struct Motors {
    described_s: f64,
    cycle_s: f64,
    under_way: UnderWay,
    filter: DelayFilter,
    dead_band: DeadBand,
    odometry: Odometry,
}

/// The part of [`Motors`] that does not follow from the robot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct StoredMotors {
    commands: Vec<(Time, Velocity)>,
    filter: DelayFilter,
    dead_band: DeadBand,
    odometry: Odometry,
}

impl Motors {
    /// So long a command acts that moves nothing, before it is known to be too small \[s\].
    const PATIENCE_S: f64 = 0.3;

    pub(super) fn new(robot: &Robot) -> Self {
        let described_s = robot.actuation_delay_s;
        let filter = DelayFilter::new(described_s, robot.cycle_s);
        let under_way = UnderWay::new(robot, filter.longest_s());
        let (dead_band, odometry) = (DeadBand::new(robot), Odometry::default());
        let cycle_s = robot.cycle_s;
        Self { described_s, cycle_s, under_way, filter, dead_band, odometry }
    }

    /// Learns from what was observed. The velocity that the robot has: as told, or where odometry
    /// says nothing, what follows from the commands.
    pub(super) fn observe(&mut self, time: Time, pose: Pose, told: Velocity) -> Velocity {
        let command = self.under_way.acts_at(time, self.delay_s()).unwrap_or(Velocity::ZERO);
        let measured = self.odometry.note(time, (pose, told), command, self.under_way.full());
        self.filter.observe(time, measured, &self.under_way);
        let is_told = !self.odometry.says_nothing();
        if is_told {
            let patience_s = Self::PATIENCE_S.max(3.0 * self.cycle_s);
            self.dead_band.note(time, told, command, patience_s);
        } else {
            // What did not move the robot may have moved it.
            self.dead_band.forget();
        }
        self.under_way.too_small = self.dead_band.too_small();
        if is_told { told } else { self.filter.velocity(self.delay_s()) }
    }

    /// The time from a command to its effect: as described, or learned \[s\].
    pub(super) fn delay_s(&self) -> f64 {
        self.filter.learned_s().unwrap_or(self.described_s)
    }

    /// The time from a command to its effect as described \[s\].
    pub(super) const fn described_s(&self) -> f64 {
        self.described_s
    }

    /// The delay that was learned where it is not what the robot's description says \[s\].
    pub(super) const fn learned_s(&self) -> Option<f64> {
        self.filter.learned_s()
    }

    /// The command that moves a robot with a velocity as nearly as its motors can.
    pub(super) fn within_reach(&self, now: Velocity, asked: Velocity) -> Velocity {
        self.dead_band.given(now, asked)
    }

    /// The least speed and turn rate that the motors do; 0 where they do all.
    pub(super) fn least(&self) -> Velocity {
        self.dead_band.least()
    }

    /// The largest speed and turn rate that have not moved the robot, where something larger has;
    /// otherwise 0.
    pub(super) fn too_small(&self) -> Velocity {
        self.dead_band.surely_too_small()
    }

    /// Pose and velocity at the instant at which a command that is given `now` acts, for a robot
    /// that was observed at a time.
    pub(super) fn predicted(
        &self,
        observed: Time,
        now: Time,
        state: (Pose, Velocity),
    ) -> (Pose, Velocity) {
        self.under_way.predicted((observed, now), self.delay_s(), state)
    }

    /// Notes a command that is given now.
    pub(super) fn give(&mut self, observed: Time, now: Time, command: Velocity) {
        self.under_way.give(observed, now, command);
    }

    /// The command that acts at a time; `None` before the first.
    pub(super) fn acts_at(&self, time: Time) -> Option<Velocity> {
        self.under_way.acts_at(time, self.delay_s())
    }

    /// True if a robot stands, and no command under way moves it.
    pub(super) fn is_at_rest(&self, observed: Time, now: Time, stands: (&Robot, Velocity)) -> bool {
        self.under_way.is_at_rest((observed, now), self.delay_s(), stands)
    }

    /// The clock begins anew: what is under way is forgotten, and not what was learned.
    pub(super) fn restart_clock(&mut self) {
        self.under_way.clear();
        self.filter.pause();
        self.dead_band.pause();
        self.odometry = Odometry::default();
    }

    pub(super) fn stored(&self) -> StoredMotors {
        let Self { under_way, filter, dead_band, odometry, .. } = self;
        let (commands, filter) = (under_way.commands(), filter.clone());
        StoredMotors { commands, filter, dead_band: *dead_band, odometry: *odometry }
    }

    /// Takes up what was stored; false where it is not that of this robot.
    pub(super) fn take_up(&mut self, stored: StoredMotors) -> bool {
        let is_own = stored.filter.is_like(&self.filter);
        self.under_way.take_up(&stored.commands);
        self.under_way.too_small = stored.dead_band.too_small();
        (self.filter, self.dead_band) = (stored.filter, stored.dead_band);
        self.odometry = stored.odometry;
        is_own
    }
}
