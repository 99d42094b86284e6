//! Commands in flight: given, but without effect yet.

use crate::geometry::{Pose, Velocity};
use crate::navigate::time::Time;
use crate::robot::{Limits, Robot};
use std::collections::VecDeque;

/// The latest commands, which take effect after a delay.
///
/// The motion of a robot until its next command takes effect is already determined. That command
/// is therefore chosen for the pose and the velocity that the robot then has. They are predicted
/// from the last observed ones by the commands in flight, each until the next one takes effect;
/// the velocity changes linearly within the limits. Without noise the prediction is exact, and
/// the robot drives as it would without a delay, only that much later.
#[derive(Clone, Debug)]
pub(super) struct UnderWay {
    limits: Limits,
    cycle_s: f64,
    /// Longest delay to be predicted \[s\].
    longest_s: f64,
    most: usize,
    /// Speed and turn rate that do not move the robot.
    pub(super) too_small: Velocity,
    /// Commands with the times at which they were given, the oldest first.
    commands: VecDeque<(Time, Velocity)>,
}

impl UnderWay {
    /// Number of commands that are kept beyond those within the delay.
    const MORE: usize = 256;

    pub(super) fn new(robot: &Robot, longest_s: f64) -> Self {
        let Robot { ref limits, cycle_s, .. } = *robot;
        let most = (longest_s / cycle_s).ceil() as usize + Self::MORE;
        let commands = VecDeque::with_capacity(most);
        let (limits, too_small) = (limits.clone(), Velocity::ZERO);
        Self { limits, cycle_s, longest_s, most, too_small, commands }
    }

    /// Predicts the pose and the velocity at the instant at which a command given at `now` takes
    /// effect, for a robot that was observed at `observed`. Before the first command, the robot
    /// is assumed to keep its velocity.
    pub(super) fn predicted(
        &self,
        (observed, now): (Time, Time),
        delay_s: f64,
        (mut pose, mut velocity): (Pose, Velocity),
    ) -> (Pose, Velocity) {
        for (command, duration_s) in self.acting(observed, now.after_s(delay_s), delay_s) {
            let command = command.unwrap_or(velocity);
            let mut left_s = duration_s;
            while left_s > 0.0 {
                let part_s = if left_s < 1.5 * self.cycle_s { left_s } else { self.cycle_s };
                let reached = self.limits.reached(velocity, command, part_s);
                pose = pose.after_ramp(velocity, reached, part_s);
                (velocity, left_s) = (reached, left_s - part_s);
            }
        }
        (pose, velocity)
    }

    /// The velocity of a robot at the second of two times, given that at the first. Before the
    /// first command, the robot is assumed to be commanded to stop.
    pub(super) fn velocity_after(
        &self,
        (from, to): (Time, Time),
        delay_s: f64,
        velocity: Velocity,
    ) -> Velocity {
        self.acting(from, to, delay_s).fold(velocity, |velocity, (command, duration_s)| {
            self.limits.reached(velocity, command.unwrap_or(Velocity::ZERO), duration_s)
        })
    }

    /// Full speed and full turn rate.
    pub(super) fn full(&self) -> Velocity {
        let Limits { v_max_mps, v_min_mps, omega_max_radps, .. } = self.limits;
        Velocity::new(v_max_mps.max(-v_min_mps), omega_max_radps)
    }

    /// Records a command that is given now, and drops those whose effect is long past. Allocates
    /// nothing.
    pub(super) fn give(&mut self, observed: Time, now: Time, command: Velocity) {
        while self.commands.back().is_some_and(|last| last.0 >= now) {
            self.commands.pop_back();
        }
        let acted = observed.after_s(-self.longest_s);
        while self.commands.get(1).is_some_and(|second| second.0 <= acted)
            || self.commands.len() >= self.most
        {
            self.commands.pop_front();
        }
        self.commands.push_back((now, command));
    }

    /// The command in effect at a time; `None` before the first.
    pub(super) fn acts_at(&self, time: Time, delay_s: f64) -> Option<Velocity> {
        let given = time.after_s(-delay_s);
        let begun = self.commands.partition_point(|command| command.0 <= given);
        Some(self.commands.get(begun.checked_sub(1)?)?.1)
    }

    /// The commands with the times at which they were given.
    pub(super) fn commands(&self) -> Vec<(Time, Velocity)> {
        self.commands.iter().copied().collect()
    }

    /// Restores commands.
    pub(super) fn take_up(&mut self, commands: &[(Time, Velocity)]) {
        self.commands.clear();
        self.commands.extend(commands.iter().take(self.most));
    }

    /// Forgets all commands.
    pub(super) fn clear(&mut self) {
        self.commands.clear();
    }

    /// True if a robot is stationary, and no command in flight moves it.
    pub(super) fn is_at_rest(
        &self,
        (observed, now): (Time, Time),
        delay_s: f64,
        (robot, velocity): (&Robot, Velocity),
    ) -> bool {
        let mut acting = self.acting(observed, now.after_s(delay_s), delay_s);
        robot.stands(velocity) && acting.all(|(it, _)| it.is_none_or(|it| robot.stands(it)))
    }

