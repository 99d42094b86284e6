//! A custom evaluation term (a critic in Nav2) for a dynamic window, in a simulated run: the
//! distance of a candidate from the route. The robot starts facing sideways, and returns to its
//! route sooner with the term than without.
//!
//! `cargo run --example own_evaluation_term`

use keyway::geometry::{Point, Pose, Velocity};
use keyway::local::{
    Decision, DriveMemory, DynamicWindow, Explanation, LocalPlanner, NoCommand, Rollout, Scene,
    Scratch, Term, TermValue, Weighing, WindowConfig,
};
use keyway::map::{CellState, GridFrame, OccupancyGrid};
use keyway::navigate::{FittedStack, Stack};
use keyway::robot::Robot;
use keyway_sim::episode::{Episode, EpisodeOutcome, RobotReport, RunOptions, Start, watch_episode};
use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// A dynamic window that prefers to stay near its route.
#[derive(Debug)]
struct NearRoute {
    window: DynamicWindow,
    weighing: Weighing<4>,
}

impl NearRoute {
    fn new(robot: &Robot, route_weight: f64) -> Result<Self, Box<dyn Error>> {
        let window = DynamicWindow::new(WindowConfig::for_robot(robot), robot.clone())?;
        let weighing = Weighing([
            Term::of("heading", 0.1),
            Term::of("distance", 0.05),
            Term::of("speed", 0.1),
            Term::cost("route", route_weight),
        ]);
        Ok(Self { window, weighing })
    }

    /// Values of all terms, in the order of the weighing.
    fn terms(scene: &Scene<'_>, velocity: Velocity, rollout: &Rollout) -> [TermValue; 4] {
        [
            TermValue::of(rollout.heading),
            TermValue::of(rollout.distance_m),
            TermValue::of(velocity.v.abs()),
            TermValue::of(Self::off_route_m(scene, rollout)),
        ]
    }

    /// The term: distance from the route to the end of a candidate \[m\].
    fn off_route_m(scene: &Scene<'_>, rollout: &Rollout) -> f64 {
        let at = rollout.judged.point();
        let distances = scene.path.segments().map(|segment| segment.distance_sq_to_point(at));
        distances.fold(f64::INFINITY, f64::min).sqrt()
    }
}

impl LocalPlanner for NearRoute {
    fn decide(
        &self,
        scene: &Scene<'_>,
        _: &mut DriveMemory,
        scratch: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        let terms = |velocity, rollout: &Rollout| Self::terms(scene, velocity, rollout);
        self.window.decide(scene, scratch, &self.weighing, terms)
    }

    fn explain(&self, scene: &Scene<'_>, _: &DriveMemory) -> Explanation {
        let terms = |velocity, rollout: &Rollout| Self::terms(scene, velocity, rollout);
        self.window.explain(scene, &self.weighing, terms)
    }
}

/// Runs through a hall of 8 m x 4 m, along its middle.
fn run(route_weight: f64) -> Result<RobotReport, Box<dyn Error>> {
    let frame = GridFrame::new(160, 80, 0.05, Pose::default())?;
    let map = OccupancyGrid::from_fn(frame, |_| CellState::Free);
    let robot = Robot::small();
    let mut episode = Episode::new(map, robot.clone(), Point::new(1.0, 2.0), Point::new(7.0, 2.0));
    episode.robots[0].start = Start { heading_rad: Some(FRAC_PI_2), ..episode.robots[0].start };
    episode.robots[0].stack = Stack::key_point_fusion(&robot);
    "near-route".clone_into(&mut episode.robots[0].stack_name);
    let planner = Arc::new(NearRoute::new(&robot, route_weight)?);
    let exchange = |_, stack: FittedStack| stack.with_local(planner.clone());
    let options = RunOptions { exchange: Some(&exchange), ..RunOptions::default() };
    Ok(watch_episode(&episode, options, &mut [(); 0])?.first())
}

/// Mean distance from the middle of the hall over all cycles \[m\].
fn mean_off_route_m(report: &RobotReport) -> f64 {
    let rows = report.trajectory.as_deref().unwrap_or_default();
    // A row is [t, x, y, theta, v, omega].
    let off_m = rows.iter().map(|[_, _, y, ..]| (y - 2.0).abs());
    off_m.sum::<f64>() / rows.len() as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut off_route_m = Vec::new();
    for route_weight in [0.0, 0.2] {
        let report = run(route_weight)?;
        assert_eq!(report.outcome, EpisodeOutcome::Reached);
        let mean_m = mean_off_route_m(&report);
        println!("weight {route_weight}: {mean_m:.3} m off the route on average");
        off_route_m.push(mean_m);
    }
    assert!(off_route_m[1] < 0.7 * off_route_m[0], "{off_route_m:?}");
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_runs() {
        super::main().unwrap();
    }
}
