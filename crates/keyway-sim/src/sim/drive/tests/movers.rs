//! Runs among moving obstacles.

use super::*;
use crate::sim::{KeyFrame, KeyFrames, MovingObstacle, ObstacleMotion, Spline, WayPoints};
use keyway::robot::Footprint;

const STAY: Velocity = Velocity::ZERO;

fn open(movers: Vec<MovingObstacle>) -> World {
    world(&[]).with_movers(movers)
}

fn straight(x: f64, y: f64, vx: f64, vy: f64) -> MovingObstacle {
    MovingObstacle::straight(Point::new(x, y), 0.25, Point::new(vx, vy)).unwrap()
}

fn contact(run: &Run) -> (f64, Pose, Obstacle, bool) {
    let Outcome::Collided { pose, with, robot_stood, .. } = run.outcome else {
        panic!("{:?}", run.outcome)
    };
    (run.samples.last().unwrap().t_s, pose, with, robot_stood)
}

#[test]
fn a_mover_runs_into_a_standing_robot() {
    // 3 m away at 1 m/s, until 0.43 m are left.
    let world = open(vec![straight(0.0, 9.0, 0.0, 0.1), straight(3.0, 0.0, -1.0, 0.0)]);
    let run = drive(&world, &robot(), FAR, &limit(10.0), STAY);
    let (t_s, pose, with, robot_stood) = contact(&run);
    assert_eq!((with, robot_stood, pose), (Obstacle::Mover(1), true, Pose::default()));
    assert!((t_s - 2.57).abs() < 1e-4, "{t_s}");
    assert_eq!((run.min_clearance_m, run.min_mover_clearance_m), (Some(0.0), Some(0.0)));
    assert_eq!(run.min_standing_clearance_m, None);
}

#[test]
fn a_robot_that_drives_is_not_said_to_stand() {
    let run = drive(
        &open(vec![straight(3.0, 0.0, 0.0, 0.0)]),
        &robot(),
        FAR,
        &limit(10.0),
        Velocity::new(0.5, 0.0),
    );
    let (_, pose, with, robot_stood) = contact(&run);
    assert_eq!((with, robot_stood), (Obstacle::Mover(0), false));
    assert!((pose.x - 2.57).abs() < 1e-4);
}

#[test]
fn a_disc_that_turns_on_the_spot_is_run_into() {
    let world = open(vec![straight(3.0, 0.0, -1.0, 0.0)]);
    let turned = |footprint: Footprint, v_mps: f64| {
        let robot = Robot { footprint, ..robot() };
        let run = drive(&world, &robot, FAR, &limit(10.0), Velocity::new(v_mps, 1.0));
        let last = run.samples.last().unwrap().velocity;
        assert!(last.omega > 0.0, "{last:?}");
        contact(&run)
    };
    let disc = Footprint::circle(0.18).unwrap();
    assert!(matches!(turned(disc.clone(), 0.0), (_, _, Obstacle::Mover(0), true)));
    // On a small circle, or with sweeping corners, the covered area changes.
    assert!(matches!(turned(disc, 0.01), (_, _, Obstacle::Mover(0), false)));
    let square = Footprint::rectangle(0.36, 0.36).unwrap();
    assert!(matches!(turned(square, 0.0), (_, _, Obstacle::Mover(0), false)));
}

#[test]
fn corners_within_a_cycle_count() {
    // In a cycle of 1 s an obstacle darts in to 0.44 m from the centre, or to 0.42 m, and out
    // again.
    for (nearest_m, touches) in [(0.44, false), (0.42, true)] {
        let frame = |t_s, x| KeyFrame { t_s, position: Point::new(x, 0.0) };
        let frames = KeyFrames::new(vec![frame(0.2, 3.0), frame(0.5, nearest_m), frame(0.8, 3.0)]);
        let mover = MovingObstacle::new(0.25, ObstacleMotion::KeyFrames(frames.unwrap())).unwrap();
        let run = drive(&open(vec![mover]), &brisk(1.0), FAR, &limit(2.0), STAY);
        if touches {
            let (t_s, _, with, _) = contact(&run);
            assert_eq!(with, Obstacle::Mover(0));
            assert!(t_s < 0.5 && t_s > 0.498, "{t_s}");
        } else {
            assert_eq!(run.outcome, Outcome::Timeout);
            assert!((run.min_mover_clearance_m.unwrap() - 0.01).abs() < 1e-4);
        }
    }
}

