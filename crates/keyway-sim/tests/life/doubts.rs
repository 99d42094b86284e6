//! Contradictory inputs are noticed, and true ones cause no doubts.

use super::robot_in_a_world::{RobotInAWorld, hall, wall_with_doors};
use keyway::geometry::{Disc, Point, Pose, Velocity};
use keyway::navigate::{Blocked, Doubt};
use keyway::sense::{Observation, Scan, SensorScan};
use keyway_sim::sim::World;

fn driving() -> RobotInAWorld {
    let map = hall(wall_with_doors(&[2.0, 6.0]));
    let mut life = RobotInAWorld::new(&map, Pose::new(2.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(4.0, 5.0), 0.25)];
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life
}

/// Number of cycles until the first doubt, with given reported poses and velocities.
fn noticed(
    life: &mut RobotInAWorld,
    told: impl Fn(&RobotInAWorld, u32) -> (Pose, Velocity),
    obeys: bool,
) -> Option<(u32, Vec<Doubt>)> {
    for cycle in 0..60 {
        let world = World::from_known(&life.truth, life.posts.clone()).unwrap();
        let scan = world.at(0.0).cast(life.pose, &life.robot.sensors[0]);
        let stamp_s = life.stamp_s;
        let scans = [SensorScan::of(&life.robot, 0, stamp_s, &scan)];
        let (pose, velocity) = told(life, cycle);
        life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        if !life.navigator.doubts().is_empty() {
            return Some((cycle, life.navigator.doubts().to_vec()));
        }
        let command = life.navigator.step().command();
        life.obey(if obeys { command } else { Velocity::ZERO });
    }
    None
}

#[test]
fn what_is_true_is_not_doubted() {
    let mut life = driving();
    life.posts.push(Disc::new(Point::new(9.0, 4.0), 0.2));
    while life.navigator.guidance().unwrap().remaining_m > 0.3 {
        life.cycle();
        assert_eq!(life.navigator.doubts(), [], "{:?}", life.pose);
    }
    // Braking, stopping, turning and starting again.
    life.navigator.cancel();
    life.drive_for(4.0);
    life.navigator.spin(3.0, 30.0).unwrap();
    for _ in 0..150 {
        life.cycle();
        assert_eq!(life.navigator.doubts(), [], "{:?}", life.pose);
    }
}

#[test]
fn a_velocity_that_is_always_0_is_noticed() {
    let mut life = driving();
    let (cycle, doubts) = noticed(&mut life, |life, _| (life.pose, Velocity::ZERO), true).unwrap();
    assert_eq!(doubts, [Doubt::VelocityAlwaysZero]);
    assert!(cycle <= 22, "{cycle}");
}

#[test]
fn a_robot_that_does_not_move_is_noticed() {
    let mut life = driving();
    let (cycle, doubts) = noticed(&mut life, |life, _| (life.pose, life.velocity), false).unwrap();
    assert_eq!(doubts, [Doubt::DoesNotMove]);
    assert!(cycle <= 40, "{cycle}");
}

#[test]
fn a_robot_that_is_pushed_is_noticed() {
    let mut life = driving();
    life.navigator.cancel();
    let pushed = |life: &RobotInAWorld, cycle: u32| {
        let away_m = 0.01 * f64::from(cycle);
        (Pose::new(life.pose.x + away_m, life.pose.y, 0.0), Velocity::new(0.0, 1e-9))
    };
    let (cycle, doubts) = noticed(&mut life, pushed, true).unwrap();
    assert_eq!(doubts, [Doubt::MovesUntold]);
    assert!(cycle <= 22, "{cycle}");
}

#[test]
fn a_scan_that_is_given_again_is_noticed() {
    let mut life = driving();
    life.drive_for(2.0);
    let world = World::from_known(&life.truth, life.posts.clone()).unwrap();
    let scan = world.at(0.0).cast(life.pose, &life.robot.sensors[0]);
    let mut sensed = None;
    for cycle in 0..4 {
        let (stamp_s, pose, velocity) = (life.stamp_s, life.pose, life.velocity);
        let scans = [SensorScan::of(&life.robot, 0, stamp_s, &scan)];
        life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        let expected: &[Doubt] =
            if cycle == 0 { &[] } else { &[Doubt::ScanRepeated { sensor: 0 }] };
        assert_eq!(life.navigator.doubts(), expected, "{cycle}");
        // The post keeps its position.
        let seen = life.navigator.sensed().clone();
        assert_eq!(*sensed.get_or_insert(seen), *life.navigator.sensed(), "{cycle}");
        life.navigator.step();
        life.obey(Velocity::new(0.4, 0.0));
    }
    life.drive_for(2.2);
    assert_eq!(life.navigator.doubts(), [], "it is over");
}

