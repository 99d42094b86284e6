//! Tasks that a navigator refuses, and its messages.
#![allow(clippy::unwrap_used)]

#[path = "support/building.rs"]
mod building;
#[path = "support/driving.rs"]
mod driving;

use building::{GOAL, START, blocks, building};
use driving::bound_for;
use keyway::geometry::Point;
use keyway::map::{Hindrance, Separation};
use keyway::navigate::{Blocked, NavigateError, Stack};
use keyway::plan::{PathEnd, PlanError};
use keyway::robot::{Footprint, Robot};
use serde_json::{Value, json};

#[test]
fn starts_and_goals_that_are_no_places() {
    let (map, robot) = (building(), Robot::small());
    let mut stack = Stack::key_point_fusion(&robot);
    stack.controller.start_error_m = 0.0;
    let ask =
        |start, goal| bound_for(&map, &stack.fit(&robot).unwrap(), start, goal).err().unwrap();
    let nowhere = Point::new(f64::NAN, 1.0);
    let start = ask(nowhere, GOAL);
    assert!(matches!(start, NavigateError::NotFinite { end: PathEnd::Start, .. }), "{start}");
    let text = start.to_string();
    assert!(text.starts_with("start (NaN, 1) is not a valid position: "), "{text}");
    let goal = ask(START, nowhere);
    assert!(matches!(goal, NavigateError::NotFinite { end: PathEnd::Goal, .. }), "{goal}");
    // The wall ends at 0.5 m: the robot of 0.18 m touches it.
    let touching = ask(Point::new(1.25, 0.68), GOAL);
    let NavigateError::StartTouches { heading_rad: None, .. } = &touching else {
        panic!("{touching}")
    };
    assert_eq!(
        touching.to_string(),
        "at the start (1.25, 0.68) the robot (radius 0.18 m) touches something (an obstacle is 0.180 m away); \
         move the start away from it"
    );
    assert!(bound_for(&map, &stack.fit(&robot).unwrap(), Point::new(1.25, 0.681), GOAL).is_ok());
}

#[test]
fn a_stack_must_leave_room_for_its_robot() {
    let robot = Robot::small();
    let mut stack = Stack::key_point_fusion(&Robot::paper());
    // The robot of the paper is a point.
    assert!(stack.fit(&Robot::paper()).is_ok());
    stack = Stack { map: stack.map, ..Stack::key_point_fusion(&robot) };
    let error = stack.fit(&robot).unwrap_err();
    assert_eq!(
        error.to_string(),
        "map.clearance_m must be at least 0.18, the inscribed radius of the robot (radius 0.18 m): a route must leave space for it, \
         got 0.1"
    );
    let mut tight = Stack::key_point_fusion(&robot);
    tight.controller.least_clearance_m = 0.1;
    assert_eq!(tight.fit(&robot).unwrap_err().path, "controller.least_clearance_m");
}

