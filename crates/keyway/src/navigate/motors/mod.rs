//! Model of the motors: the commands in flight, and the response of the motors to them, learned
//! while the robot drives.
//!
//! A robot's description gives its actuation delay, and is often wrong: a driver waits for its
//! own clock, a bus is slow, wheels lag behind their controllers, poses are stamped on arrival.
//! Commands are therefore compared with velocities ([`DelayFilter`]). If the description does not
//! fit the observations, the learned delay replaces it in every prediction.

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

/// The commands that were given to the motors, and the model of their response.
#[derive(Clone, Debug)]
pub(super) struct Motors {
    described_s: f64,
    cycle_s: f64,
    under_way: UnderWay,
    filter: DelayFilter,
    dead_band: DeadBand,
    odometry: Odometry,
    drive: Drive,
    /// `None` for a robot without jerk limits.
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
    /// Time for which a command acts without effect until it is taken to be too small \[s\].
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

    /// Learns from an observation and returns the velocity of the robot: as reported, or
    /// predicted from the commands if the odometry reports none.
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
            // A command that seemed to have no effect may have moved the robot.
            self.dead_band.forget();
        }
        self.under_way.too_small = self.dead_band.too_small();
        if is_told { told } else { self.filter.velocity(self.delay_s()) }
    }

    /// The time from a command to its effect, learned or else as described \[s\].
    pub(super) fn delay_s(&self) -> f64 {
        self.filter.learned_s().unwrap_or(self.described_s)
    }

    /// The time from a command to its effect as described \[s\].
    pub(super) const fn described_s(&self) -> f64 {
        self.described_s
    }

    /// The learned delay, if it differs from the robot's description \[s\].
    pub(super) const fn learned_s(&self) -> Option<f64> {
        self.filter.learned_s()
    }

    /// The command that the motors can follow and that is closest to the requested velocity.
    pub(super) fn within_reach(&self, now: Velocity, asked: Velocity) -> Velocity {
        let given = self.dead_band.given(now, asked);
        let limits = &self.drive.limits;
        if limits.turns_in_place() || given.v == 0.0 {
            return given;
        }
        // A command that was made larger stays on its arc.
        let v_mps = given.v.clamp(limits.v_min_mps, limits.v_max_mps);
        Velocity::new(v_mps, given.omega * (v_mps / given.v))
    }

    /// The smallest speed and turn rate that the motors follow; 0 if there is no limit.
    pub(super) fn least(&self) -> Velocity {
        self.dead_band.least()
    }

    /// The largest speed and turn rate that have not moved the robot, if a larger command has;
    /// otherwise 0.
    pub(super) fn too_small(&self) -> Velocity {
        self.dead_band.surely_too_small()
    }

    /// Predicts the pose and the velocity at the instant at which a command given `now` takes
    /// effect, for a robot that was observed earlier.
    pub(super) fn predicted(
        &self,
        observed: Time,
        now: Time,
        state: (Pose, Velocity),
    ) -> (Pose, Velocity) {
        self.under_way.predicted((observed, now), self.delay_s(), state)
    }

    /// Begins a cycle, given the state in which the next command takes effect: returns the pose
    /// and the velocity to plan from. They are those of the reference if commands are averaged.
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

    /// The command for a decided velocity; the same unless commands are averaged.
    pub(super) fn smoothed(&mut self, now: Time, decided: Velocity) -> Velocity {
        match &mut self.smoothing {
            Some(smoothing) => smoothing.smooth(Some(now), decided, &self.drive),
            None => decided,
        }
    }

    /// The command that stops a robot in an unknown state: at once, unless commands are averaged.
    /// In that case it continues the motion that was found to be free of contact.
    pub(super) fn stopping(&mut self) -> Velocity {
        let Some(smoothing) = &mut self.smoothing else { return Velocity::ZERO };
        let Drive { limits, cycle_s } = &self.drive;
        let braked = limits.braked(smoothing.window.reference(), *cycle_s);
        smoothing.smooth(None, braked, &self.drive)
    }

    /// The averaging window, if commands are averaged.
    pub(super) fn window(&self) -> Option<&CommandWindow> {
        self.smoothing.as_ref().map(|smoothing| &smoothing.window)
    }

    /// True if the averaging window still holds motion to be given.
    pub(super) fn moves_on(&self, robot: &Robot) -> bool {
        self.window().is_some_and(|window| !window.is_still(robot))
    }

    /// Records a command that is given now.
    pub(super) fn give(&mut self, observed: Time, now: Time, command: Velocity) {
        self.under_way.give(observed, now, command);
    }

    /// Records a command from another source. The averages then restart from the resulting
    /// motion.
    pub(super) fn note_override(&mut self, now: Time, command: Velocity) {
        self.under_way.give(now, now, command);
        if let Some(smoothing) = &mut self.smoothing {
            smoothing.begin_anew();
        }
    }

    /// The command in effect at a time; `None` before the first.
    pub(super) fn acts_at(&self, time: Time) -> Option<Velocity> {
        self.under_way.acts_at(time, self.delay_s())
    }

    /// True if a robot is stationary, and no command in flight moves it.
    pub(super) fn is_at_rest(&self, observed: Time, now: Time, stands: (&Robot, Velocity)) -> bool {
        let is_at_rest = self.under_way.is_at_rest((observed, now), self.delay_s(), stands);
        is_at_rest && !self.moves_on(stands.0)
    }

    /// Restarts the clock: the commands in flight are forgotten, but not what was learned.
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

    /// Restores a stored state; false if it belongs to another robot.
    pub(super) fn take_up(&mut self, stored: StoredMotors) -> bool {
        let is_like = |stored: &Smoothing| {
            self.smoothing.as_ref().is_some_and(|own| stored.window.is_like(&own.window))
        };
        let is_own = stored.filter.is_like(&self.filter)
            && stored.dead_band.is_like(&self.dead_band)
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
