//! Motions of recoveries, obeyed by simulated wheels.

use super::*;
use crate::map::{FieldConfig, OccupancyGrid};
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;

fn moment(robot: &Robot, state: (Pose, Velocity), elapsed_s: f64) -> Moment<'_> {
    let ((pose, velocity), robot_then) = (state, state);
    let (least, moves_on) = (Velocity::ZERO, false);
    Moment { robot, pose, velocity, robot_then, moves_on, elapsed_s, least }
}

/// Executes a motion as a robot does; returns the end pose, the result and the highest speed.
fn obey(motion: Motion, robot: &Robot, start: (Pose, Velocity)) -> (Pose, MotionStep, f64) {
    let map = OccupancyGrid::from_ascii(&["........"; 8]);
    let obstacles = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
    let (mut pose, mut velocity) = start;
    let (mut under_way, mut fastest) = (MotionUnderWay::new(motion), 0.0f64);
    for _ in 0..2000 {
        let elapsed_s = robot.cycle_s;
        let moment = moment(robot, (pose, velocity), elapsed_s);
        match under_way.step(&moment, &obstacles) {
            MotionStep::Moving(command) => {
                let reached = robot.limits.reached(velocity, command, robot.cycle_s);
                pose = pose.after_ramp(velocity, reached, robot.cycle_s);
                velocity = reached;
                fastest = fastest.max(velocity.v.abs());
            }
            ended => return (pose, ended, fastest),
        }
    }
    panic!("{motion:?} has no end: {under_way:?}")
}

/// Ahead and back, to both sides, and so gently that the turn rate is no limit.
#[test]
fn arcs_of_a_car_end_where_they_should() {
    let limits = crate::robot::Limits {
        v_min_mps: -0.3,
        min_turning_radius_m: 0.3,
        ..Robot::small().limits
    };
    let robot = Robot { limits, ..Robot::small() };
    let start = Pose::new(4.0, 4.0, 0.5);
    for (length_m, turn_rad) in [(0.6, 1.5), (-0.6, 1.5), (0.6, -1.5), (-1.0, -2.0), (1.0, 0.1)] {
        let motion = Motion::Arc(length_m, turn_rad);
        let (pose, ended, _) = obey(motion, &robot, (start, Velocity::ZERO));
        let end = start.after_arc(Velocity::new(length_m, turn_rad), 1.0);
        let off_rad = wrap_angle(pose.theta - end.theta);
        assert_eq!(ended, MotionStep::Done);
        assert!(pose.point().distance(end.point()) < 0.02, "{motion:?}: {pose:?} {end:?}");
        assert!(off_rad.abs() < 0.03, "{motion:?}: {off_rad}");
    }
}

#[test]
fn motions_end_where_they_should() {
    let backwards = crate::robot::Limits { v_min_mps: -0.3, ..Robot::small().limits };
    let robot = Robot { limits: backwards, ..Robot::small() };
    let start = (Pose::new(4.0, 4.0, 0.0), Velocity::ZERO);
    let (pose, ended, fastest) = obey(Motion::Drive(1.0), &robot, start);
    assert!(ended == MotionStep::Done && (pose.x - 5.0).abs() < 0.01, "{pose:?}");
    assert_eq!(fastest, robot.limits.v_max_mps);
    let (pose, ended, _) = obey(Motion::Drive(-0.5), &robot, start);
    assert!(ended == MotionStep::Done && (pose.x - 3.5).abs() < 0.01, "{pose:?}");
    for turn_rad in [1.0, -2.0, 5.0, -6.0] {
        let (pose, ended, _) = obey(Motion::Turn(turn_rad), &robot, start);
        let off_rad = wrap_angle(pose.theta - turn_rad);
        assert!(ended == MotionStep::Done && off_rad.abs() < 0.01, "{turn_rad}: {pose:?}");
        assert!(pose.point().distance(start.0.point()) < 1e-12);
    }
    let (pose, ended, _) = obey(Motion::Wait(2.0), &robot, start);
    assert_eq!((pose, ended), (start.0, MotionStep::Done));
    // Backwards as fast as forward, unless no sensor covers that direction.
    let mut blind_behind = robot.clone();
    blind_behind.limits.v_min_mps = -0.5;
    assert_eq!(obey(Motion::Drive(-1.0), &blind_behind, start).2, 0.5);
    blind_behind.sensors[0].field_of_view_deg = 270.0;
    assert_eq!(obey(Motion::Drive(-1.0), &blind_behind, start).2, 0.125);
    let mut nearly_blind = robot.clone();
    nearly_blind.sensors[0].beams = 19;
    assert_eq!(obey(Motion::Drive(1.0), &nearly_blind, start).2, 0.125);
    let outside = obey(Motion::Drive(9.0), &robot, start);
    assert_eq!((outside.0, outside.1), (start.0, MotionStep::Refused));
}

fn walls(rows: &[&str]) -> DistanceField {
    let map = OccupancyGrid::from_ascii(rows);
    DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default())
}