#[test]
fn the_first_of_several_contacts_counts() {
    // A post ahead is reached after a while; a moving obstacle from the side comes earlier or
    // later.
    let post = world(&[(2.0, 0.0, 0.25)]);
    for (speed_mps, with) in [(1.0, Obstacle::Mover(0)), (0.2, Obstacle::Circle(0))] {
        let world = post.clone().with_movers(vec![straight(1.0, 3.0, 0.0, -speed_mps)]);
        let run = drive(&world, &robot(), FAR, &limit(20.0), Velocity::new(0.5, 0.0));
        assert_eq!(contact(&run).2, with, "{speed_mps}");
    }
}

#[test]
fn clearances_from_what_stands_and_what_moves_are_apart() {
    let ends = vec![Point::new(-3.0, 2.0), Point::new(3.0, 2.0)];
    let patrol = ObstacleMotion::WayPoints(WayPoints::around(ends, 1.0).unwrap());
    let patrol = MovingObstacle::new(0.25, patrol).unwrap();
    let run = drive(
        &world(&[(0.0, -1.0, 0.5)]).with_movers(vec![patrol]),
        &robot(),
        FAR,
        &limit(12.0),
        STAY,
    );
    let near = |clearance_m: Option<f64>, expected_m: f64| {
        (clearance_m.unwrap() - expected_m).abs() < 1e-4
    };
    assert!(near(run.min_standing_clearance_m, 0.32) && near(run.min_clearance_m, 0.32));
    assert!(near(run.min_mover_clearance_m, 1.57));
    assert_eq!(run.outcome, Outcome::Timeout);
}

#[test]
fn contact_at_the_start() {
    let run = drive(&open(vec![straight(0.3, 0.0, 1.0, 0.0)]), &robot(), FAR, &limit(4.0), STAY);
    let (t_s, _, with, robot_stood) = contact(&run);
    assert_eq!((t_s, with, robot_stood, run.cycles), (0.0, Obstacle::Mover(0), true, 0));
}

#[test]
fn a_controller_sees_a_mover_where_it_is_at_its_cycle() {
    let world = open(vec![straight(3.0, 0.0, -0.5, 0.0)]);
    let mut cycle = 0;
    alone(&world, &robot(), Pose::default(), FAR, &limit(2.0), |observation| {
        let scan = observation.scans[0].scan;
        // Beam 4 of 8 points straight ahead.
        let range_m = 2.75 - 0.5 * 0.1 * f64::from(cycle);
        assert!((scan.ranges_m.get(4).unwrap() - range_m).abs() < 1e-9);
        cycle += 1;
        Control { action: Action::Stop, remaining_m: 9.0, route: 1, turn_left_rad: 0.0 }
    })
    .unwrap();
    assert_eq!(cycle, 20);
}

