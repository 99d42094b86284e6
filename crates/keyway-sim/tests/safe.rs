//! The stop rule with every local planner, in whole runs: no contact with a static obstacle, and
//! none with a moving one while the robot moves. Motion is ideal, and there is no occlusion.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

use keyway::geometry::{Disc, Point, Pose};
use keyway::local::{
    AdaptiveDwaConfig, DwaConfig, GuidedDwaConfig, KeyPointDwaConfig, LocalConfig,
};
use keyway::map::{CellState, GridFrame, OccupancyGrid};
use keyway::navigate::Stack;
use keyway::robot::{Footprint, Limits, Robot};
use keyway_sim::episode::{Episode, EpisodeOutcome, RobotReport, Start, run_episode};
use keyway_sim::sim::{MovingObstacle, ObstacleMotion, WayPoints};
use proptest::prelude::*;

const WIDTH_M: f64 = 6.0;
const HEIGHT_M: f64 = 5.0;

/// A room of 6 m x 5 m in cells of 5 cm with walls around it, and blocks of 0.2 m.
fn room(blocks: &[(u32, u32)]) -> OccupancyGrid {
    let frame = GridFrame::new(120, 100, 0.05, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let edge = cell.x.min(cell.y).min(119 - cell.x).min(99 - cell.y);
        let holds = |&(x, y): &(u32, u32)| (cell.x as u32 / 4, cell.y as u32 / 4) == (x, y);
        let is_wall = edge < 2 || blocks.iter().any(holds);
        if is_wall { CellState::Occupied } else { CellState::Free }
    })
}

/// A robot whose sensor covers the whole room.
fn robot(is_long: bool, reverses: bool, actuation_delay_s: f64) -> Robot {
    let mut robot = Robot { actuation_delay_s, ..Robot::small() };
    robot.sensors[0].range_m = 10.0;
    robot.limits = Limits { v_min_mps: if reverses { -0.3 } else { 0.0 }, ..robot.limits };
    if is_long {
        robot.footprint = Footprint::rectangle(0.45, 0.25).unwrap();
    }
    robot
}

/// No delay, or any fraction of a few cycles \[s\].
fn delays() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), 0.0..0.4f64]
}

/// Every local planner, with the parameters for a robot and the published ones.
fn local(which: usize, robot: &Robot) -> LocalConfig {
    let names = LocalConfig::NAMES;
    match which.checked_sub(names.len()) {
        None => LocalConfig::by_name(names[which], robot).unwrap(),
        Some(0) => LocalConfig::Dwa(DwaConfig::PAPER),
        Some(1) => LocalConfig::KeyPointDwa(KeyPointDwaConfig::PAPER),
        Some(2) => LocalConfig::AdaptiveDwa(AdaptiveDwaConfig::PAPER),
        _ => LocalConfig::GuidedDwa(GuidedDwaConfig::PAPER),
    }
}

const LOCALS: usize = LocalConfig::NAMES.len() + 4;

/// Any local planner, and often the follower, which avoids nothing.
fn locals() -> impl Strategy<Value = usize> {
    let follower = LocalConfig::NAMES.iter().position(|name| *name == "follower").unwrap();
    prop_oneof![Just(follower), 0..LOCALS]
}

fn safe_episode(map: OccupancyGrid, robot: &Robot, which: usize, ends: [(f64, f64); 2]) -> Episode {
    let [start, goal] = ends.map(|(x, y)| Point::new(x, y));
    let mut episode = Episode::new(map, robot.clone(), start, goal);
    episode.robots[0].stack.local = local(which, robot);
    episode.robots[0].stack = episode.robots[0].stack.clone().with_stop_rule(robot);
    episode.rules.time_limit_s = Some(15.0);
    episode
}

fn ends() -> impl Strategy<Value = [(f64, f64); 2]> {
    let end = || (0.5..WIDTH_M - 0.5, 0.5..HEIGHT_M - 0.5);
    [end().boxed(), end().boxed()].prop_filter("apart", |[a, b]| (a.0 - b.0).hypot(a.1 - b.1) > 1.5)
}

/// Runs an episode; `None` if it cannot be driven.
fn driven(episode: &Episode) -> Option<RobotReport> {
    // A start or goal without clearance is refused.
    let report = run_episode(episode).ok()?.first();
    (report.run.as_ref()?.cycles > 0).then_some(report)
}

