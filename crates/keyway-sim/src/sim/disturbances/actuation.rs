//! Delayed and inexact execution of commands by the motors.

use super::gaussian::Gaussian;
use super::{ActuationNoise, Kind, Source};
use crate::sim::cycle_motion::{CycleMotion, Knee};
use keyway::geometry::{Pose, Velocity};
use keyway::robot::{CycleCount, Limits, Robot};
use std::collections::VecDeque;

/// A robot's motors with delay and errors.
#[derive(Clone, Debug)]
pub(in crate::sim) struct Actuation {
    noise: ActuationNoise,
    cycle_s: f64,
    v: Gaussian,
    omega: Gaussian,
    /// Commands waiting for the whole cycles of the delay, oldest first.
    waiting: VecDeque<Velocity>,
    /// Rest of the delay as a fraction of a cycle. Each command takes effect from this fraction of
    /// a cycle until the same fraction of the next.
    late: f64,
    /// Velocity at the end of the effect of the last command that has one.
    reached: Velocity,
}

impl Actuation {
    /// Returns the motors, or `None` if they are exact and without delay. The robot's known delay
    /// and the disturbing delay add up.
    pub(in crate::sim) fn new(
        noise: ActuationNoise,
        source: Source,
        robot: &Robot,
    ) -> Option<Self> {
        let cycle_s = robot.cycle_s;
        let delay_s = robot.actuation_delay_s + noise.delay_s;
        let CycleCount { whole, part: late, .. } = CycleCount::of(delay_s, cycle_s);
        let actuation = Self {
            noise,
            cycle_s,
            v: Gaussian::new(source, Kind::DrivenV),
            omega: Gaussian::new(source, Kind::DrivenOmega),
            waiting: VecDeque::from(vec![Velocity::ZERO; whole]),
            late,
            reached: Velocity::ZERO,
        };
        (delay_s > 0.0 || !noise.is_none()).then_some(actuation)
    }

    /// True if a standing robot stays where it is: no command that moves it is pending.
    pub(in crate::sim) fn is_at_rest(&self) -> bool {
        let mut all = self.waiting.iter().chain([&self.reached]);
        all.all(|velocity| *velocity == Velocity::ZERO)
    }

    /// Motion of the next cycle for the command given at its beginning.
    pub(in crate::sim) fn motion(
        &mut self,
        pose: Pose,
        velocity: Velocity,
        command: Velocity,
        limits: &Limits,
    ) -> CycleMotion {
        let cycle_s = self.cycle_s;
        let disturbed = self.disturbed(command);
        self.waiting.push_back(disturbed);
        let effective = self.waiting.pop_front().unwrap_or(disturbed);
        let is_whole = self.late == 0.0;
        let before = if is_whole { velocity } else { self.reached };
        self.reached = limits.reached(before, effective, cycle_s);
        if is_whole {
            return CycleMotion::new(pose, velocity, self.reached, cycle_s);
        }
        let knee = Knee { place: self.late * CycleMotion::END, velocity: before };
        let to = before.lerp(self.reached, 1.0 - self.late);
        CycleMotion::with_knee(pose, velocity, knee, to, cycle_s)
    }

    fn disturbed(&mut self, command: Velocity) -> Velocity {
        let ActuationNoise { v_relative, omega_relative, .. } = self.noise;
        Velocity::new(
            command.v * (1.0 + v_relative * self.v.next_cut()),
            command.omega * (1.0 + omega_relative * self.omega.next_cut()),
        )
    }
}