#[test]
fn the_speed_at_a_contact_is_said() {
    let speed_mps = |world: &World| {
        let run = drive(world, &robot(), FAR, &limit(10.0), STAY);
        let Outcome::Collided { mover_speed_mps, .. } = run.outcome else {
            panic!("{:?}", run.outcome)
        };
        (mover_speed_mps, contact(&run).0)
    };
    assert_eq!(speed_mps(&open(vec![straight(3.0, 0.0, -0.7, 0.0)])).0, Some(0.7));
    // In contact from the beginning.
    assert_eq!(speed_mps(&open(vec![straight(0.3, 0.0, 0.0, 0.0)])).0, Some(0.0));
    // 8 m in 0.4 s: the Hermite cubic gives the contact at 0.43 m, and its derivative the speed
    // there.
    let frames = [[1.0, 4.0, 0.0], [1.4, -4.0, 0.0]].map(KeyFrame::from).to_vec();
    let darts =
        MovingObstacle::new(0.25, ObstacleMotion::Spline(Spline::new(frames, 3.0).unwrap()))
            .unwrap();
    let (speed, t_s) = speed_mps(&open(vec![darts]));
    let u = (t_s - 1.0) / 0.4;
    let place_m = 4.0 - 4.0 * u - 12.0 * u * u + 8.0 * u * u * u;
    assert!((place_m - 0.43).abs() < 1e-3, "{place_m}");
    let expected_mps = (4.0 + 24.0 * u - 24.0 * u * u) / 0.4;
    assert!((speed.unwrap() - expected_mps).abs() < 1e-9, "{speed:?} {expected_mps}");
    assert!(expected_mps > MovingObstacle::DART_MPS);
    // A stationary obstacle has no speed.
    let wall =
        drive(&world(&[(1.0, 0.0, 0.1)]), &robot(), FAR, &limit(9.0), Velocity::new(0.5, 0.0));
    assert!(matches!(wall.outcome, Outcome::Collided { mover_speed_mps: None, .. }));
}

/// An obstacle at (x, 0) for a second, then aside; after 3 s it jumps back.
fn jumping_to(x: f64) -> MovingObstacle {
    let frames = [[0.0, x, 0.0], [1.0, x, 0.0], [1.5, x, 5.0]].map(KeyFrame::from).to_vec();
    MovingObstacle::new(0.25, ObstacleMotion::Spline(Spline::new(frames, 3.0).unwrap())).unwrap()
}

#[test]
fn what_has_just_jumped_is_said() {
    // After 3 s the robot is at 1.25 m, at 0.5 m/s. The obstacle jumps onto it, or the robot
    // drives into the obstacle after the jump.
    for (gap_m, t_s, expected) in [(-0.1, 3.0, true), (0.03, 3.06, true), (0.06, 3.12, false)] {
        let world = open(vec![jumping_to(1.25 + 0.43 + gap_m)]);
        let run = drive(&world, &robot(), FAR, &limit(10.0), Velocity::new(0.5, 0.0));
        let Outcome::Collided { with, robot_stood, jumped_onto, .. } = run.outcome else {
            panic!("{gap_m}: {:?}", run.outcome)
        };
        assert_eq!((with, robot_stood, jumped_onto), (Obstacle::Mover(0), false, expected));
        let late_s = (contact(&run).0 - t_s).abs();
        // While the robot drives, the obstacle moves aside by millimetres.
        assert!(late_s < if gap_m < 0.0 { 1e-9 } else { 0.01 }, "{late_s}");
        assert_eq!(run.min_mover_clearance_m, Some(0.0));
    }
    // The obstacle has not jumped at the beginning.
    let run = drive(&open(vec![jumping_to(0.3)]), &robot(), FAR, &limit(4.0), STAY);
    assert!(matches!(run.outcome, Outcome::Collided { jumped_onto: false, robot_stood: true, .. }));
}

#[test]
fn a_jump_at_every_time_of_a_cycle_is_met() {
    // The obstacle jumps onto the robot's current position, at rounded times.
    for lap in 0..40 {
        let duration_s = 2.0 + f64::from(lap) * 0.0125;
        let frames = [[0.0, 1.0, 0.0], [1.0, 1.0, 5.0]].map(KeyFrame::from).to_vec();
        let motion = ObstacleMotion::Spline(Spline::new(frames, duration_s).unwrap());
        let world = open(vec![MovingObstacle::new(0.25, motion).unwrap()]);
        let run = drive(&world, &robot(), FAR, &limit(10.0), Velocity::new(0.5, 0.0));
        assert!(matches!(run.outcome, Outcome::Collided { jumped_onto: true, .. }), "{duration_s}");
        assert!((contact(&run).0 - duration_s).abs() < 1e-9, "{duration_s}");
    }
}
