//! The reason of a contact names a problem only if it was shortly before.
#![allow(clippy::unwrap_used)]

use keyway::geometry::{Disc, Point, Pose, Velocity};
use keyway::local::{Decision, DriveMemory, Evaluation, LocalPlanner, NoCommand, Scene, Scratch};
use keyway::map::{CellState, GridFrame, OccupancyGrid};
use keyway::navigate::FittedStack;
use keyway::robot::Robot;
use keyway_sim::episode::{Episode, EpisodeOutcome, RunOptions, watch_episode};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Drives straight ahead into anything, and finds no command in one cycle.
#[derive(Debug)]
struct Blind {
    robot: Robot,
    cycles: AtomicU32,
    blocked_in: u32,
}

impl LocalPlanner for Blind {
    fn decide(
        &self,
        scene: &Scene<'_>,
        _: &mut DriveMemory,
        _: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        if self.cycles.fetch_add(1, Ordering::Relaxed) == self.blocked_in {
            let evaluation = Evaluation::default();
            return Err(NoCommand { evaluation, fallback: scene.velocity });
        }
        let limits = &self.robot.limits;
        let wanted = Velocity::new(limits.v_max_mps, 0.0);
        let command = limits.reached(scene.velocity, wanted, self.robot.cycle_s);
        Ok(Decision { command, evaluation: Evaluation::default() })
    }
}

#[test]
fn an_old_problem_is_no_part_of_it() {
    let reason = |blocked_in| {
        let frame = GridFrame::new(160, 80, 0.05, Pose::default()).unwrap();
        let map = OccupancyGrid::from_fn(frame, |_| CellState::Free);
        let robot = Robot::small();
        let (start, goal) = (Point::new(1.0, 2.0), Point::new(7.0, 2.0));
        let mut episode = Episode::new(map, robot.clone(), start, goal);
        episode.obstacles = vec![Disc::new(Point::new(4.0, 2.0), 0.3)];
        episode.robots[0].stack.controller.watch_route = false;
        episode.robots[0].stack.controller.recoveries = vec![].into();
        let blind = Arc::new(Blind { robot, cycles: AtomicU32::new(0), blocked_in });
        let exchange = |_, stack: FittedStack| stack.with_local(blind.clone());
        let options = RunOptions { exchange: Some(&exchange), ..RunOptions::default() };
        let report = watch_episode(&episode, options, &mut [(); 0]).unwrap().first();
        assert_eq!(report.outcome, EpisodeOutcome::Collided);
        (report.reason.unwrap(), report.run.unwrap().cycles as u32)
    };
    let (without, cycles) = reason(u32::MAX);
    assert!(!without.contains("the last problem"), "{without}");
    let (early, _) = reason(2);
    assert!(!early.contains("the last problem"), "{early}");
    let (late, _) = reason(cycles - 2);
    assert!(late.contains("; the last problem: "), "{late}");
}
