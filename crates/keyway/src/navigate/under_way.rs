//! Commands that were given and have no effect yet.

use crate::geometry::{Pose, Velocity};
use crate::robot::{Limits, Robot, in_cycles};
use std::collections::VecDeque;

/// The commands that are on their way to the motors, for a robot with a known delay
/// ([`Robot::actuation_delay_s`]).
///
/// What a robot does before its next command acts is decided already. So that command is chosen for the pose and the velocity
/// which the robot then has: those that follow from the present ones by the commands under way, each for a cycle, in which
/// the velocity changes linearly as far as the limits allow. Without noise this is exactly what happens, and the robot
/// drives as it would without a delay, only that much later.
#[derive(Clone, Debug)]
pub(super) struct UnderWay {
    limits: Limits,
    cycle_s: f64,
    /// How many commands at most: those of the whole cycles of the delay, and one for the rest.
    most: usize,
    /// What is left of the effect of the oldest one \[s\]; a whole cycle where the delay is one of whole cycles.
    oldest_s: f64,
    /// The oldest first.
    commands: VecDeque<Velocity>,
}

impl UnderWay {
    pub(super) fn new(robot: &Robot) -> Self {
        let Robot { ref limits, cycle_s, actuation_delay_s, .. } = *robot;
        let (whole, rest) = in_cycles(actuation_delay_s, cycle_s);
        let is_whole = rest == 0.0;
        Self {
            limits: limits.clone(),
            cycle_s,
            most: if is_whole { whole } else { whole + 1 },
            oldest_s: if is_whole { cycle_s } else { rest * cycle_s },
            commands: VecDeque::new(),
        }
    }

    /// Pose and velocity at the instant at which the next command acts. Before the first one, the robot has been told to go
    /// on as it does.
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
    use crate::geometry::Point;
    use crate::map::OccupancyGrid;
    use crate::sim::{Action, Control, Participant, RunRules, World, simulate};

    /// What is predicted in each cycle, against where the simulated robot then is. Its commands are beyond its limits now and then.
    #[test]
    fn the_robot_comes_to_where_it_was_predicted() {
        let rows = vec![".".repeat(40); 40];
        let map = OccupancyGrid::from_ascii(&rows.iter().map(String::as_str).collect::<Vec<_>>());
        let world = World::from_known(&map, vec![]).unwrap();
        for (delay_cycles, name) in
            [(0.0, "small"), (1.0, "small"), (3.0, "jackal"), (2.5, "small"), (0.3, "jackal")]
        {
            let mut robot = Robot::by_name(name).unwrap();
            robot.actuation_delay_s = delay_cycles * robot.cycle_s;
            let mut under_way = UnderWay::new(&robot);
            let (mut predictions, mut cycle) = (Vec::new(), 0.0);
            let mut decide = |pose: Pose, velocity: Velocity, _: &crate::sense::Scan| {
                predictions.push(under_way.predicted(pose, velocity));
                cycle += 1.0;
                let command = Velocity::new(
                    0.4 + 0.4 * f64::sin(0.37 * cycle),
                    2.0 * f64::sin(0.11 * cycle * cycle),
                );
                under_way.give(command);
                Control { action: Action::Drive(command), remaining_m: 0.0, route: 0 }
            };
            let participant = Participant {
                robot: &robot,
                start: Pose::new(20.0, 20.0, 0.3),
                goal: Point::new(1.0, 1.0),
                disturbances: crate::sim::Disturbances::default(),
                rules: RunRules { time_limit_s: 60.0 * robot.cycle_s, ..RunRules::default() },
                controller: &mut decide,
            };
            let run = simulate(&world, &mut [participant]).unwrap().swap_remove(0);
            assert!(run.samples.len() > 50);
            let whole = delay_cycles as usize;
            let part = delay_cycles - delay_cycles.floor();
            for (index, (pose, velocity)) in predictions.iter().enumerate().take(50) {
                let (before, after) = (run.samples[index + whole], run.samples[index + whole + 1]);
                if part == 0.0 {
                    assert!(pose.point().distance(before.pose.point()) < 1e-9, "{name} {index}");
                    assert!(
                        (velocity.v - before.velocity.v).abs() < 1e-9
                            && (velocity.omega - before.velocity.omega).abs() < 1e-9
                    );
                } else {
                    // Between two samples.
                    let way_m = before.pose.point().distance(after.pose.point()) + 1e-9;
                    let [from_m, to_m] =
                        [before, after].map(|sample| pose.point().distance(sample.pose.point()));
                    assert!(
                        from_m <= way_m && to_m <= way_m,
                        "{name} {index}: {pose:?} {before:?} {after:?}"
                    );
                }
            }
        }
    }
}
