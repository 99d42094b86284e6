//! Goals change and are cancelled.

use super::robot_in_a_world::{RobotInAWorld, hall, wall_with_doors};
use keyway::geometry::{Disc, Point, Polyline, Pose, Velocity};
use keyway::navigate::{Blocked, NavigateError, Navigator, Stack, Step};
use keyway::plan::PathEnd;
use keyway::robot::Robot;

#[test]
fn without_a_goal_it_stands() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    assert_eq!(life.cycle(), Step::Idle);
    assert_eq!(life.navigator.goal(), None);
    assert!(life.navigator.route().is_none() && life.navigator.guidance().is_none());
}

#[test]
fn a_goal_needs_a_place() {
    let robot = Robot::small();
    let stack = Stack::keyway(&robot).fit(&robot).unwrap();
    let mut navigator = Navigator::new(&hall(|_| false), &stack).unwrap();
    let refused = navigator.set_goal(Point::new(3.0, 3.0)).unwrap_err();
    assert_eq!(refused, NavigateError::PlaceUnknown);
    let step = navigator.step();
    assert_eq!(step, Step::Blocked { command: Velocity::ZERO, why: Blocked::NothingObserved });
}

/// A goal that changes every 3 s, five times: the last one takes about as long as from rest
/// there.
#[test]
fn goals_may_change_on_the_way() {
    let map = hall(wall_with_doors(&[2.0, 6.0]));
    let mut life = RobotInAWorld::new(&map, Pose::new(2.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(3.5, 3.0), 0.2), Disc::new(Point::new(8.0, 5.0), 0.3)];
    for goal in [[10.0, 2.0], [2.0, 7.0], [10.0, 6.0], [1.0, 1.0], [6.0, 2.0], [10.0, 7.0]] {
        life.navigator.set_goal(Point::from(goal)).unwrap();
        life.drive_for(3.0);
    }
    let from = Pose::new(life.pose.x, life.pose.y, life.pose.theta);
    let changed_s = life.arrive();
    assert!(life.pose.point().distance(Point::new(10.0, 7.0)) < 0.2);
    let mut fresh = RobotInAWorld::new(&map, from);
    fresh.posts.clone_from(&life.posts);
    fresh.navigator.set_goal(Point::new(10.0, 7.0)).unwrap();
    let fresh_s = fresh.arrive();
    assert!(changed_s <= 1.1 * fresh_s, "{changed_s} {fresh_s}");
}

/// Obstacles sensed on the route to the last goal are known for the next one.
#[test]
fn what_was_sensed_lives_on() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(4.0, 4.0), 0.3)];
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life.drive_for(2.0);
    let sensed = life.navigator.sensed().count_ones();
    assert!(sensed > 3);
    life.navigator.set_goal(Point::new(9.0, 4.0)).unwrap();
    assert_eq!(life.navigator.sensed().count_ones(), sensed);
    // The first route already leads around the post.
    let route = life.navigator.route().unwrap().smoothed.clone();
    let nearest_sq = route.segments().map(|leg| leg.distance_sq_to_point(Point::new(4.0, 4.0)));
    assert!(nearest_sq.fold(f64::INFINITY, f64::min) > 0.16);
    life.arrive();
}

#[test]
fn a_goal_that_is_refused_changes_nothing() {
    let mut life = RobotInAWorld::new(&hall(wall_with_doors(&[2.0])), Pose::new(2.0, 4.0, 0.0));
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life.drive_for(2.0);
    let before = (life.navigator.goal(), life.navigator.route().cloned());
    let refused = life.navigator.set_goal(Point::new(6.0, 7.0)).unwrap_err();
    assert!(matches!(refused, NavigateError::NoRoom { .. }), "{refused}");
    let via = life.navigator.set_goals(&[Point::new(0.0, 0.0)], Point::new(3.0, 3.0)).unwrap_err();
    assert!(matches!(via, NavigateError::WayPoint { number: 1, .. }), "{via}");
    assert_eq!((life.navigator.goal(), life.navigator.route().cloned()), before);
    life.arrive();
}

/// An obstacle is on the goal when it is set: the robot starts nevertheless.
#[test]
fn a_goal_on_which_something_stands_is_kept() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(4.0, 4.0), 0.2)];
    life.drive_for(0.5);
    life.navigator.set_goal(Point::new(4.0, 4.0)).unwrap();
    life.drive_for(5.0);
    assert!(matches!(life.cycle(), Step::Blocked { .. }));
    life.posts.clear();
    life.arrive();
}

#[test]
fn cancel_brakes_and_a_later_goal_is_driven_to() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life.drive_for(3.0);
    let v = life.velocity.v;
    assert!(v > 0.4);
    life.navigator.cancel();
    let mut cycles = 0;
    while life.cycle() != Step::Idle {
        cycles += 1;
    }
    // As fast as the robot's brakes allow.
    let needed = v / (life.robot.limits.deceleration_mps2 * life.robot.cycle_s);
    assert!((f64::from(cycles) - needed).abs() <= 1.5, "{cycles} {needed}");
    life.navigator.set_goal(Point::new(2.0, 4.0)).unwrap();
    life.arrive();
}

#[test]
fn way_points_are_passed_in_order() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 2.0, 0.0));
    let via = [Point::new(5.0, 6.0), Point::new(8.0, 2.0)];
    life.navigator.set_goals(&via, Point::new(10.0, 6.0)).unwrap();
    let mut passed = Vec::new();
    while life.cycle() != Step::Arrived {
        if life.navigator.way_points_passed() > passed.len() {
            passed.push(life.pose.point());
        }
    }
    assert!(passed.len() == 2 && passed.iter().zip(via).all(|(at, to)| at.distance(to) < 0.3));
}