    /// The part of a command that moves the robot.
    fn done(&self, command: Velocity) -> Velocity {
        let beyond =
            |asked: f64, too_small: f64| if asked.abs() <= too_small { 0.0 } else { asked };
        let Velocity { v, omega } = self.too_small;
        Velocity::new(beyond(command.v, v), beyond(command.omega, omega))
    }

    /// The commands in effect between two times after a delay, each with its duration \[s\];
    /// `None` before the first.
    fn acting(
        &self,
        from: Time,
        to: Time,
        delay_s: f64,
    ) -> impl Iterator<Item = (Option<Velocity>, f64)> {
        let (from, to) = (from.after_s(-delay_s), to.after_s(-delay_s));
        let first = self.commands.partition_point(|command| command.0 <= from);
        let begins = move |index: usize| self.commands.get(index).map_or(to, |command| command.0);
        let spans = (first..=self.commands.len()).map(move |index| {
            let command = index.checked_sub(1).map(|before| self.commands[before]);
            let begun = command.map_or(from, |command| command.0.max(from));
            (command.map(|command| self.done(command.1)), begins(index).min(to).since_s(begun))
        });
        spans.take_while(|&(_, duration_s)| duration_s >= 0.0).filter(|&(_, it)| it > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A robot whose commands take effect late, each for one cycle; some exceed its limits.
    struct LateRobot {
        robot: Robot,
        /// The delay in whole cycles, and the remaining fraction of a cycle.
        delay: (usize, f64),
        commands: Vec<Velocity>,
    }

    impl LateRobot {
        fn new(name: &str, delay: (usize, f64)) -> Self {
            let mut robot = Robot::by_name(name).unwrap();
            robot.actuation_delay_s = (delay.0 as f64 + delay.1) * robot.cycle_s;
            let command = |cycle: i32| {
                let cycle = f64::from(cycle + 1);
                let v = 0.4 + 0.4 * libm::sin(0.37 * cycle);
                Velocity::new(v, 2.0 * libm::sin(0.11 * cycle * cycle))
            };
            Self { robot, delay, commands: (0..60).map(command).collect() }
        }

        /// State at `cycles` and a fraction of a cycle after the first command takes effect.
        fn after(&self, cycles: usize, part: f64) -> (Pose, Velocity) {
            let Robot { ref limits, cycle_s, .. } = self.robot;
            let (mut pose, mut velocity) = (Pose::new(20.0, 20.0, 0.3), Velocity::ZERO);
            for (cycle, &command) in self.commands.iter().enumerate().take(cycles + 1) {
                let part = if cycle == cycles { part } else { 1.0 };
                let reached = velocity.lerp(limits.reached(velocity, command, cycle_s), part);
                pose = pose.after_ramp(velocity, reached, part * cycle_s);
                velocity = reached;
            }
            (pose, velocity)
        }

        /// State that is observed when it is to give a command.
        fn told(&self, cycle: usize) -> (Pose, Velocity) {
            let (whole, part) = self.delay;
            match cycle.checked_sub(whole + usize::from(part > 0.0)) {
                Some(cycles) if part > 0.0 => self.after(cycles, 1.0 - part),
                Some(cycles) => self.after(cycles, 0.0),
                None => self.after(0, 0.0),
            }
        }
    }

    #[test]
    fn the_robot_comes_to_where_it_was_predicted() {
        let cases = [
            ("small", 0, 0.0),
            ("small", 1, 0.0),
            ("jackal", 3, 0.0),
            ("small", 2, 0.5),
            ("jackal", 0, 0.3),
        ];
        for (name, whole, part) in cases {
            let late = LateRobot::new(name, (whole, part));
            let delay_s = late.robot.actuation_delay_s;
            let mut under_way = UnderWay::new(&late.robot, delay_s);
            // A ramp in two parts is integrated differently, by a few micrometres.
            let off_m = if part == 0.0 { 1e-9 } else { 1e-5 };
            for (cycle, &command) in late.commands.iter().enumerate() {
                let now = Time::of_stamp(cycle as f64 * late.robot.cycle_s).unwrap();
                let (pose, velocity) = under_way.predicted((now, now), delay_s, late.told(cycle));
                let (at, reached) = late.after(cycle, 0.0);
                assert!(
                    pose.point().distance(at.point()) < off_m,
                    "{name} {cycle}: {pose:?} {at:?}"
                );
                assert!((pose.theta - at.theta).abs() < 1e-9, "{name} {cycle}: {pose:?} {at:?}");
                assert!((velocity.v - reached.v).abs() < 1e-9, "{name} {cycle}");
                assert!((velocity.omega - reached.omega).abs() < 1e-9, "{name} {cycle}");
                under_way.give(now, now, command);
            }
        }
    }
}
