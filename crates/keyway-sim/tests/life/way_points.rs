//! Unreachable way-points.

use super::robot_in_a_world::{RobotInAWorld, hall, wall_with_doors};
use keyway::geometry::{Disc, Point, Pose};
use keyway::navigate::{Blocked, IfWayPointBlocked, Navigator, Stack, Step};

/// A post on the first of two way-points.
fn with(if_blocked: IfWayPointBlocked) -> RobotInAWorld {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    let mut stack = Stack::keyway(&life.robot);
    assert_eq!(stack.controller.if_way_point_blocked, IfWayPointBlocked::PassNear, "the default");
    stack.controller.if_way_point_blocked = if_blocked;
    life.navigator = Navigator::new(&life.truth, &stack.fit(&life.robot).unwrap()).unwrap();
    life.navigator.relocate(life.pose);
    life.posts = vec![Disc::new(Point::new(5.0, 4.0), 0.3)];
    let via = [Point::new(5.0, 4.0), Point::new(7.0, 6.0)];
    life.navigator.set_goals(&via, Point::new(10.0, 4.0)).unwrap();
    life
}

/// Drives to the goal; returns the smallest distances from the two way-points.
fn nearest_m(life: &mut RobotInAWorld) -> [f64; 2] {
    let mut nearest_m = [f64::INFINITY; 2];
    while life.cycle() != Step::Arrived {
        assert!(life.stamp_s < 90.0, "{:?}", life.pose);
        for (least_m, at) in nearest_m.iter_mut().zip([[5.0, 4.0], [7.0, 6.0]]) {
            *least_m = least_m.min(life.pose.point().distance(Point::from(at)));
        }
    }
    nearest_m
}

#[test]
fn it_passes_near_by() {
    let mut life = with(IfWayPointBlocked::PassNear);
    let [first_m, second_m] = nearest_m(&mut life);
    // As near as the post and the robot's size allow.
    assert!(first_m < 0.3 + 0.18 + 0.35 && second_m < 0.2, "{first_m} {second_m}");
    assert_eq!(
        (life.navigator.way_points_passed(), life.navigator.way_points_skipped()),
        (2, &[][..])
    );
}

#[test]
fn it_skips_it() {
    let mut life = with(IfWayPointBlocked::Skip);
    let [_, second_m] = nearest_m(&mut life);
    assert!(second_m < 0.2, "{second_m}");
    assert_eq!(
        (life.navigator.way_points_passed(), life.navigator.way_points_skipped()),
        (2, &[0][..])
    );
}

#[test]
fn it_waits() {
    let mut life = with(IfWayPointBlocked::Wait);
    life.drive_for(20.0);
    let step = life.cycle();
    assert!(matches!(step, Step::Blocked { why: Blocked::NoRoute(_), .. }), "{step:?}");
    assert_eq!(life.navigator.way_points_passed(), 0);
    life.posts.clear();
    nearest_m(&mut life);
}

/// A way-point behind a closed door is skipped, because positions near it are unreachable, too.
#[test]
fn what_is_not_near_by_is_skipped() {
    let open = hall(wall_with_doors(&[4.0]));
    let mut life = RobotInAWorld::new(&open, Pose::new(2.0, 4.0, 0.0));
    life.truth = hall(wall_with_doors(&[]));
    life.navigator.set_goals(&[Point::new(10.0, 4.0)], Point::new(2.0, 7.0)).unwrap();
    nearest_m(&mut life);
    assert_eq!(life.navigator.way_points_skipped(), [0]);
}

#[test]
fn the_nearest_place_that_can_be_reached() {
    let map = hall(wall_with_doors(&[]));
    let mut life = RobotInAWorld::new(&map, Pose::new(2.0, 4.0, 0.0));
    let start = Point::new(2.0, 4.0);
    let mut nearest = |goal: [f64; 2]| life.navigator.nearest_reachable(start, Point::from(goal));
    assert_eq!(nearest([4.0, 6.0]), Some(Point::new(4.0, 6.0)), "the goal itself");
    let before_the_wall = nearest([9.0, 5.0]).unwrap();
    assert!((before_the_wall.x - 5.7).abs() < 0.1 && (before_the_wall.y - 5.0).abs() < 0.1);
    // In the wall of the hall.
    let beside_the_wall = nearest([3.0, 0.0]).unwrap();
    assert!(beside_the_wall.distance(Point::new(3.0, 0.25)) < 0.1, "{beside_the_wall:?}");
    life.navigator.set_goal(before_the_wall).unwrap();
    nearest_m(&mut life);
}
