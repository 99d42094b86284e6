//! Whole runs of robots among moving obstacles: they pass or wait, and continue.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

use keyway::geometry::{Disc, Point, Pose};
use keyway::map::{CellState, GridFrame, OccupancyGrid};
use keyway::robot::{Footprint, Robot};
use keyway_sim::episode::{
    Cycle, Episode, EpisodeObserver, EpisodeOutcome, EpisodeRobot, RobotReport, RunOptions, Start,
    run_episode, watch_episode,
};
use keyway_sim::sim::{KeyFrame, KeyFrames, MovingObstacle, ObstacleMotion, WayPoints};

/// An episode from (1, 3) to (9, 3) across a hall of 10 m x 6 m.
fn across(movers: Vec<MovingObstacle>) -> Episode {
    let frame = GridFrame::new(200, 120, 0.05, Pose::default()).unwrap();
    let map = OccupancyGrid::from_fn(frame, |cell| {
        let edge = cell.x.min(cell.y).min(199 - cell.x).min(119 - cell.y);
        if edge < 2 { CellState::Occupied } else { CellState::Free }
    });
    let start = Start { position: Point::new(1.0, 3.0), heading_rad: Some(0.0) };
    let goal = Point::new(9.0, 3.0);
    let episode = Episode::new(map, Robot::small(), start.position, goal);
    Episode { movers, ..episode }.with_each_robot(|robot| robot.start = start)
}

/// Adds the stop rule to a robot's stack.
fn guard(robot: &mut EpisodeRobot) {
    robot.stack = robot.stack.clone().with_stop_rule(&robot.robot);
}

fn walker(at: [f64; 2], velocity_mps: [f64; 2]) -> MovingObstacle {
    MovingObstacle::straight(at.into(), 0.25, velocity_mps.into()).unwrap()
}

/// Compares the moving obstacles that the robot estimates with the true ones.
struct Believed<'a> {
    movers: &'a [MovingObstacle],
    /// Cycles with an estimated moving obstacle.
    cycles: u32,
    /// Cells marked as static obstacles when all walkers were last in the hall.
    sensed: u64,
    /// Cycles in which the robot waited for a moving obstacle.
    waited: u32,
}

impl EpisodeObserver for Believed<'_> {
    fn decided(&mut self, cycle: &Cycle<'_>) {
        let believed = cycle.navigator.movers();
        self.cycles += u32::from(!believed.is_empty());
        for mover in believed.iter().filter(|mover| mover.unseen_s == 0.0) {
            let off_m = |truth: &MovingObstacle| truth.at(cycle.t_s).centre.distance(mover.centre);
            let off_m = self.movers.iter().map(off_m).fold(f64::INFINITY, f64::min);
            assert!(off_m <= mover.position_uncertainty_m + 1e-6, "{off_m} {mover:?}");
        }
        // A pedestrian who walks through a wall is half hidden in it.
        let is_in_hall =
            |mover: &MovingObstacle| (0.4..5.6).contains(&mover.at(cycle.t_s).centre.y);
        if self.movers.iter().all(is_in_hall) {
            self.sensed = cycle.navigator.sensed().count_ones();
        }
        self.waited += u32::from(cycle.navigator.evaluation().waits_for_mover());
    }
}

struct Seen {
    report: RobotReport,
    cycles: u32,
    sensed: u64,
    waited: u32,
}

fn watched(episode: &Episode) -> Seen {
    let mut believed = Believed { movers: &episode.movers, cycles: 0, sensed: 0, waited: 0 };
    let report = watch_episode(episode, RunOptions::default(), std::slice::from_mut(&mut believed));
    let report = report.unwrap().first();
    let Believed { cycles, sensed, waited, .. } = believed;
    Seen { report, cycles, sensed, waited }
}