/// A sensor that hangs keeps the robot stationary once it is blind, however often its driver gives
/// the same scan a new stamp. The first other scan lets it go on.
#[test]
fn a_sensor_that_hangs_keeps_the_robot_stationary() {
    let mut life = driving();
    life.drive_for(2.0);
    let world = World::from_known(&life.truth, life.posts.clone()).unwrap();
    let cast = |life: &RobotInAWorld| world.at(0.0).cast(life.pose, &life.robot.sensors[0]);
    let hanging = cast(&life);
    let cycle = |life: &mut RobotInAWorld, scan: &Scan| {
        let (stamp_s, pose, velocity) = (life.stamp_s, life.pose, life.velocity);
        let scans = [SensorScan::of(&life.robot, 0, stamp_s, scan)];
        life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        let step = life.navigator.step();
        life.obey(step.command());
        step
    };
    for _ in 0..20 {
        cycle(&mut life, &hanging);
    }
    assert_eq!(life.velocity, Velocity::ZERO);
    let stopped = life.pose;
    for _ in 0..60 {
        let step = cycle(&mut life, &hanging);
        assert!(matches!(step.why(), Some(Blocked::SensorSilent { .. })), "{step:?}");
        assert_eq!(life.navigator.doubts(), [Doubt::ScanRepeated { sensor: 0 }]);
    }
    assert_eq!(life.pose, stopped);
    for _ in 0..30 {
        let scan = cast(&life);
        cycle(&mut life, &scan);
    }
    assert!(life.pose.x > stopped.x + 0.2, "{:?}", life.pose);
    assert_eq!(life.navigator.doubts(), []);
}

/// Without noise, the scans of a robot that is stationary are the same. One wrong pose and velocity
/// make no sensor hang.
#[test]
fn one_wrong_velocity_does_not_blind_a_robot_for_ever() {
    let mut life = driving();
    life.drive_for(2.0);
    life.navigator.cancel();
    life.drive_for(3.0);
    let world = World::from_known(&life.truth, life.posts.clone()).unwrap();
    let scan = world.at(0.0).cast(life.pose, &life.robot.sensors[0]);
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    let (true_pose, mut blind) = (life.pose, 0);
    for cycle in 0..30 {
        let is_wrong = cycle == 3;
        let [off_rad, omega_radps] = if is_wrong { [0.05, 0.3] } else { [0.0, 0.0] };
        let pose = Pose { theta: true_pose.theta + off_rad, ..true_pose };
        let velocity = Velocity::new(0.0, omega_radps);
        let scans = [SensorScan::of(&life.robot, 0, life.stamp_s, &scan)];
        life.navigator.observe(&Observation::new(life.stamp_s, pose, velocity, &scans));
        let step = life.navigator.step();
        blind += u32::from(matches!(step.why(), Some(Blocked::SensorSilent { .. })));
        life.obey(Velocity::ZERO);
    }
    assert_eq!(blind, 0);
}

