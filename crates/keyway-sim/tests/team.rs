//! Several robots in one world, each with its own stack.
#![allow(clippy::unwrap_used)]

use keyway::geometry::{Disc, Point, Pose};
use keyway::map::{Cell, CellState, GridFrame, OccupancyGrid};
use keyway::navigate::{NavigateError, Stack};
use keyway::robot::Robot;
use keyway_sim::episode::{
    Cycle, Episode, EpisodeObserver, EpisodeOutcome, EpisodeRobot, RobotReport, RunOptions,
    run_episode, watch_episode,
};
use keyway_sim::report::ContactPart;
use keyway_sim::sim::{Obstacle, StandingPolygon};
use std::f64::consts::FRAC_PI_2;

/// A hall of 8 m x 8 m, optionally with a wall across it at x = 4 m.
fn hall(has_wall: bool) -> OccupancyGrid {
    let frame = GridFrame::new(80, 80, 0.1, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        if has_wall && cell.x == 40 { CellState::Occupied } else { CellState::Free }
    })
}

fn robot(from: [f64; 2], to: [f64; 2]) -> EpisodeRobot {
    EpisodeRobot::new(Robot::small(), Point::from(from), Point::from(to))
}

#[test]
fn a_team_drives_the_same_on_any_number_of_threads() {
    let mut robots = vec![
        robot([1.0, 1.0], [7.0, 7.0]),
        robot([7.0, 1.0], [1.0, 7.0]),
        robot([1.0, 7.0], [7.0, 1.0]),
        robot([7.0, 7.0], [1.0, 1.0]),
        robot([4.0, 1.0], [4.0, 7.0]),
    ];
    // One robot has no route, and stays.
    robots.push(robot([4.0, 6.0], [4.0, 6.0]));
    let mut team = Episode::of_robots(hall(false), robots);
    team.rules.time_limit_s = Some(30.0);
    let alone = run_episode(&team).unwrap();
    for threads in [2, 3, 16] {
        let options = RunOptions { threads, ..RunOptions::default() };
        let report = watch_episode(&team, options, &mut [(); 0]).unwrap();
        assert_eq!(report, alone, "{threads} threads");
    }
}

#[derive(Default)]
struct Watched {
    index: usize,
    cycles: u64,
    first_x_m: Option<f64>,
}

impl EpisodeObserver for Watched {
    fn decided(&mut self, cycle: &Cycle<'_>) {
        self.cycles += 1;
        self.first_x_m.get_or_insert(cycle.observation.pose.x);
    }
}

#[test]
fn each_robot_has_its_own_stack_report_and_observer() {
    let mut second = robot([7.0, 6.0], [1.0, 6.0]);
    second.stack_name = "s0-key-point".to_owned();
    second.stack = Stack::by_name("s0-key-point", &second.robot).unwrap();
    let team = Episode::of_robots(hall(false), vec![robot([1.0, 2.0], [5.0, 2.0]), second]);
    let mut watched = [0, 1].map(|index| Watched { index, ..Watched::default() });
    let report = watch_episode(&team, RunOptions::default(), &mut watched).unwrap();
    assert_eq!(report.outcomes, [EpisodeOutcome::Reached; 2]);
    let runs: Vec<_> = report.robots.iter().map(|robot| robot.run.as_ref().unwrap()).collect();
    assert_eq!(report.makespan_s, Some(runs[1].time_s));
    assert!(runs[1].time_s > runs[0].time_s + 1.0);
    // 4 m from row to row, minus two radii of 0.18 m.
    let clearance_m = report.min_robot_clearance_m.unwrap();
    assert!((clearance_m - 3.64).abs() < 0.02, "{clearance_m}");
    for (index, (one, run)) in watched.iter().zip(runs).enumerate() {
        let expected_m = team.robots[index].start.position.x;
        assert_eq!((one.index, one.first_x_m), (index, Some(expected_m)));
        assert!(one.cycles >= run.cycles);
    }
    let stacks: Vec<_> = report.robots.iter().map(|robot| robot.inputs.stack.clone()).collect();
    assert_eq!(stacks, [Some(Stack::DEFAULT.to_owned()), Some("s0-key-point".to_owned())]);
    assert_eq!(run_episode(&team).unwrap(), report);
}

#[test]
fn a_robot_without_a_route_stands_in_the_way_of_the_others() {
    // On the route of the second robot, with the goal behind the wall.
    let robots = vec![robot([2.0, 4.0], [7.0, 4.0]), robot([2.0, 1.0], [2.0, 7.0])];
    let report = run_episode(&Episode::of_robots(hall(true), robots)).unwrap();
    assert_eq!(report.outcomes, [EpisodeOutcome::NoPath, EpisodeOutcome::Reached]);
    assert_eq!((report.makespan_s, &report.robots[0].run), (None, &None));
    let run = report.robots[1].run.as_ref().unwrap();
    assert!(run.length_m > 5.9, "{}", run.length_m);
    let clearance_m = report.min_robot_clearance_m.unwrap();
    assert!(clearance_m > 0.0 && clearance_m < 0.5, "{clearance_m}");
    // If no robot has a route, nothing is driven.
    let none = vec![robot([2.0, 4.0], [7.0, 4.0]), robot([2.0, 4.1], [7.0, 1.0])];
    let report = run_episode(&Episode::of_robots(hall(true), none)).unwrap();
    assert_eq!(report.outcomes, [EpisodeOutcome::NoPath; 2]);
    assert_eq!(report.min_robot_clearance_m, None);
}

