//! Dead band: commands that are too small for the motors.
//!
//! A wheel at rest has to overcome static friction: below some speed nothing moves. A command
//! that follows from the measured velocity, limited to what the robot can reach within a cycle,
//! may stay below that forever. Commands that have not moved the robot for a while are therefore
//! taken to be too small, and smaller ones are no longer given: a command above half of the
//! smallest one that moves the robot is raised to that one, others become 0.

use crate::geometry::Velocity;
use crate::navigate::time::Time;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// Estimate of the largest commands that do not move a robot.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct DeadBand {
    v: Axis,
    /// `None` for a car-like robot, which steers: its turn rate follows from its speed.
    omega: Option<Axis>,
}

/// Speed or turn rate.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Axis {
    full: f64,
    /// Largest measurement of an axis at rest.
    standing: f64,
    /// Largest command that has not moved it; 0 if none is known.
    too_small: f64,
    /// True if a larger command has moved it.
    is_sure: bool,
    stands: bool,
    /// Time since which it has been at rest despite commands, and the largest command since.
    asked: Option<(Time, f64)>,
}

impl DeadBand {
    pub(super) fn new(robot: &Robot) -> Self {
        let (limits, standing) = (&robot.limits, robot.standing());
        let full_mps = limits.v_max_mps.max(-limits.v_min_mps);
        let v = Axis::new(full_mps, standing.v);
        let omega = Axis::new(limits.omega_max_radps, standing.omega);
        Self { v, omega: limits.turns_in_place().then_some(omega) }
    }

    /// Takes in the velocity of the robot and the acting command. A command is too small if it
    /// has acted for `patience_s` \[s\] without any motion.
    pub(super) fn note(&mut self, time: Time, now: Velocity, command: Velocity, patience_s: f64) {
        self.v.note(time, (now.v, command.v), patience_s);
        if let Some(omega) = &mut self.omega {
            omega.note(time, (now.omega, command.omega), patience_s);
        }
    }

    /// The largest speed and turn rate that have not moved the robot; 0 if none is known.
    pub(super) fn too_small(&self) -> Velocity {
        self.each(|axis| axis.too_small)
    }

    /// Like [`Self::too_small`], if a larger command has moved the robot; otherwise 0.
    pub(super) fn surely_too_small(&self) -> Velocity {
        self.each(|axis| if axis.is_sure { axis.too_small } else { 0.0 })
    }

    /// The smallest speed and turn rate that are given; 0 if there is no limit.
    pub(super) fn least(&self) -> Velocity {
        self.each(Axis::least)
    }

    fn each(&self, of: impl Fn(&Axis) -> f64) -> Velocity {
        Velocity::new(of(&self.v), self.omega.as_ref().map_or(0.0, of))
    }

    /// The command that the motors can follow and that is closest to the requested velocity.
    pub(super) fn given(&self, now: Velocity, asked: Velocity) -> Velocity {
        let Some(omega) = &self.omega else { return self.given_to_car(now.v, asked) };
        let parts = [self.v.part(asked.v), omega.part(asked.omega)];
        let given =
            Velocity::new(self.v.given(now.v, asked.v), omega.given(now.omega, asked.omega));
        // A robot that is to creep does not stay at rest forever.
        let stands = self.v.is_standing(now.v) && omega.is_standing(now.omega);
        if given != Velocity::ZERO || parts == [0.0; 2] || !stands {
            return given;
        }
        if parts[0] >= parts[1] {
            Velocity::new(self.v.least().copysign(asked.v), 0.0)
        } else {
            Velocity::new(0.0, omega.least().copysign(asked.omega))
        }
    }

    /// A command on the same arc.
    fn given_to_car(&self, now_mps: f64, asked: Velocity) -> Velocity {
        if asked.v == 0.0 {
            return asked;
        }
        let given_mps = match self.v.given(now_mps, asked.v) {
            0.0 if self.v.is_standing(now_mps) => self.v.least().copysign(asked.v),
            given_mps => given_mps,
        };
        Velocity::new(given_mps, asked.omega * (given_mps / asked.v))
    }

    /// True for the dead band of a robot of the same kind.
    pub(super) const fn is_like(&self, other: &Self) -> bool {
        self.omega.is_some() == other.omega.is_some()
    }

    /// Forgets the current attempt, but not what was learned.
    pub(super) fn pause(&mut self) {
        self.axes().for_each(|axis| axis.asked = None);
    }

    /// Forgets everything.
    pub(super) fn forget(&mut self) {
        for axis in self.axes() {
            (axis.too_small, axis.is_sure, axis.asked) = (0.0, false, None);
        }
    }

    fn axes(&mut self) -> impl Iterator<Item = &mut Axis> {
        [&mut self.v].into_iter().chain(&mut self.omega)
    }
}

impl Axis {
    /// Factor from a command that has not moved the robot to the next larger one.
    const LARGER: f64 = 1.25;

    /// Share of full speed above which a robot at rest is held by something else.
    const MOST: f64 = 0.2;

    const fn new(full: f64, standing: f64) -> Self {
        Self { full, standing, too_small: 0.0, is_sure: false, stands: true, asked: None }
    }

    fn note(&mut self, time: Time, (now, command): (f64, f64), patience_s: f64) {
        let stands = self.is_standing(now);
        let stood = std::mem::replace(&mut self.stands, stands);
        let asked = command.abs();
        if !self.stands {
            self.asked = None;
            // A smaller command has set it in motion.
            if stood && asked > self.standing && asked <= self.too_small {
                self.too_small = 0.0;
            }
            self.is_sure = self.too_small > 0.0;
            return;
        }
        // A smaller request cannot be told from measurement noise.
        if asked <= 2.0 * self.standing || asked > Self::MOST * self.full {
            self.asked = None;
            return;
        }
        let (since, most) = self.asked.unwrap_or((time, 0.0));
        let most = asked.max(most);
        self.asked = Some((since, most));
        if time.since_s(since) >= patience_s {
            self.too_small = most.max(self.too_small);
            self.is_sure = false;
            self.asked = None;
        }
    }

    fn least(&self) -> f64 {
        Self::LARGER * self.too_small
    }

    /// A command as a share of the smallest one that moves.
    fn part(&self, asked: f64) -> f64 {
        if self.too_small > 0.0 { asked.abs() / self.least() } else { asked.abs() / self.full }
    }

    fn is_standing(&self, now: f64) -> bool {
        now.abs() <= self.standing
    }

    /// The command to give; a robot that slows down is not made faster than requested.
    fn given(&self, now: f64, asked: f64) -> f64 {
        let least = self.least();
        if asked.abs() >= least {
            return asked;
        }
        let slows_down = now * asked > 0.0 && asked.abs() < now.abs();
        if asked.abs() >= 0.5 * least && !slows_down { least.copysign(asked) } else { 0.0 }
    }
}
