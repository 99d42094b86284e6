//! Delayed and inexact execution of commands by the motors.

use super::gaussian::Gaussian;
use super::{ActuationFaults, Kind, Source};
use crate::sim::cycle_motion::{CycleMotion, Knee};
use keyway::geometry::{Pose, Velocity};
use keyway::robot::{CycleCount, Limits, Robot};
use std::collections::VecDeque;

/// Motors and wheels of a robot, with delay and errors.
///
/// A command passes through the dead band and the noise, then the delay, then the limits of
/// acceleration, then the lag; the resulting velocity of the wheels is reduced by slip.
#[derive(Clone, Debug)]
pub(in crate::sim) struct Actuation {
    faults: ActuationFaults,
    cycle_s: f64,
    v: Gaussian,
    omega: Gaussian,
    /// Commands that wait for the whole cycles of the delay, oldest first.
    waiting: VecDeque<Velocity>,
    /// Remaining delay as a fraction of a cycle. Each command takes effect from this fraction of
    /// a cycle until the same fraction of the next.
    late: f64,
    /// Velocity within the limits that the wheels follow, at the end of the effect of the last
    /// effective command.
    wanted: Velocity,
    /// Velocity of the wheels at that time.
    wheels: Velocity,
    /// Share of the wheels' lag that is made up in a cycle: 1 without lag.
    made_up: f64,
}

/// Speed below which wheels stop if their target is 0 \[m/s, rad/s\].
const CREEP: f64 = 1e-3;

impl Actuation {
    /// Returns the motors, or `None` if they are exact and without delay. The robot's known delay
    /// and the delay of the disturbance add up.
    pub(in crate::sim) fn new(
        faults: ActuationFaults,
        source: Source,
        robot: &Robot,
    ) -> Option<Self> {
        let cycle_s = robot.cycle_s;
        let delay_s = robot.actuation_delay_s + faults.delay_s;
        let is_exact = delay_s == 0.0 && faults.is_none();
        let CycleCount { whole, part: late, .. } = CycleCount::of(delay_s, cycle_s);
        let lag_s = faults.lag_s;
        let actuation = Self {
            faults,
            cycle_s,
            v: Gaussian::new(source, Kind::DrivenV),
            omega: Gaussian::new(source, Kind::DrivenOmega),
            waiting: VecDeque::from(vec![Velocity::ZERO; whole]),
            late,
            wanted: Velocity::ZERO,
            wheels: Velocity::ZERO,
            made_up: if lag_s > 0.0 { 1.0 - libm::exp(-cycle_s / lag_s) } else { 1.0 },
        };
        (!is_exact).then_some(actuation)
    }

    /// True if a stationary robot stays stationary: no pending command moves it.
    pub(in crate::sim) fn is_at_rest(&self) -> bool {
        let mut all = self.waiting.iter().chain([&self.wanted, &self.wheels]);
        all.all(|velocity| *velocity == Velocity::ZERO)
    }

    /// Wheel velocity that odometry measures for a robot with this true velocity.
    pub(in crate::sim) fn odometry(&self, velocity: Velocity) -> Velocity {
        let ActuationFaults { v_slip, omega_slip, .. } = self.faults;
        Velocity::new(velocity.v / (1.0 - v_slip), velocity.omega / (1.0 - omega_slip))
    }

    /// Returns the motion of the next cycle for the command issued at its beginning.
    pub(in crate::sim) fn motion(
        &mut self,
        pose: Pose,
        velocity: Velocity,
        command: Velocity,
        limits: &Limits,
    ) -> CycleMotion {
        let cycle_s = self.cycle_s;
        let disturbed = self.disturbed(self.beyond_dead_band(command));
        self.waiting.push_back(disturbed);
        let effective = self.waiting.pop_front().unwrap_or(disturbed);
        let before = self.wheels;
        self.wanted = limits.reached(self.wanted, effective, cycle_s);
        self.wheels = self.following();
        if self.late == 0.0 {
            return CycleMotion::new(pose, velocity, self.on_ground(self.wheels), cycle_s);
        }
        let at_knee = self.on_ground(before);
        let knee = Knee { place: self.late * CycleMotion::END, velocity: at_knee };
        let to = at_knee.lerp(self.on_ground(self.wheels), 1.0 - self.late);
        CycleMotion::with_knee(pose, velocity, knee, to, cycle_s)
    }

    /// Velocity of the wheels a cycle later.
    fn following(&self) -> Velocity {
        if self.made_up == 1.0 {
            return self.wanted;
        }
        let next = |wheels: f64, wanted: f64| {
            let next = wheels + self.made_up * (wanted - wheels);
            if wanted == 0.0 && next.abs() < CREEP { 0.0 } else { next }
        };
        let (wheels, wanted) = (self.wheels, self.wanted);
        Velocity::new(next(wheels.v, wanted.v), next(wheels.omega, wanted.omega))
    }

    /// True velocity of a robot with this wheel velocity.
    fn on_ground(&self, wheels: Velocity) -> Velocity {
        let ActuationFaults { v_slip, omega_slip, .. } = self.faults;
        Velocity::new(wheels.v * (1.0 - v_slip), wheels.omega * (1.0 - omega_slip))
    }

    fn beyond_dead_band(&self, command: Velocity) -> Velocity {
        let ActuationFaults { dead_band_mps, dead_band_radps, .. } = self.faults;
        let beyond = |value: f64, band: f64| if value.abs() < band { 0.0 } else { value };
        Velocity::new(beyond(command.v, dead_band_mps), beyond(command.omega, dead_band_radps))
    }

    fn disturbed(&mut self, command: Velocity) -> Velocity {
        let ActuationFaults { v_relative, omega_relative, .. } = self.faults;
        Velocity::new(
            command.v * (1.0 + v_relative * self.v.next_cut()),
            command.omega * (1.0 + omega_relative * self.omega.next_cut()),
        )
    }
}
