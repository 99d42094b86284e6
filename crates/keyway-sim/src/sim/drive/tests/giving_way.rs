//! Runs among obstacles that give way.

use super::*;
use crate::sim::{KeyFrame, KeyFrames, MoverWay, MovingObstacle, ObstacleMotion, WayPoints};

/// An obstacle that moves to and fro between two positions at 1 m/s.
fn between(from: Point, to: Point) -> MovingObstacle {
    let course = WayPoints::to_and_fro(vec![from, to], 1.0).unwrap();
    MovingObstacle::new(0.25, ObstacleMotion::GivesWay(course)).unwrap()
}

/// Runs a robot among moving obstacles with one commanded velocity.
fn among(movers: Vec<MovingObstacle>, start: Pose, command: Velocity, time_limit_s: f64) -> Run {
    let mut left = 1e6;
    let controller = move |_: &Observation<'_>| {
        left -= 1.0;
        Control { action: Action::Drive(command), remaining_m: left, route: 1, turn_left_rad: 0.0 }
    };
    let world = world(&[]).with_movers(movers);
    alone(&world, &robot(), start, FAR, &limit(time_limit_s), controller).unwrap()
}

/// Smallest distance between two centres, which both move straight between equal times.
fn least_m(one: &MoverWay, other: &MoverWay) -> f64 {
    let apart = |i: usize| other.key_frames[i].position - one.key_frames[i].position;
    let pairs = (1..one.key_frames.len()).map(|i| {
        let (from, along) = (apart(i - 1), apart(i) - apart(i - 1));
        let part = if along.norm_sq() > 0.0 { -from.dot(along) / along.norm_sq() } else { 0.0 };
        (from + along * part.clamp(0.0, 1.0)).norm()
    });
    pairs.fold(f64::INFINITY, f64::min)
}

fn far_off() -> Pose {
    Pose::new(9.0, -9.0, 0.0)
}

#[test]
fn a_standing_robot_is_passed_from_every_side_without_contact() {
    for degrees in (0..360).step_by(15) {
        let (sin, cos) = libm::sincos(f64::from(degrees).to_radians());
        let place = Point::new(4.0 * cos, 4.0 * sin);
        let run = among(vec![between(place, place * -1.0)], Pose::default(), Velocity::ZERO, 10.0);
        assert_eq!(run.outcome, Outcome::Timeout, "{degrees}");
        let clearance_m = run.min_mover_clearance_m.unwrap();
        assert!(clearance_m > 0.05 && clearance_m < 1.0, "{degrees}: {clearance_m}");
        // The obstacle continues to the other position and turns back there.
        let places = &run.movers[0].key_frames;
        let nearest_m = |to: Point| {
            places.iter().map(|frame| frame.position.distance(to)).fold(f64::INFINITY, f64::min)
        };
        assert!(nearest_m(place * -1.0) < 0.3, "{degrees}");
        // It passes to its right: the robot stays on its left.
        let beside = places.iter().find(|frame| frame.position.dot(place) < 0.0).unwrap();
        assert!(place.cross(beside.position) > 0.3, "{degrees}: {beside:?}");
    }
}

#[test]
fn two_who_meet_head_on_pass_each_other_on_the_right() {
    for degrees in [0, 30, 45, 90, 200] {
        let (sin, cos) = libm::sincos(f64::from(degrees).to_radians());
        let place = Point::new(4.0 * cos, 4.0 * sin);
        let both = || vec![between(place, place * -1.0), between(place * -1.0, place)];
        let run = among(both(), far_off(), Velocity::ZERO, 10.0);
        let [one, other] = &run.movers[..] else { panic!("{:?}", run.movers) };
        assert!(least_m(one, other) > 0.55, "{degrees}: {}", least_m(one, other));
        // Both paths are equal after half a turn, except for the force of the distant robot, and
        // both arrive.
        for (a, b) in one.key_frames.iter().zip(&other.key_frames) {
            assert!((a.position + b.position).norm() < 1e-2, "{degrees}: {a:?} {b:?}");
        }
        let is_there = |frame: &KeyFrame| frame.position.distance(place * -1.0) < 0.3;
        assert!(one.key_frames.iter().any(is_there), "{degrees}");
        assert_eq!(among(both(), far_off(), Velocity::ZERO, 10.0), run);
    }
}

#[test]
fn what_a_robot_meets_is_where_the_obstacle_was() {
    let (left, right) = (Point::new(-3.0, 0.4), Point::new(3.0, -0.2));
    let crossing =
        MovingObstacle::straight(Point::new(0.0, -3.0), 0.3, Point::new(0.1, 0.6)).unwrap();
    let movers = vec![crossing.clone(), between(left, right), between(right, left)];
    for command in [Velocity::ZERO, Velocity::new(0.5, 0.1), Velocity::new(0.5, -0.6)] {
        let run = among(movers.clone(), Pose::new(-1.0, 0.0, 0.0), command, 15.0);
        assert_eq!(run.movers.iter().map(|way| way.index).collect::<Vec<_>>(), [1, 2]);
        // Repeats the run with obstacles that ignore everything.
        let mut driven = vec![crossing.clone()];
        for way in &run.movers {
            assert_eq!(way.key_frames.len() as u64, run.cycles + 1);
            // Compares positions at the end of every cycle; a contact may cut the last one short.
            for (frame, sample) in
                way.key_frames.iter().zip(&run.samples).take(run.samples.len() - 1)
            {
                assert_eq!(frame.t_s, sample.t_s);
            }
            let frames = KeyFrames::new(way.key_frames.clone()).unwrap();
            driven.push(MovingObstacle::new(0.25, ObstacleMotion::KeyFrames(frames)).unwrap());
        }
        let again = among(driven, Pose::new(-1.0, 0.0, 0.0), command, 15.0);
        assert_eq!(Run { movers: vec![], ..run }, again);
    }
}

#[test]
fn they_give_way_to_robots_that_drive() {
    // Head-on, and from behind.
    for (from, to) in [(6.0, -6.0), (-6.0, 6.0)] {
        let mover = between(Point::new(from, 0.0), Point::new(to, 0.0));
        let ahead = Velocity::new(0.4, 0.0);
        let run = among(vec![mover], Pose::new(-2.0, 0.0, 0.0), ahead, 10.0);
        assert_eq!(run.outcome, Outcome::Timeout, "{from}");
        assert!(run.min_mover_clearance_m.unwrap() > 0.05, "{:?}", run.min_mover_clearance_m);
    }
}