#[test]
fn who_crosses_comes_towards_or_goes_ahead_is_passed_or_waited_for() {
    let tofro = WayPoints::to_and_fro(vec![[5.0, 2.0].into(), [5.0, 4.0].into()], 0.4).unwrap();
    let cases = [
        ("crossing before it", vec![walker([4.0, 0.8], [0.0, 0.4])]),
        ("crossing where it comes", vec![walker([5.0, -0.4], [0.0, 0.4])]),
        ("ahead, slower", vec![walker([2.5, 3.02], [0.2, 0.0])]),
        ("oncoming, aside", vec![walker([9.0, 2.4], [-0.4, 0.0])]),
        ("two", vec![walker([4.0, 0.5], [0.0, 0.5]), walker([6.0, 5.5], [0.0, -0.4])]),
        ("to and fro", vec![MovingObstacle::new(0.25, ObstacleMotion::WayPoints(tofro)).unwrap()]),
    ];
    let mut all_waited = 0;
    for (name, movers) in cases {
        for is_safe in [false, true] {
            let mut episode = across(movers.clone());
            if is_safe {
                episode = episode.with_each_robot(guard);
            }
            let Seen { report, cycles, sensed, waited } = watched(&episode);
            let contact = report.run.as_ref().and_then(|run| run.contact.as_ref());
            if name == "to and fro"
                && contact.is_some_and(|contact| contact.robot_stood || !is_safe)
            {
                // The obstacle turns back into the waiting robot, or the robot passes without the
                // stop rule.
                continue;
            }
            assert_eq!(report.outcome, EpisodeOutcome::Reached, "{name}: {:?}", report.reason);
            let run = report.run.unwrap();
            assert!(run.min_mover_clearance_m.unwrap() > 0.02, "{name} {is_safe}");
            assert!(cycles > 20 && sensed == 0, "{name} {cycles} {sensed}");
            all_waited += waited;
            let changed = run.unsafe_commands;
            assert_eq!(changed.is_some(), is_safe);
            assert!(
                changed.is_none_or(|counts| counts.mover > 0 && counts.total() == counts.mover)
            );
        }
    }
    assert!(all_waited > 100, "{all_waited} cycles in which something that moved held it up");
}

/// A moving obstacle enters the route and stops: the robot first waits for it, then goes around
/// it as around any static obstacle.
#[test]
fn who_stops_in_the_way_is_gone_around() {
    let frame = |t_s: f64, x: f64, y: f64| KeyFrame { t_s, position: Point::new(x, y) };
    let frames = KeyFrames::new(vec![frame(0.0, 5.0, 0.8), frame(5.5, 5.0, 3.0)]).unwrap();
    let episode =
        across(vec![MovingObstacle::new(0.25, ObstacleMotion::KeyFrames(frames)).unwrap()]);
    let Seen { report, sensed, .. } = watched(&episode);
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    let run = report.run.unwrap();
    assert!(run.min_mover_clearance_m.unwrap() > 0.0 && sensed > 5, "{sensed}");
    assert!(run.length_m > 8.0 - 0.15 && run.time_s < 40.0, "{}", run.time_s);
}

/// The obstacles do not give way to the robot: if it cannot clear the path, it is stationary at
/// the contact.
#[test]
fn who_comes_straight_on_meets_a_robot_that_stands() {
    let Seen { report, .. } = watched(&across(vec![walker([9.5, 2.95], [-1.0, 0.0])]));
    if let Some(contact) = report.run.unwrap().contact {
        assert!(contact.robot_stood, "{contact:?}");
    }
}