/// Degrees, millimetres, and stamps of another clock.
#[test]
fn scans_that_cannot_be_used_are_named() {
    let fault = |change: fn(&mut Scan, &mut f64)| {
        let mut life = driving();
        let world = World::from_known(&life.truth, life.posts.clone()).unwrap();
        let mut scan = world.at(0.0).cast(life.pose, &life.robot.sensors[0]);
        let mut stamp_s = life.stamp_s;
        change(&mut scan, &mut stamp_s);
        let scans = [SensorScan::of(&life.robot, 0, stamp_s, &scan)];
        let observation = Observation::new(life.stamp_s, life.pose, life.velocity, &scans);
        life.navigator.observe(&observation);
        life.navigator.doubts().iter().map(Doubt::to_string).collect::<Vec<_>>().join("; ")
    };
    assert_eq!(fault(|_, _| {}), "");
    let degrees = fault(|scan, _| scan.angle_increment_rad = 1.0);
    assert!(degrees.contains("sensor 0") && degrees.contains("in radians"), "{degrees}");
    let millimetres = fault(|scan, _| scan.ranges_m.iter_mut().for_each(|m| *m *= 1000.0));
    assert!(millimetres.contains("give metres"), "{millimetres}");
    let ahead = fault(|_, stamp_s| *stamp_s += 5.0);
    assert!(ahead.contains("stamped 5.0 s ahead of the pose"), "{ahead}");
    let behind = fault(|_, stamp_s| *stamp_s -= 3.0);
    assert!(behind.contains("stamped 3.0 s behind the pose"), "{behind}");
}

/// In the open, scans are all alike. Many lidars give 0 for beams that parts of the robot mask.
#[test]
fn a_scan_of_nothing_is_not_a_scan_given_again() {
    let mut life = driving();
    let mut scan = Scan::of_nothing(&life.robot.sensors[0]);
    scan.ranges_m[100] = 0.0;
    for _ in 0..20 {
        let (stamp_s, pose, velocity) = (life.stamp_s, life.pose, life.velocity);
        let scans = [SensorScan::of(&life.robot, 0, stamp_s, &scan)];
        life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        assert_eq!(life.navigator.doubts(), []);
        life.navigator.step();
        life.obey(Velocity::new(0.4, 0.0));
    }
}

/// Between two endless parallel walls, a scan without noise is the same everywhere: the sensor is
/// not silent.
#[test]
fn a_corridor_that_is_all_alike_is_driven_through() {
    let map = hall(|place| !(3.5..4.5).contains(&place.y));
    let mut life = RobotInAWorld::new(&map, Pose::new(4.0, 4.0, 0.0));
    life.navigator.set_goal(Point::new(8.0, 4.0)).unwrap();
    let world = World::from_known(&life.truth, Vec::new()).unwrap();
    let scan = world.at(0.0).cast(life.pose, &life.robot.sensors[0]);
    for _ in 0..60 {
        let (stamp_s, pose, velocity) = (life.stamp_s, life.pose, life.velocity);
        let scans = [SensorScan::of(&life.robot, 0, stamp_s, &scan)];
        life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        let command = life.navigator.step().command();
        life.obey(command);
    }
    assert!(life.pose.x > 6.0, "{:?}", life.pose);
}

/// The localisation jumps by 0.3 m and 10 degrees: the jump is reported, and the post keeps its
/// position relative to the robot.
#[test]
fn a_jump_is_noticed_and_what_was_sensed_goes_with_it() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(3.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(5.0, 4.0), 0.2)];
    life.drive_for(2.0);
    let sensed_there = |life: &RobotInAWorld, place: Point| {
        let (frame, sensed) = (*life.truth.frame(), life.navigator.sensed());
        let cells = frame.cells().filter(|&cell| sensed.get(cell));
        cells.filter(|&cell| frame.world_from_cell(cell).distance(place) < 0.12).count()
    };
    let face = Point::new(4.8, 4.0);
    assert!(sensed_there(&life, face) >= 3);
    life.told = |pose| Pose::new(pose.x - 0.2, pose.y + 0.22, pose.theta + 0.17);
    // Without a scan, so that all cells sensed there are from before.
    let (stamp_s, velocity, pose) = (life.stamp_s, life.velocity, (life.told)(life.pose));
    life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &[]));
    let [Doubt::PoseJumped { by_m, by_rad }] = life.navigator.doubts() else { panic!() };
    assert!((by_m - 0.297).abs() < 0.01 && (by_rad - 0.17).abs() < 1e-9, "{by_m} {by_rad}");
    let moved = pose.world_from_body(life.pose.body_from_world(face));
    assert!(sensed_there(&life, moved) >= 3 && sensed_there(&life, face) == 0);
    // Back to the correct pose.
    life.told = |pose| pose;
    life.cycle();
    assert!(sensed_there(&life, face) >= 3);
}
