//! Single acts: turns and straight drives.

use super::robot_in_a_world::{RobotInAWorld, hall, wall_with_doors};
use keyway::geometry::{Disc, Point, Pose, wrap_angle};
use keyway::navigate::{Blocked, Step};
use std::f64::consts::PI;

#[test]
fn it_turns_drives_and_backs_up() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(4.0, 4.0, 0.3));
    life.robot.limits.v_min_mps = -0.3;
    let robot = life.robot.clone();
    let stack = keyway::navigate::Stack::keyway(&robot).fit(&robot).unwrap();
    life.navigator = keyway::navigate::Navigator::new(&life.truth, &stack).unwrap();
    for (angle_rad, heading_rad) in [(PI / 2.0, 0.3 + PI / 2.0), (-3.0 * PI, 0.3 - PI / 2.0)] {
        life.navigator.spin(angle_rad, 60.0).unwrap();
        life.arrive();
        assert!(wrap_angle(life.pose.theta - heading_rad).abs() < 0.01, "{:?}", life.pose);
        assert!(life.pose.point().distance(Point::new(4.0, 4.0)) < 1e-9);
    }
    life.navigator.drive_on_heading(1.5, 30.0).unwrap();
    life.arrive();
    let ahead = life.pose.point();
    assert!((ahead.distance(Point::new(4.0, 4.0)) - 1.5).abs() < 0.01, "{ahead:?}");
    life.navigator.back_up(1.0, 30.0).unwrap();
    life.arrive();
    assert!((life.pose.point().distance(ahead) - 1.0).abs() < 0.01, "{:?}", life.pose);
    assert_eq!(life.cycle(), Step::Arrived, "it stays so");
    life.navigator.cancel();
    assert_eq!(life.cycle(), Step::Idle);
}

/// From motion, it brakes first.
#[test]
fn an_act_takes_the_place_of_a_goal() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life.drive_for(3.0);
    life.navigator.spin(1.0, 20.0).unwrap();
    assert_eq!(life.navigator.goal(), None);
    let heading_rad = life.pose.theta;
    life.arrive();
    assert!(wrap_angle(life.pose.theta - heading_rad - 1.0).abs() < 0.05, "{:?}", life.pose);
}

#[test]
fn an_act_without_room_waits_until_its_time_is_over() {
    let map = hall(wall_with_doors(&[]));
    let mut life = RobotInAWorld::new(&map, Pose::new(5.0, 4.0, 0.0));
    life.navigator.drive_on_heading(2.0, 3.0).unwrap();
    life.drive_for(2.5);
    let step = life.cycle();
    assert!(matches!(step, Step::Blocked { why: Blocked::NoRoomForAct, .. }), "{step:?}");
    life.drive_for(1.0);
    let step = life.cycle();
    assert!(matches!(step, Step::Blocked { why: Blocked::OutOfTime, .. }), "{step:?}");
    assert_eq!(life.pose.point(), Point::new(5.0, 4.0));
    // The obstacle moves away in time.
    life.posts = vec![Disc::new(Point::new(4.0, 4.0), 0.3)];
    life.navigator.spin(PI, 30.0).unwrap();
    life.arrive();
    life.navigator.drive_on_heading(2.0, 60.0).unwrap();
    life.drive_for(5.0);
    assert!(matches!(life.cycle(), Step::Blocked { why: Blocked::NoRoomForAct, .. }));
    life.posts.clear();
    life.arrive();
    assert!((life.pose.x - 3.0).abs() < 0.02, "{:?}", life.pose);
}

#[test]
fn acts_that_cannot_be_are_refused() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    let navigator = &mut life.navigator;
    let texts = [
        navigator.spin(f64::NAN, 1.0),
        navigator.spin(1.0, 0.0),
        navigator.drive_on_heading(-1.0, 1.0),
        navigator.drive_on_heading(1.0, f64::INFINITY),
        navigator.back_up(1.0, 1.0),
    ]
    .map(|refused| refused.unwrap_err().to_string());
    let begins = [
        "angle_rad must be a finite angle",
        "allowance_s must be a positive",
        "distance_m must be",
        "allowance_s must be finite",
        "distance_m cannot be driven: the robot does not drive backwards",
    ];
    for (text, begin) in texts.iter().zip(begins) {
        assert!(text.starts_with(begin), "{text}");
    }
    assert_eq!(life.cycle(), Step::Idle);
}
