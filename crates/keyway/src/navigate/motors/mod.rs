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
mod smoothing;
#[cfg(test)]
mod tests;
mod under_way;

use super::time::Time;
use crate::geometry::{Pose, Velocity};
use crate::robot::{CommandWindow, Robot};
use dead_band::DeadBand;
use delay_filter::DelayFilter;
use odometry::Odometry;
use serde::{Deserialize, Serialize};
use smoothing::{Drive, Smoothing};
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
    drive: Drive,
    /// `None` for a robot without limits of jerk.
    smoothing: Option<Smoothing>,
}

/// The part of [`Motors`] that does not follow from the robot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct StoredMotors {
    commands: Vec<(Time, Velocity)>,
    filter: DelayFilter,
    dead_band: DeadBand,
    odometry: Odometry,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    smoothing: Option<Smoothing>,
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
        let drive = Drive { limits: robot.limits.clone(), cycle_s };
        let smoothing = Smoothing::of(robot);
        Self { described_s, cycle_s, under_way, filter, dead_band, odometry, drive, smoothing }
    }

    /// Learns from what was observed. The velocity that the robot has: as told, or where odometry
    /// says nothing, what follows from the commands.
    pub(super) fn observe(&mut self, time: Time, pose: Pose, told: Velocity) -> Velocity {
        let acting = self.under_way.acts_at(time, self.delay_s());
        let command = acting.unwrap_or(Velocity::ZERO);
        let measured = self.odometry.note(time, (pose, told), command, self.under_way.full());
        self.filter.observe(time, measured, &self.under_way);
        let is_told = !self.odometry.says_nothing();
        if let (Some(smoothing), Some(command), true) = (&mut self.smoothing, acting, is_told) {
            smoothing.note(time, (told, command), &self.drive);
        }
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

    /// Begins a cycle of a robot that has a velocity when its next command acts: the pose and the
    /// velocity to decide for. They are those of its reference, if its commands are averaged.
    pub(super) fn begin(
        &mut self,
        now: Time,
        (pose, velocity): (Pose, Velocity),
    ) -> (Pose, Velocity) {
        let Some(smoothing) = &mut self.smoothing else { return (pose, velocity) };
        smoothing.begin(now, velocity, &self.drive);
        let Smoothing { window, .. } = smoothing;
        (window.reference_pose(pose, velocity, self.cycle_s), window.reference())
    }

    /// The command to give where one was decided on; the same, unless commands are averaged.
    pub(super) fn smoothed(&mut self, now: Time, decided: Velocity) -> Velocity {
        match &mut self.smoothing {
            Some(smoothing) => smoothing.smooth(Some(now), decided, &self.drive),
            None => decided,
        }
    }

    /// The command that stops a robot of which nothing is known: at once, unless commands are
    /// averaged. Then it goes on with the motion that was found to touch nothing.
    pub(super) fn stopping(&mut self) -> Velocity {
        let Some(smoothing) = &mut self.smoothing else { return Velocity::ZERO };
        let Drive { limits, cycle_s } = &self.drive;
        let braked = limits.braked(smoothing.window.reference(), *cycle_s);
        smoothing.smooth(None, braked, &self.drive)
    }

    /// The velocities that are still averaged, if commands are.
    pub(super) fn window(&self) -> Option<&CommandWindow> {
        self.smoothing.as_ref().map(|smoothing| &smoothing.window)
    }

    /// True if something of what was decided is still to be given.
    pub(super) fn moves_on(&self, robot: &Robot) -> bool {
        self.window().is_some_and(|window| !window.is_still(robot))
    }

    /// Notes a command that is given now.
    pub(super) fn give(&mut self, observed: Time, now: Time, command: Velocity) {
        self.under_way.give(observed, now, command);
    }

    /// Notes a command of somebody else. Averages begin anew with what the robot then does.
    pub(super) fn note_override(&mut self, now: Time, command: Velocity) {
        self.under_way.give(now, now, command);
        if let Some(smoothing) = &mut self.smoothing {
            smoothing.begin_anew();
        }
    }

    /// The command that acts at a time; `None` before the first.
    pub(super) fn acts_at(&self, time: Time) -> Option<Velocity> {
        self.under_way.acts_at(time, self.delay_s())
    }

    /// True if a robot stands, and no command under way moves it.
    pub(super) fn is_at_rest(&self, observed: Time, now: Time, stands: (&Robot, Velocity)) -> bool {
        let is_at_rest = self.under_way.is_at_rest((observed, now), self.delay_s(), stands);
        is_at_rest && !self.moves_on(stands.0)
    }

    /// The clock begins anew: what is under way is forgotten, and not what was learned.
    pub(super) fn restart_clock(&mut self) {
        self.under_way.clear();
        self.filter.pause();
        self.dead_band.pause();
        self.odometry = Odometry::default();
        if let Some(smoothing) = &mut self.smoothing {
            smoothing.begin_anew();
        }
    }

    pub(super) fn stored(&self) -> StoredMotors {
        let Self { under_way, filter, dead_band, odometry, .. } = self;
        let (commands, filter) = (under_way.commands(), filter.clone());
        let smoothing = self.smoothing.clone();
        StoredMotors { commands, filter, dead_band: *dead_band, odometry: *odometry, smoothing }
    }

    /// Takes up what was stored; false where it is not that of this robot.
    pub(super) fn take_up(&mut self, stored: StoredMotors) -> bool {
        let is_like = |stored: &Smoothing| {
            self.smoothing.as_ref().is_some_and(|own| stored.window.is_like(&own.window))
        };
        let is_own = stored.filter.is_like(&self.filter)
            && stored.smoothing.is_some() == self.smoothing.is_some()
            && stored.smoothing.as_ref().is_none_or(is_like);
        self.under_way.take_up(&stored.commands);
        self.under_way.too_small = stored.dead_band.too_small();
        (self.filter, self.dead_band) = (stored.filter, stored.dead_band);
        self.odometry = stored.odometry;
        self.smoothing = stored.smoothing;
        is_own
    }
}