/// The deferred search gives the same result as the immediate one, whatever is done in between.
#[test]
fn a_route_may_be_searched_while_it_drives() {
    let map = hall(wall_with_doors(&[2.0, 6.0]));
    let goal = Point::new(10.0, 6.5);
    let begin = || {
        let mut life = RobotInAWorld::new(&map, Pose::new(2.0, 4.0, 0.0));
        life.posts = vec![Disc::new(Point::new(4.5, 5.0), 0.2)];
        life.navigator.set_goal(Point::new(10.0, 1.5)).unwrap();
        life.drive_for(1.0);
        life
    };
    let mut at_once = begin();
    at_once.navigator.set_goal(goal).unwrap();
    let mut later = begin();
    let job = later.navigator.plan_job(&[], goal).unwrap();
    let planned = std::thread::spawn(move || job.run()).join().unwrap();
    assert!(planned.error().is_none());
    later.navigator.accept(planned).unwrap();
    assert_eq!(at_once.navigator.route(), later.navigator.route());
    assert_eq!(at_once.arrive(), later.arrive());
    // The robot continues during a search; the route then begins at its current pose.
    let mut driving = begin();
    let job = driving.navigator.plan_job(&[], goal).unwrap();
    driving.drive_for(2.0);
    driving.navigator.accept(job.run()).unwrap();
    let start = driving.navigator.route().unwrap().smoothed.points()[0];
    assert!(start.distance(driving.pose.point()) < 0.1, "{start:?}");
    driving.arrive();
    // A failed search leaves the goal unchanged.
    let mut refused = begin();
    let job = refused.navigator.plan_job(&[], Point::new(6.0, 4.0)).unwrap();
    assert!(refused.navigator.accept(job.run()).is_err());
    assert_eq!(refused.navigator.goal().unwrap().position, Point::new(10.0, 1.5));
}

#[test]
fn a_path_from_elsewhere_is_followed() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    let corner = Point::new(6.0, 7.0);
    let path = Polyline::new(vec![Point::new(2.0, 4.0), corner, Point::new(10.0, 4.0)]);
    life.navigator.follow(path.clone()).unwrap();
    let mut nearest_m = f64::INFINITY;
    while life.cycle() != Step::Arrived {
        nearest_m = nearest_m.min(life.pose.point().distance(corner));
    }
    assert!(nearest_m < 1.0, "not the straight way: {nearest_m}");
    assert!(life.pose.point().distance(Point::new(10.0, 4.0)) < 0.2);
    // An obstacle on the path is avoided.
    let mut blocked = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    blocked.posts = vec![Disc::new(Point::new(5.0, 6.25), 0.4)];
    blocked.navigator.follow(path).unwrap();
    blocked.arrive();
}

#[test]
fn paths_that_cannot_be_followed_are_refused() {
    let map = hall(wall_with_doors(&[2.0]));
    let mut life = RobotInAWorld::new(&map, Pose::new(2.0, 4.0, 0.0));
    let mut follow = |points: &[[f64; 2]]| {
        let points = points.iter().map(|&point| Point::from(point)).collect();
        life.navigator.follow(Polyline::new(points)).unwrap_err()
    };
    let through_the_wall = follow(&[[2.0, 4.0], [10.0, 4.0]]);
    assert!(matches!(through_the_wall, NavigateError::Misfit(_)), "{through_the_wall}");
    assert_eq!(follow(&[[2.0, 4.0]]), NavigateError::NoPathToFollow);
    assert_eq!(follow(&[[2.0, 4.0], [f64::NAN, 4.0]]), NavigateError::NoPathToFollow);
    assert_eq!(life.navigator.goal(), None);
}

#[test]
fn ways_are_asked_for_without_driving() {
    let map = hall(wall_with_doors(&[2.0]));
    let mut life = RobotInAWorld::new(&map, Pose::new(2.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(4.0, 4.0), 0.3)];
    life.drive_for(0.2);
    let navigator = &mut life.navigator;
    let route = navigator.plan(Point::new(2.0, 4.0), Point::new(10.0, 4.0)).unwrap();
    assert!(navigator.is_path_valid(&route.smoothed));
    let straight = |to: [f64; 2]| Polyline::new(vec![Point::new(2.0, 4.0), Point::from(to)]);
    assert!(navigator.is_path_valid(&straight([4.0, 6.0])));
    assert!(!navigator.is_path_valid(&straight([5.0, 4.0])), "what was sensed counts");
    assert!(navigator.misfit_along(&straight([10.0, 4.5])).is_some(), "and what is known");
    let smoothed = navigator.smooth(&route.line);
    assert!(smoothed.length_m() <= route.line.polyline().length_m() + 1e-9);
    assert!(navigator.is_path_valid(&smoothed) && navigator.goal().is_none());
    assert!(navigator.plan(Point::new(2.0, 4.0), Point::new(6.0, 4.0)).is_err());
    let in_the_wall = navigator.plan(Point::new(6.0, 4.0), Point::new(2.0, 4.0)).unwrap_err();
    let is_of_start = matches!(in_the_wall, NavigateError::NoRoom { end: PathEnd::Start, .. });
    assert!(is_of_start, "{in_the_wall}");
}
