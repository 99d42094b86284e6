//! Start poses that are estimated closer to an obstacle than the robot can be.
#![allow(clippy::unwrap_used)]

#[path = "support/driving.rs"]
mod driving;

use driving::{bound_for, next_step};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::map::{CellState, GridFrame, OccupancyGrid};
use keyway::navigate::{NavigateError, Stack, Step};
use keyway::robot::{Footprint, Robot};
use keyway::sense::Scan;

/// Position of the wall's surface.
const WALL_M: f64 = 0.05;

/// Error of the pose estimate.
const TOLD_NEARER_M: f64 = 0.04;

/// A hall of 8 m x 4 m in cells of 0.05 m, with a wall along its lower side.
fn hall() -> OccupancyGrid {
    let frame = GridFrame::new(160, 80, 0.05, Pose::default()).unwrap();
    let state = |y| if y == 0 { CellState::Occupied } else { CellState::Free };
    OccupancyGrid::from_fn(frame, |cell| state(cell.y))
}

const GOAL: Point = Point::new(6.0, 2.0);

fn plate() -> Robot {
    Robot { footprint: Footprint::rectangle(0.5, 0.36).unwrap(), ..Robot::small() }
}

/// Every stack whose local planner senses the obstacles beside it.
fn stacks(robot: &Robot) -> Vec<(&'static str, Stack)> {
    let of_name = |name: &&'static str| Some((*name, Stack::by_name(name, robot)?));
    let all = Stack::NAMES.iter().filter_map(of_name);
    all.filter(|(_, stack)| stack.local.name() != "follower").collect()
}

/// The robot's scan of the wall, which is closer according to the estimate than it is.
fn scan_of_the_wall(robot: &Robot, told: Pose) -> Scan {
    let mut scan = Scan::of_nothing(&robot.sensors[0]);
    let to_wall_m = told.y - WALL_M + TOLD_NEARER_M;
    for beam in 0..scan.ranges_m.len() {
        let range_m = -to_wall_m / libm::sin(told.theta + scan.bearing_rad(beam));
        if (0.0..=robot.sensors[0].range_m).contains(&range_m) {
            scan.ranges_m[beam] = range_m;
        }
    }
    scan
}

/// The robot's pose after 60 s, and true if it has arrived.
fn drive(robot: &Robot, stack: &Stack, start: Pose, what: &str) -> (Pose, bool) {
    let mut navigator =
        bound_for(&hall(), &stack.fit(robot).unwrap(), start.point(), GOAL).unwrap();
    let lowest_m = |pose: Pose| match &robot.footprint {
        Footprint::Circle(circle) => pose.y - circle.radius_m(),
        Footprint::Polygon(polygon) => {
            let corners = polygon.vertices().iter().map(|&corner| pose.world_from_body(corner).y);
            corners.fold(f64::INFINITY, f64::min)
        }
    };
    let (mut pose, mut velocity) = (start, Velocity::ZERO);
    assert!(navigator.too_near().is_some(), "{what}");
    for _ in 0..600 {
        let scan = scan_of_the_wall(robot, pose);
        let command = match next_step(&mut navigator, pose, velocity, &scan) {
            Step::Arrived => return (pose, true),
            step => step.command(),
        };
        let reached = robot.limits.reached(velocity, command, robot.cycle_s);
        pose = pose.after_ramp(velocity, reached, robot.cycle_s);
        velocity = reached;
        // It leaves the obstacle and does not come closer.
        let deeper_m = lowest_m(start) - lowest_m(pose);
        assert!(deeper_m < 1e-3, "{what}: by {deeper_m} m at {pose:?}");
    }
    (pose, false)
}

/// Along the wall, 0.03 m closer than a robot can be.
const TOLD: Pose = Pose { x: 2.0, y: WALL_M + 0.18 - 0.03, theta: 0.0 };

#[test]
fn a_round_robot_leaves_a_wall_that_it_is_told_to_be_too_near_to() {
    let robot = Robot::small();
    for (name, stack) in stacks(&robot) {
        let (end, has_arrived) = drive(&robot, &stack, TOLD, name);
        assert!(has_arrived, "{name}: still at {end:?}");
    }
}