/// Between two blocks 1.2 m apart, past an unmapped disc: every planner keeps the margin.
#[test]
fn the_safety_margin_of_a_robot_is_kept() {
    let clearance_m = |safety_margin_m, stack: &str| {
        let robot = Robot { safety_margin_m, ..robot(false, false, 0.0) };
        let map = room(&[(14, 9), (14, 16)]);
        let mut episode =
            Episode::new(map, robot.clone(), Point::new(1.0, 2.6), Point::new(5.0, 2.6));
        episode.robots[0].stack = Stack::by_name(stack, &robot).unwrap();
        episode.obstacles = vec![Disc::new(Point::new(4.0, 2.6), 0.1)];
        let report = run_episode(&episode).unwrap().first();
        assert_eq!(report.outcome, EpisodeOutcome::Reached, "{stack} {safety_margin_m:?}");
        report.run.unwrap().min_clearance_m.unwrap()
    };
    for stack in ["keyway", "key-point-fusion", "s1-ref14"] {
        assert!(clearance_m(None, stack) < 0.15, "{stack}");
        let kept_m = clearance_m(Some(0.15), stack);
        assert!(kept_m > 0.15 - 1e-6, "{stack}: {kept_m}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, max_global_rejects: 4096, ..ProptestConfig::default() })]

    #[test]
    fn nothing_that_stands_is_touched(
        which in locals(), is_long: bool, reverses: bool, delay_s in delays(), ends in ends(), yaw_deg in -180.0..180.0f64,
        blocks in prop::collection::vec((1u32..29, 1u32..24), 0..10),
        on_way in (0.2..0.8f64, 0.1..0.3f64), watches: bool,
        discs in prop::collection::vec((0.5..WIDTH_M - 0.5, 0.5..HEIGHT_M - 0.5, 0.1..0.3f64), 0..5),
    ) {
        let mut episode = safe_episode(room(&blocks), &robot(is_long, reverses, delay_s), which, ends);
        episode.robots[0].start = Start { heading_rad: Some(yaw_deg.to_radians()), ..episode.robots[0].start };
        let disc = |(x, y, radius_m)| Disc::new(Point::new(x, y), radius_m);
        episode.obstacles = discs.into_iter().map(disc).collect();
        let between = episode.robots[0].start.position.lerp(episode.robots[0].goal.position, on_way.0);
        episode.obstacles.push(Disc::new(between, on_way.1));
        // Without this the stack replans around sensed obstacles.
        episode.robots[0].stack.controller.watch_route = watches;
        let Some(report) = driven(&episode) else { return Err(TestCaseError::reject("no room")) };
        prop_assert_ne!(report.outcome, EpisodeOutcome::Collided, "{:?}", report.reason);
    }

    /// Moving obstacles of at most the speed of the rule, on any path, with instant turns. They
    /// may run into a stationary robot. They start far away, because tracking takes some scans.
    #[test]
    fn no_mover_is_touched_by_a_robot_that_moves(
        which in locals(), is_long: bool, delay_s in delays(), ends in ends(),
        ways in prop::collection::vec((prop::collection::vec((0.4..WIDTH_M - 0.4, 0.4..HEIGHT_M - 0.4), 2..5), 0.1..1.0f64, 0.15..0.35f64), 1..4),
    ) {
        let mut episode = safe_episode(room(&[]), &robot(is_long, false, delay_s), which, ends);
        let mover = |(points, speed_mps, radius_m): &(Vec<(f64, f64)>, f64, f64)| {
            let points = points.iter().map(|&(x, y)| Point::new(x, y)).collect();
            MovingObstacle::new(*radius_m, ObstacleMotion::WayPoints(WayPoints::to_and_fro(points, *speed_mps).ok()?)).ok()
        };
        let movers: Option<Vec<MovingObstacle>> = ways.iter().map(mover).collect();
        let Some(movers) = movers else { return Err(TestCaseError::reject("no way")) };
        let start = episode.robots[0].start.position;
        prop_assume!(movers.iter().all(|mover| mover.at(0.0).centre.distance(start) > 2.5));
        episode.movers = movers;
        let Some(report) = driven(&episode) else { return Err(TestCaseError::reject("no room")) };
        let contact = report.run.as_ref().unwrap().contact;
        // The area covered by a disc that turns on the spot does not change.
        let [.., v, _] = *report.trajectory.as_ref().unwrap().last().unwrap();
        let is_still = |stood: bool| stood || (!is_long && v == 0.0);
        prop_assert!(contact.is_none_or(|contact| is_still(contact.robot_stood)), "{:?}", report.reason);
    }
}
