//! Commands that were given and have no effect yet.

use crate::geometry::{Pose, Velocity};
use crate::robot::{CycleCount, Limits, Robot};
use std::collections::VecDeque;

/// The commands that are on their way to the motors, for a robot with a known delay
/// ([`Robot::actuation_delay_s`]).
///
/// What a robot does before its next command acts is decided already. So that command is chosen for
/// the pose and the velocity which the robot then has: those that follow from the present ones by
/// the commands under way, each for a cycle, in which the velocity changes linearly as far as the
/// limits allow. Without noise this is exactly what happens, and the robot drives as it would
/// without a delay, only that much later.
#[derive(Clone, Debug)]
pub(super) struct UnderWay {
    limits: Limits,
    cycle_s: f64,
    /// How many commands at most: those of the whole cycles of the delay, and one for the rest.
    most: usize,
    /// What is left of the effect of the oldest one \[s\]; a whole cycle where the delay is one of
    /// whole cycles.
    oldest_s: f64,
    /// The oldest first.
    commands: VecDeque<Velocity>,
}

impl UnderWay {
    pub(super) fn new(robot: &Robot) -> Self {
        let Robot { ref limits, cycle_s, actuation_delay_s, .. } = *robot;
        let CycleCount { whole, part: rest, .. } = CycleCount::of(actuation_delay_s, cycle_s);
        let is_whole = rest == 0.0;
        Self {
            limits: limits.clone(),
            cycle_s,
            most: if is_whole { whole } else { whole + 1 },
            oldest_s: if is_whole { cycle_s } else { rest * cycle_s },
            commands: VecDeque::new(),
        }
    }

    /// Pose and velocity at the instant at which the next command acts. Before the first one, the
    /// robot has been told to go on as it does.
    pub(super) fn predicted(&mut self, pose: Pose, velocity: Velocity) -> (Pose, Velocity) {
        while self.commands.len() < self.most {
            self.commands.push_front(velocity);
        }
        let (mut pose, mut velocity, mut duration_s) = (pose, velocity, self.oldest_s);
        for &command in &self.commands {
            let reached = self.limits.reached(velocity, command, duration_s);
            pose = pose.after_ramp(velocity, reached, duration_s);
            (velocity, duration_s) = (reached, self.cycle_s);
        }
        (pose, velocity)
    }

    /// Notes the command of this cycle.
    pub(super) fn give(&mut self, command: Velocity) {
        self.commands.push_back(command);
        while self.commands.len() > self.most {
            self.commands.pop_front();
        }
    }

    /// Whether a robot stands, and no command under way moves it.
    pub(super) fn is_at_rest(&self, robot: &Robot, velocity: Velocity) -> bool {
        self.commands.iter().chain([&velocity]).all(|velocity| robot.stands(*velocity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A robot whose commands act late, each for a cycle; some are beyond its limits.
    struct LateRobot {
        robot: Robot,
        /// The delay in whole cycles, and the rest of it as a part of one.
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

        /// State `cycles` and a part of one after the first command has begun to act.
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

        /// State that it is told when it is to give a command.
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
            let mut under_way = UnderWay::new(&late.robot);
            // A ramp in two parts is integrated differently, by a few micrometres.
            let off_m = if part == 0.0 { 1e-9 } else { 1e-5 };
            for (cycle, &command) in late.commands.iter().enumerate() {
                let (pose, velocity) = late.told(cycle);
                let (pose, velocity) = under_way.predicted(pose, velocity);
                let (at, reached) = late.after(cycle, 0.0);
                assert!(
                    pose.point().distance(at.point()) < off_m,
                    "{name} {cycle}: {pose:?} {at:?}"
                );
                assert!((pose.theta - at.theta).abs() < 1e-9, "{name} {cycle}: {pose:?} {at:?}");
                assert!((velocity.v - reached.v).abs() < 1e-9, "{name} {cycle}");
                assert!((velocity.omega - reached.omega).abs() < 1e-9, "{name} {cycle}");
                under_way.give(command);
            }
        }
    }
}