/// Unmapped posts, and a pedestrian who emerges from behind one of them, slower than the stop
/// rule expects.
#[test]
fn who_comes_out_from_behind_a_post_meets_a_robot_that_stands() {
    let frame = GridFrame::new(80, 60, 0.05, Pose::default()).unwrap();
    let map = OccupancyGrid::from_fn(frame, |_| CellState::Free);
    let post = |x: f64, y: f64, radius_m: f64| Disc::new(Point::new(x, y), radius_m);
    let (mut driving, mut standing) = (0, 0);
    for case in 0..49u32 {
        let [x, speed_mps] = [2.49 + 0.01 * f64::from(case % 7), 0.55 + 0.02 * f64::from(case / 7)];
        let way = [1.5, 2.85, 0.15].map(|y| Point::new(x, y)).to_vec();
        let walker = ObstacleMotion::WayPoints(WayPoints::around(way, speed_mps).unwrap());
        let start = Point::new(0.5, 1.5);
        let mut episode = Episode {
            obstacles: vec![
                post(2.847, 1.584, 0.089),
                post(3.454, 2.301, 0.05),
                post(2.07, 1.664, 0.147),
                post(2.112, 2.149, 0.199),
            ],
            movers: vec![MovingObstacle::new(0.138, walker).unwrap()],
            ..Episode::new(map.clone(), Robot::small(), start, Point::new(3.5, 1.5))
        };
        episode = episode.with_each_robot(guard);
        if let Some(contact) = run_episode(&episode).unwrap().first().run.unwrap().contact {
            *(if contact.robot_stood { &mut standing } else { &mut driving }) += 1;
        }
    }
    assert!(driving == 0 && standing > 10, "{driving} {standing}");
}

/// A robot in a lane with a bay, and a pedestrian who comes along the lane, in cells of 5 cm: the
/// lane is given by its rows, the bay by its columns and rows.
fn in_a_lane(
    robot: Robot,
    (lane, bay): (std::ops::Range<i32>, [std::ops::Range<i32>; 2]),
    (radius_m, frames): (f64, &[(f64, f64)]),
) -> Episode {
    let y = 0.025 * f64::from(lane.start + lane.end);
    let frame = GridFrame::new(200, 68, 0.05, Pose::default()).unwrap();
    let map = OccupancyGrid::from_fn(frame, |cell| {
        let is_lane = (4..196).contains(&cell.x) && lane.contains(&cell.y);
        let is_free = is_lane || bay[0].contains(&cell.x) && bay[1].contains(&cell.y);
        if is_free { CellState::Free } else { CellState::Occupied }
    });
    let frame = |&(t_s, x): &(f64, f64)| KeyFrame { t_s, position: Point::new(x, y) };
    let motion =
        ObstacleMotion::KeyFrames(KeyFrames::new(frames.iter().map(frame).collect()).unwrap());
    let start = Start { position: Point::new(1.0, y), heading_rad: Some(0.0) };
    let mut episode = Episode::new(map, robot, start.position, Point::new(9.0, y));
    episode.movers = vec![MovingObstacle::new(radius_m, motion).unwrap()];
    episode.with_each_robot(|robot| robot.start = start)
}

/// The robot drives far enough into the bay for the pedestrian in the lane to pass.
#[test]
fn who_comes_along_a_lane_passes_a_robot_in_a_bay() {
    let bay = [88..108, 20..54];
    let frames = [(0.0, 9.0), (25.0, 1.4)];
    let report = run_episode(&in_a_lane(Robot::small(), (20..32, bay), (0.2, &frames)));
    let report = report.unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    assert!(report.run.unwrap().recoveries.make_way > 0);
}

/// Cells that were marked before the pedestrian was tracked do not keep the robot in the bay.
#[test]
fn a_robot_that_made_way_leaves_the_bay_again() {
    let robot = Robot::derived(Footprint::circle(0.27).unwrap(), 0.8);
    let bay = [88..108, 20..54];
    let frames = [(0.0, 9.0), (22.0, 1.0)];
    let report = run_episode(&in_a_lane(robot, (20..32, bay), (0.18, &frames))).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    assert!(report.run.unwrap().recoveries.make_way > 0);
}

/// A pedestrian in view has not passed, however long the robot has waited.
#[test]
fn who_stands_before_a_robot_in_a_bay_has_not_gone() {
    let bay = [88..108, 20..54];
    let frames = [(0.0, 9.0), (8.0, 6.0), (30.0, 6.0), (50.0, 0.5)];
    let episode = in_a_lane(Robot::small(), (20..32, bay), (0.2, &frames));
    let report = run_episode(&episode).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    assert!(report.run.unwrap().recoveries.make_way > 0);
}