/// A rectangle that touches a wall according to its pose estimate cannot turn away without
/// bringing a corner closer, so it drives along the wall. With `keyway` it stays stationary, as it
/// does a centimetre beside a wall.
#[test]
fn the_stop_rule_lets_a_robot_go_along_what_it_is_told_to_touch() {
    for robot in [Robot::small(), plate()] {
        let is_round = matches!(robot.footprint, Footprint::Circle(_));
        for (name, stack) in stacks(&robot) {
            let what = format!("{name} {}", robot.footprint);
            let (end, has_arrived) = drive(&robot, &stack.with_stop_rule(&robot), TOLD, &what);
            let away_m = end.point().distance(TOLD.point());
            let is_kept = !is_round && name == "keyway";
            assert!(has_arrived == is_round && (away_m > 1.0 || is_kept), "{what}: {end:?}");
        }
    }
}

#[test]
fn nobody_comes_nearer_to_a_wall_that_he_is_told_to_be_too_near_to() {
    for robot in [Robot::small(), plate()] {
        for (name, stack) in stacks(&robot) {
            let safe = stack.clone().with_stop_rule(&robot);
            for (stack, rule) in [(stack, ""), (safe, " --safe")] {
                drive(&robot, &stack, TOLD, &format!("{name}{rule} {:?}", robot.footprint));
            }
        }
    }
}

#[test]
fn a_start_that_is_too_near_by_more_is_refused() {
    let (map, robot) = (hall(), Robot::small());
    let mut stack = Stack::keyway(&robot);
    let ask = |stack: &Stack, y: f64| -> Result<_, NavigateError> {
        let navigator = bound_for(&map, &stack.fit(&robot)?, Point::new(2.0, y), GOAL)?;
        Ok(navigator.too_near().cloned())
    };
    assert_eq!(stack.controller.start_error_m, 0.05);
    assert_eq!(ask(&stack, 0.24), Ok(None));
    let told = ask(&stack, 0.20).unwrap().unwrap();
    assert!(told.nearest.y > 0.23 && told.off_m >= 0.03 && told.off_m <= 0.05, "{told:?}");
    let text = told.to_string();
    assert!(text.contains("(an obstacle is 0.150 m away)"), "{text}");
    assert!(ask(&stack, 0.185).is_ok_and(|told| told.is_some()));
    assert!(matches!(ask(&stack, 0.17), Err(NavigateError::NoRoom { .. })));
    stack.controller.start_error_m = 0.1;
    assert!(ask(&stack, 0.17).is_ok_and(|told| told.is_some()));
    stack.controller.start_error_m = 0.0;
    assert!(matches!(ask(&stack, 0.20), Err(NavigateError::NoRoom { .. })));
    assert!(matches!(ask(&stack, 0.23), Err(NavigateError::StartTouches { .. })));
    for wrong in [-0.1, f64::NAN] {
        stack.controller.start_error_m = wrong;
        let NavigateError::Config(error) = ask(&stack, 1.0).unwrap_err() else { panic!() };
        assert_eq!(error.path, "controller.start_error_m");
    }
}

/// Once a robot has left the obstacle that it started too close to, the start is not reported
/// again, even if its estimate is too close again.
#[test]
fn what_has_been_left_is_not_told_again() {
    let (map, robot) = (hall(), Robot::small());
    let start = Point::new(2.0, 0.2);
    let mut navigator =
        bound_for(&map, &Stack::keyway(&robot).fit(&robot).unwrap(), start, GOAL).unwrap();
    let scan = Scan::of_nothing(&robot.sensors[0]);
    for (y, is_told) in [(0.2, true), (0.229, true), (0.24, false), (0.2, false)] {
        next_step(&mut navigator, Pose::new(2.0, y, 0.0), Velocity::ZERO, &scan);
        assert_eq!(navigator.too_near().is_some(), is_told, "{y}");
    }
}