#[test]
fn contacts_name_the_other_robot() {
    let robots = vec![robot([2.0, 4.0], [7.0, 4.0]), robot([2.0, 4.3], [7.0, 1.0])];
    let report = run_episode(&Episode::of_robots(hall(false), robots)).unwrap();
    assert_eq!(report.outcomes, [EpisodeOutcome::Collided; 2]);
    assert_eq!(report.min_robot_clearance_m, Some(0.0));
    for (robot, other) in report.robots.iter().zip([1, 0]) {
        let ContactPart { with, t_s, .. } = robot.run.as_ref().unwrap().contact.unwrap();
        assert_eq!((with, t_s), (Obstacle::Robot(other), 0.0));
        let reason = robot.reason.as_ref().unwrap();
        assert!(reason.starts_with(&format!("touched robot {other} at ")), "{reason}");
    }
}

#[test]
fn what_no_map_shows_is_in_the_way_of_every_robot() {
    let robots = vec![robot([2.0, 2.0], [7.0, 2.0]), robot([2.0, 6.0], [7.0, 6.0])];
    let mut team = Episode::of_robots(hall(false), robots);
    let around = |x: f64, y: f64| {
        let corners = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]];
        let corners = corners.map(|[dx, dy]| Point::new(x + dx, y + dy)).to_vec();
        StandingPolygon::new(corners).unwrap()
    };
    team.polygons = vec![around(2.0, 2.0)];
    team.hidden_cells = vec![Cell::new(20, 60)];
    let report = run_episode(&team).unwrap();
    let with = |index: usize| {
        let robot: &RobotReport = &report.robots[index];
        assert_eq!(robot.inputs.polygons, team.polygons);
        assert_eq!(robot.inputs.hidden_cells, team.hidden_cells);
        robot.run.as_ref().unwrap().contact.unwrap().with
    };
    assert_eq!([with(0), with(1)], [Obstacle::Polygon(0), Obstacle::HiddenSquare]);
    let reason = |index: usize| report.robots[index].reason.clone().unwrap();
    assert!(reason(0).starts_with("touched unknown polygon 0 at "), "{}", reason(0));
    assert!(reason(1).starts_with("touched an unknown cell at "), "{}", reason(1));
    team.hidden_cells.push(Cell::new(80, 0));
    assert_eq!(run_episode(&team).unwrap_err().robot, None);
}

/// Two robots that are not round meet in a lane around a corner, in which they cannot pass. While
/// a robot turns, a corner of it sticks out of the disc that the other one estimates.
#[test]
fn who_turns_beside_another_does_not_touch_it() {
    let frame = GridFrame::new(140, 140, 0.05, Pose::default()).unwrap();
    let map = OccupancyGrid::from_fn(frame, |Cell { x, y }| {
        let is_room = (4..32).contains(&x) && (4..48).contains(&y)
            || (80..120).contains(&x) && (108..136).contains(&y);
        let is_lane = (4..100).contains(&x) && (20..32).contains(&y)
            || (88..100).contains(&x) && (20..108).contains(&y);
        if is_room || is_lane { CellState::Free } else { CellState::Occupied }
    });
    let ends = [Point::new(0.9, 1.3), Point::new(4.7, 6.2)];
    let robot = |from: usize, heading_rad: f64| {
        let mut robot = EpisodeRobot::new(Robot::waffle(), ends[from], ends[1 - from]);
        robot.start.heading_rad = Some(heading_rad);
        robot
    };
    let robots = vec![robot(0, 0.0), robot(1, -FRAC_PI_2)];
    let mut team = Episode::of_robots(map, robots);
    team.rules.time_limit_s = Some(60.0);
    for report in run_episode(&team).unwrap().robots {
        assert_ne!(report.outcome, EpisodeOutcome::Collided, "{:?}", report.reason);
    }
}

#[test]
fn who_waits_has_as_much_time_as_the_longest_way_takes() {
    let limits_s = |robots: Vec<EpisodeRobot>| {
        let report = run_episode(&Episode::of_robots(hall(false), robots)).unwrap();
        let limit_s = |robot: &RobotReport| robot.inputs.time_limit_s.unwrap();
        report.robots.iter().map(limit_s).collect::<Vec<_>>()
    };
    let (short, long) = (robot([1.0, 1.0], [2.0, 1.0]), robot([1.0, 6.0], [6.0, 6.0]));
    let alone_s = limits_s(vec![long.clone()])[0];
    assert!(alone_s > limits_s(vec![short.clone()])[0] + 30.0);
    assert_eq!(limits_s(vec![short, long]), [alone_s; 2]);
}

#[test]
fn what_cannot_be_driven_is_refused_with_the_robot() {
    let error = |robots| run_episode(&Episode::of_robots(hall(true), robots)).unwrap_err();
    let free = robot([1.0, 1.0], [2.0, 1.0]);
    assert_eq!(error(vec![]).to_string(), "robots must be one or more, got none");
    let mut slow = free.clone();
    slow.robot.cycle_s *= 2.0;
    let cycles = error(vec![free.clone(), slow]);
    assert_eq!(
        (cycles.robot, cycles.to_string().as_str()),
        (Some(1), "robot 1: robot.cycle_s must be 0.1, the cycle of robot 0, got 0.2")
    );
    let in_the_wall = error(vec![free.clone(), robot([4.05, 1.0], [2.0, 1.0])]);
    assert_eq!(in_the_wall.robot, Some(1));
    let is_no_room = matches!(
        in_the_wall.why,
        keyway_sim::episode::RunError::Navigate(NavigateError::NoRoom { .. })
    );
    assert!(is_no_room, "{in_the_wall}");
    let mut team = Episode::of_robots(hall(false), vec![free]);
    team.obstacles = vec![Disc::new(Point::new(1.0, 1.0), -1.0)];
    assert_eq!(run_episode(&team).unwrap_err().robot, None);
}
