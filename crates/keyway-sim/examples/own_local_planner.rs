//! A custom local planner in a whole simulated run: it turns towards the guide point, drives, and
//! ignores everything else. The stop rule checks its commands, so there is no contact.
//!
//! `cargo run --example own_local_planner`

use keyway::geometry::{Disc, Point, Velocity};
use keyway::local::{Decision, DriveMemory, Evaluation, LocalPlanner, NoCommand, Scene, Scratch};
use keyway::map::{CellState, GridFrame, OccupancyGrid};
use keyway::navigate::FittedStack;
use keyway::robot::Robot;
use keyway_sim::episode::{
    Episode, EpisodeOutcome, EpisodeRobot, RobotReport, RunOptions, watch_episode,
};
use std::error::Error;
use std::sync::Arc;

/// Turns towards the guide point, and drives faster the better it faces it.
#[derive(Debug)]
struct Bee {
    robot: Robot,
}

impl LocalPlanner for Bee {
    fn decide(
        &self,
        scene: &Scene<'_>,
        _: &mut DriveMemory,
        _: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        let limits = &self.robot.limits;
        let bearing_rad = scene.pose.bearing_to(scene.guide);
        let fastest = limits.omega_max_radps;
        let wanted = Velocity::new(
            limits.v_max_mps * bearing_rad.cos().max(0.0),
            (2.0 * bearing_rad).clamp(-fastest, fastest),
        );
        // The command is limited to velocities within reach of one cycle.
        let command = limits.reached(scene.velocity, wanted, self.robot.cycle_s);
        Ok(Decision { command, evaluation: Evaluation::default() })
    }
}

/// Runs through a hall of 8 m x 4 m with an unmapped disc in the middle of the path.
fn run(has_stop_rule: bool) -> Result<RobotReport, Box<dyn Error>> {
    let frame = GridFrame::new(160, 80, 0.05, keyway::geometry::Pose::default())?;
    let map = OccupancyGrid::from_fn(frame, |_| CellState::Free);
    let robot = Robot::small();
    let (start, goal) = (Point::new(1.0, 2.0), Point::new(7.0, 2.0));
    let mut episode = Episode::new(map, robot.clone(), start, goal);
    episode.obstacles = vec![Disc::new(Point::new(4.0, 2.1), 0.3)];
    // The stack does not replan around sensed obstacles: only the stop rule is left.
    let EpisodeRobot { stack, stack_name, .. } = &mut episode.robots[0];
    "bee".clone_into(stack_name);
    stack.controller.watch_route = false;
    stack.controller.recoveries = vec![].into();
    if has_stop_rule {
        *stack = stack.clone().with_stop_rule(&robot);
    }
    let bee = Arc::new(Bee { robot });
    let exchange = |_, stack: FittedStack| stack.with_local(bee.clone());
    let options = RunOptions { exchange: Some(&exchange), ..RunOptions::default() };
    Ok(watch_episode(&episode, options, &mut [(); 0])?.first())
}

fn main() -> Result<(), Box<dyn Error>> {
    for has_stop_rule in [false, true] {
        let report = run(has_stop_rule)?;
        let reason = report.reason.unwrap_or_default();
        println!("stop rule: {has_stop_rule}. {}: {reason}", report.outcome.name());
        let expected = if has_stop_rule { EpisodeOutcome::Stuck } else { EpisodeOutcome::Collided };
        assert_eq!(report.outcome, expected);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_runs() {
        super::main().unwrap();
    }
}