/// At the limit in open space, at half of it if the robot then stops before a corner comes
/// close to the wall, and at a quarter of it beside the wall.
#[test]
fn turns_are_as_fast_as_there_is_room() {
    let obstacles = walls(&["........", "........", "........", "########"]);
    let (robot, turn) = (Robot::jackal(), Motion::Turn(3.0));
    let (footprint, margin_m) = (&robot.footprint, robot.safety_margin_or_default_m());
    let share =
        |beside_m: f64| share(&robot, Pose::new(4.0, 1.0 + beside_m, 0.0), turn, &obstacles);
    let (inner_m, outer_m) = (footprint.inscribed_radius_m(), footprint.circumscribed_radius_m());
    assert_eq!(share(outer_m + margin_m + 2e-3), 1.0);
    // At half of its rate, it rotates by 0.26 rad until it stops.
    let corner_m = 0.254 * 0.2625f64.sin() + 0.215 * 0.2625f64.cos();
    let found = [-2e-3, 2e-3].map(|more_m| share(corner_m + margin_m + more_m));
    assert_eq!(found, [SPEED_SHARE, 0.5]);
    assert_eq!(share(inner_m + margin_m), SPEED_SHARE);
}

/// At the limit if nothing is close to its stopping path, at half of it in front of a wall,
/// and at a quarter of it beside one.
#[test]
fn drives_are_as_fast_as_there_is_room() {
    let obstacles = walls(&["........", "........", "........", "########"]);
    let robot = Robot::jackal();
    let room_m = robot.safety_margin_or_default_m() + 0.05;
    let beside_m = 1.0 + robot.footprint.inscribed_radius_m() + room_m;
    let along = |y| share(&robot, Pose::new(2.0, y, 0.0), Motion::Drive(1.0), &obstacles);
    assert_eq!([1e-3, -1e-3].map(|more_m| along(beside_m + more_m)), [1.0, SPEED_SHARE]);
    let front_m = 0.254;
    let stops_m = |share: f64| {
        let fast_mps = share * robot.limits.v_max_mps;
        fast_mps * robot.cycle_s + 0.5 * fast_mps * fast_mps / robot.limits.deceleration_mps2
    };
    let before = |way_m: f64| {
        let pose = Pose::new(4.0, 1.0 + way_m + front_m + room_m, -FRAC_PI_2);
        share(&robot, pose, Motion::Drive(0.1), &obstacles)
    };
    for (slower, faster) in [(0.5, 1.0), (SPEED_SHARE, 0.5)] {
        let found = [-1e-3, 1e-3].map(|more_m| before(stops_m(faster) + more_m));
        assert_eq!(found, [slower, faster]);
    }
}

/// Half of the clearance with which a motion was found is kept during it; a motion on its own
/// keeps the margin, or half of the present clearance.
#[test]
fn motions_keep_room() {
    let map = OccupancyGrid::from_ascii(&["########", "........", "########"]);
    let obstacles = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
    let footprint = crate::robot::Footprint::rectangle(0.8, 0.8).unwrap();
    let robot = Robot { footprint, safety_margin_m: Some(0.08), ..Robot::jackal() };
    let first = |mut motion: MotionUnderWay, y| {
        let pose = Pose::new(4.0, y, 0.0);
        let (velocity, elapsed_s) = (Velocity::ZERO, robot.cycle_s);
        let moment = moment(&robot, (pose, velocity), elapsed_s);
        matches!(motion.step(&moment, &obstacles), MotionStep::Moving(_))
    };
    let drive = Motion::Drive(1.0);
    // 0.1 m of clearance in the middle, 0.02 m beside it.
    for (y, found_with_m, is_free) in
        [(1.5, 0.19, true), (1.5, 0.21, false), (1.58, 0.03, true), (1.58, 0.05, false)]
    {
        let motion = MotionUnderWay::with_room(drive, found_with_m);
        assert_eq!(first(motion, y), is_free, "{y} {found_with_m}");
    }
    assert!(first(MotionUnderWay::new(drive), 1.58) && first(MotionUnderWay::new(drive), 1.5));
    let kept_m = |y| kept_room_m(&robot, Pose::new(4.0, y, 0.0), &obstacles);
    assert!((kept_m(1.5) - 0.9 * 0.05).abs() < 1e-9 && (kept_m(1.58) - 0.9 * 0.01).abs() < 1e-9);
    assert_eq!(kept_m(1.7), 0.0, "in contact");
}

proptest! {
    /// At any initial speed, the robot first stops, and never goes beyond the end.
    #[test]
    fn motions_never_overshoot(length_m in 0.01..2.0f64, v in 0.0..0.5f64, which in 0usize..2) {
        let robot = [Robot::small(), Robot::jackal()][which].clone();
        let start = (Pose::new(3.0, 4.0, 0.3), Velocity::new(v, 0.0));
        let stop_m = 0.5 * v * v / robot.limits.deceleration_mps2 + 0.5 * v * robot.cycle_s;
        let (pose, ended, _) = obey(Motion::Drive(length_m), &robot, start);
        let driven_m = pose.point().distance(start.0.point());
        prop_assert_eq!(ended, MotionStep::Done);
        prop_assert!(driven_m <= length_m + stop_m + 1e-9 && driven_m >= length_m - 0.01, "{}", driven_m);
    }
}