#[test]
fn refuses_what_cannot_be_driven() {
    let map = building();
    let robot = Robot::small();
    let stack = Stack::key_point_fusion(&robot);
    let ask =
        |start, goal| bound_for(&map, &stack.fit(&robot).unwrap(), start, goal).err().unwrap();
    let in_wall = ask(Point::new(0.1, 1.0), GOAL);
    let NavigateError::NoRoom { end, nearest, .. } = &in_wall else { panic!("{in_wall}") };
    assert_eq!(*end, PathEnd::Start);
    let nearest = nearest.unwrap();
    assert!(nearest.distance(Point::new(0.75, 1.0)) < 0.15, "{nearest:?}");
    let text = in_wall.to_string();
    assert!(
        text.contains(": it is inside an obstacle; the nearest position with enough clearance"),
        "{text}"
    );
    let solid = blocks(&["###", "###"]);
    let nowhere = bound_for(&solid, &stack.fit(&robot).unwrap(), Point::new(0.5, 0.5), GOAL);
    let text = nowhere.err().unwrap().to_string();
    assert!(
        text.ends_with("; no other position on this map has enough clearance either"),
        "{text}"
    );
    // Beside a wall, nearer than the radius.
    let tight = ask(START, Point::new(6.5, 0.6));
    assert!(matches!(tight, NavigateError::NoRoom { end: PathEnd::Goal, .. }));
    let closed = ask(START, Point::new(8.5, 3.0));
    assert!(matches!(closed, NavigateError::NoWay { why: Separation::Apart { .. } }), "{closed}");
    let outside = ask(START, Point::new(-5.0, 60.0));
    let is_outside = matches!(outside, NavigateError::NoRoom { why: Hindrance::Outside, .. });
    assert!(is_outside, "{outside}");
    // Between both rooms the corridor is 1 m wide.
    let wide = Robot { footprint: Footprint::circle(0.6).unwrap(), ..Robot::small() };
    let its_stack = Stack::key_point_fusion(&wide);
    let (start, goal) = (Point::new(1.5, 2.0), Point::new(6.5, 2.0));
    let narrow = bound_for(&map, &its_stack.fit(&wide).unwrap(), start, goal).err().unwrap();
    let NavigateError::NoWay { why: Separation::TooNarrow { widest_m, .. } } = narrow else {
        panic!("{narrow}")
    };
    assert!((widest_m - 0.45).abs() < 1e-9, "an even number of cells has none in its middle");
    let statistics = keyway::search::SearchStatistics::default();
    let on_the_way = Blocked::NoRoute(PlanError::NoPath { statistics }.into()).to_string();
    assert_eq!(on_the_way, "with the sensed obstacles, no path to the goal exists");
}

/// For every invalid value, the error gives its whole path in the stack.
#[test]
fn errors_name_the_whole_path_of_a_field() {
    let map = building();
    let json = serde_json::to_value(Stack::key_point_fusion(&Robot::small())).unwrap();
    let refused = |robot: &Robot, path: &str, part: Value| {
        let mut json = json.clone();
        let parent = path.split('.').next().unwrap();
        if part.is_object() {
            json[parent] = part;
        } else {
            let at = json.pointer_mut(&format!("/{}", path.replace('.', "/")));
            *at.unwrap() = part;
        }
        let stack: Stack = serde_json::from_value(json).unwrap();
        let navigator = |fitted| bound_for(&map, &fitted, START, GOAL);
        match stack.fit(robot).map_err(NavigateError::from).and_then(navigator).err().unwrap() {
            NavigateError::Config(error) => (error.path, error.reason),
            other => panic!("{other}"),
        }
    };
    let robot = Robot::small();
    for (path, part, reason) in [
        (
            "map.clearance_m",
            json!(-1.0),
            "must be at least 0.18, the inscribed radius of the robot (radius 0.18 m): a route must leave space for it, got -1",
        ),
        ("map.free_ends_m", json!(0.5), "got 0.5"),
        (
            "planner.step_m",
            json!({"name": "rrt", "step_m": 0.0}),
            "must be a positive number, got 0",
        ),
        ("planner.name", json!({"name": "prepared"}), "use jps"),
        (
            "smoother.safe_distance_m",
            json!({"name": "key-points", "safe_distance_m": -0.5}),
            "must be a number of at least 0, got -0.5",
        ),
        ("guide.reach_m", json!(0.0), "must be a positive number, got 0"),
        (
            "local.window.horizon_s",
            json!(0.2),
            "must be at least 1.1, for a cycle and the time to stop, got 0.2",
        ),
        (
            "local.weights.heading",
            json!(-1.0),
            "must be a number of at least 0 and at most 1000000000, got -1",
        ),
        ("controller.blocked_s", json!(0.0), "must be a positive number, got 0"),
    ] {
        let (at, why) = refused(&robot, path, part);
        assert!(at == path && why.ends_with(reason), "{path}: {at} {why}");
    }
    let bad = Robot { cycle_s: 0.0, ..robot };
    let reason = "must be a time from 0.001 to 10 s, got 0";
    let expected = ("robot.cycle_s".to_owned(), reason.to_owned());
    assert_eq!(refused(&bad, "controller.blocked_s", json!(1.0)), expected);
}
