//! Tests of sensor failures, and of excessive goals.

use super::ground::cloud;
use super::{Act, Ended, Fault, MapError, Motion, ODOM, Robot, Wanted, goal, room, to};
use crate::messages::map_msgs::OccupancyGridUpdate;
use crate::messages::nav_msgs::Odometry;
use crate::messages::nav2_msgs::SpeedLimit;
use crate::messages::sensor_msgs::LaserScan;
use crate::messages::std_msgs::Header;
use crate::pilot::Waits;
use crate::transforms::Placement;
use keyway::geometry::{Pose, Velocity};

/// A robot that is driving across the room.
fn under_way(parameters: &[(&str, &str)]) -> Robot {
    let mut robot = Robot::with(parameters);
    robot.tell(robot.now_s);
    robot.pilot.begin(to("map", Pose::new(5.0, 2.0, 0.0)), robot.now_s).unwrap();
    robot
}

/// Transforms and scans continue, odometry does not.
#[test]
fn a_velocity_from_before_is_none() {
    let mut robot = under_way(&[]);
    for _ in 0..20 {
        assert_eq!(robot.cycle().waits, None);
    }
    let ended_s = robot.now_s;
    for _ in 0..20 {
        let now_s = robot.now_s;
        for (names, pose) in [(["map", "odom"], ODOM), (["odom", "base_link"], robot.pose)] {
            robot.pilot.transforms.insert(names, (now_s, Placement::upright(pose)), false);
        }
        let cycle = robot.pilot.cycle(now_s);
        if now_s > ended_s + 0.2 {
            assert!(matches!(cycle.waits, Some(Waits::NewOdometry { .. })), "{:?}", cycle.waits);
            assert_eq!(cycle.command, Velocity::ZERO);
        }
        robot.now_s += 0.05;
    }
    let mut none = Odometry { header: Header::new(robot.now_s, "odom"), ..Odometry::default() };
    none.twist.twist.linear.x = f64::NAN;
    robot.pilot.sensing.take_odometry(&none);
    assert!(robot.pilot.cycle(robot.now_s).waits.is_some(), "that is no velocity");
}

/// The most likely initial mistake is a wrong topic or frame.
#[test]
fn who_is_not_told_enough_says_what_is_missing() {
    let mut lost = Robot::with(&[("robot_base_frame", "base")]);
    lost.tell(lost.now_s);
    let refused = lost.pilot.begin(to("map", Pose::new(5.0, 2.0, 0.0)), lost.now_s);
    let Err(Ended::Failed { fault: Fault::Transform, why, .. }) = refused else { panic!() };
    assert!(why.contains("`base`"), "{why}");

    let mut blind = under_way(&[("scan_topics", "[front]")]);
    let waits = (0..60).find_map(|_| {
        for (names, pose) in [(["map", "odom"], ODOM), (["odom", "base_link"], blind.pose)] {
            let stamped = (blind.now_s, Placement::upright(pose));
            blind.pilot.transforms.insert(names, stamped, false);
        }
        let header = Header::new(blind.now_s, "odom");
        blind.pilot.sensing.take_odometry(&Odometry { header, ..Odometry::default() });
        blind.cycle_untold().waits
    });
    let Some(why @ Waits::Blind { .. }) = waits else { panic!("{waits:?}") };
    assert!(why.to_string().ends_with("(topics: front)"), "{why}");
}

/// The drivers run on a computer with another clock.
#[test]
fn who_has_another_clock_stands() {
    for (off_s, may_drive) in [(0.1, true), (0.5, false), (100.0, false), (-0.5, false)] {
        let mut robot = under_way(&[]);
        for _ in 0..20 {
            robot.cycle();
        }
        robot.tell(robot.now_s + off_s);
        let cycle = robot.pilot.cycle(robot.now_s);
        assert_eq!(cycle.waits.is_none(), may_drive, "{off_s}: {:?}", cycle.waits);
        assert_eq!(cycle.command != Velocity::ZERO, may_drive, "{off_s}");
    }
}

/// Transforms are missing repeatedly: the robot stops, and the motors are not blamed.
#[test]
fn standing_in_doubt_teaches_nothing_about_the_motors() {
    let mut robot = under_way(&[("robot", "small"), ("max_pose_age", "0.05")]);
    let mut stood = 0;
    for cycle in 0..300 {
        let cycle = if cycle % 5 == 0 { robot.cycle() } else { robot.cycle_untold() };
        stood += usize::from(matches!(cycle.waits, Some(Waits::NewPose { .. })));
        let doubts = robot.pilot.navigator().unwrap().doubts();
        assert!(doubts.is_empty(), "{doubts:?}");
    }
    assert!(stood > 200, "{stood}");
}

#[test]
fn a_scan_whose_bearings_cannot_be_stops_the_robot() {
    for increment in [0.0, f32::NAN, 1.0] {
        let mut robot = under_way(&[]);
        robot.cycle();
        let broken = LaserScan {
            header: Header::new(robot.now_s - 0.01, "base_scan"),
            angle_increment: increment,
            range_max: 3.5,
            ranges: vec![f32::INFINITY; 360],
            ..LaserScan::default()
        };
        robot.tell(robot.now_s);
        robot.pilot.sensing.take_scan(0, broken);
        // A good scan before it does not help.
        let cycle = robot.pilot.cycle(robot.now_s);
        assert!(matches!(cycle.waits, Some(Waits::Scan(_))), "{:?}", cycle.waits);
        robot.now_s += 0.1;
        robot.cycle();
        assert_eq!(robot.cycle().waits, None, "until one can be used");
    }
}

#[test]
fn a_camera_that_is_silent_or_nowhere_stops_the_robot() {
    let mut silent = under_way(&[("cloud_topics", "[camera]")]);
    assert!(matches!(silent.cycle().waits, Some(Waits::Silent { cloud: 0, .. })));
    let camera = Placement::upright(Pose::new(0.1, 0.0, 0.0));
    silent.pilot.transforms.insert(["base_link", "camera"], (0.0, camera), true);
    silent.pilot.sensing.take_cloud(0, cloud(silent.now_s, &[[2.0, 0.0, 0.0]]));
    assert_eq!(silent.cycle().waits, None);
    let waits: Vec<_> = (0..40).map(|_| silent.cycle().waits).collect();
    assert!(matches!(waits.last(), Some(Some(Waits::Silent { .. }))), "{waits:?}");

    // Clouds arrive in every other cycle.
    let mut nowhere = under_way(&[("cloud_topics", "[camera]")]);
    for cycle in 0..10 {
        if cycle % 2 == 0 {
            nowhere.pilot.sensing.take_cloud(0, cloud(nowhere.now_s - 0.01, &[[2.0, 0.0, 0.0]]));
        }
        let waits = nowhere.cycle().waits;
        assert!(matches!(waits, Some(Waits::Transform(_))), "{cycle}: {waits:?}");
    }
    let mut without = under_way(&[("cloud_topics", "[bumper]"), ("cloud_timeout", "0")]);
    assert_eq!(without.cycle().waits, None, "a bumper says nothing where it meets nothing");
}

/// The robot's frame is at the height of its axles.
#[test]
fn heights_are_above_the_ground() {
    let mut robot = Robot::with(&[("cloud_topics", "[camera]")]);
    let camera = Placement::default();
    robot.pilot.transforms.insert(["base_link", "camera"], (0.0, camera), true);
    let axles = Placement::new([0.5, 2.0, 0.13], [0.0, 0.0, 0.0, 1.0]).unwrap();
    // 2 cm and 10 cm above the ground.
    let points = [[1.02, 0.48, 0.02 - 0.13], [1.02, -0.48, 0.10 - 0.13]];
    for _ in 0..3 {
        robot.tell(robot.now_s);
        robot.pilot.transforms.insert(["odom", "base_link"], (robot.now_s, axles), false);
        robot.pilot.sensing.take_cloud(0, cloud(robot.now_s - 0.01, &points));
        robot.pilot.cycle(robot.now_s);
        robot.now_s += 0.1;
    }
    let navigator = robot.pilot.navigator().unwrap();
    let is_sensed = |x, y| navigator.sensed().get(navigator.map().frame().cell_near([x, y].into()));
    assert!(is_sensed(2.52, 1.52) && !is_sensed(2.52, 2.48));
}

#[test]
fn rounds_without_an_end_take_no_memory_and_end_where_nothing_can_be_reached() {
    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    let stops = |poses: &[Pose]| poses.iter().map(|&pose| goal("map", pose)).collect();
    let (far, near) = (Pose::new(9.0, 2.0, 0.0), Pose::new(2.0, 2.0, 0.0));
    let for_ever =
        |poses: &[Pose]| Wanted::Stops { poses: stops(poses), first: 0, again: u32::MAX as usize };
    robot.pilot.begin(for_ever(&[near, far]), robot.now_s).unwrap();
    let outcome = robot.pilot.begin(for_ever(&[far, far]), robot.now_s);
    assert!(matches!(outcome, Err(Ended::Failed { .. })), "{outcome:?}");
}

/// Outside the map nothing moves, but time passes.
#[test]
fn a_motion_that_cannot_begin_ends() {
    let mut robot = Robot::new();
    robot.pose = Pose::new(-30.0, 2.0, 0.0);
    robot.tell(robot.now_s);
    let turn = Act { motion: Motion::Turn(1.0), allowance_s: 2.0, most_mps: None, fault: None };
    robot.pilot.begin(Wanted::Act(turn), robot.now_s).unwrap();
    let began_s = robot.now_s;
    let ended = (0..200).find_map(|_| robot.cycle().ended).map(|(ended, _)| ended);
    assert!(matches!(ended, Some(Ended::Failed { fault: Fault::Timeout, .. })), "{ended:?}");
    assert!((2.0..4.0).contains(&(robot.now_s - began_s)));
    let refused = Act { fault: Some("of a reason"), ..turn };
    let outcome = robot.pilot.begin(Wanted::Act(refused), robot.now_s);
    assert!(matches!(outcome, Err(Ended::Failed { fault: Fault::InvalidInput, .. })));
}

/// A general speed limit does not override that of a motion.
#[test]
fn a_slow_motion_stays_slow() {
    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    let slow =
        Act { motion: Motion::Ahead(1.0), allowance_s: 0.0, most_mps: Some(0.05), fault: None };
    robot.pilot.begin(Wanted::Act(slow), robot.now_s).unwrap();
    robot.pilot.limit_speed(&SpeedLimit::default());
    let fastest_mps = (0..60).map(|_| robot.cycle().command.v).fold(0.0, f64::max);
    assert!((0.04..0.051).contains(&fastest_mps), "{fastest_mps}");
}

#[test]
fn maps_of_other_frames_and_empty_updates_are_nothing() {
    let mut robot = Robot::new();
    let mut elsewhere = room();
    elsewhere.header.frame_id = "odom".to_owned();
    let outcome = robot.pilot.take_map(&elsewhere);
    assert!(matches!(&outcome, Err(MapError::Frame(why)) if why.contains("global_frame")));
    elsewhere.header.frame_id = "/map".to_owned();
    assert_eq!(robot.pilot.take_map(&elsewhere), Ok(()));
    let empty = OccupancyGridUpdate { height: u32::MAX, ..OccupancyGridUpdate::default() };
    assert_eq!(robot.pilot.take_update(&empty), Ok(()));
}
