//! Robots with several mounted sensors.

#[path = "../../keyway/tests/support/driving.rs"]
mod driving;

use driving::{bound_for, next_stamp_s};
use keyway::geometry::{Disc, Point, Pose, Velocity};
use keyway::map::OccupancyGrid;
use keyway::navigate::{Blocked, Navigator, Stack, Step};
use keyway::robot::{Mount, RangeSensor, Robot};
use keyway::sense::{Observation, Scan, SensorScan};
use keyway_sim::episode::{Cycle, Episode, EpisodeObserver, EpisodeOutcome, RunOptions};
use keyway_sim::episode::{run_episode, watch_episode};
use keyway_sim::sim::{MovingObstacle, World};

/// A sensor with one beam per degree.
fn mounted(x_m: f64, y_m: f64, yaw_deg: f64, field_of_view_deg: f64) -> RangeSensor {
    let mount = Mount { x_m, y_m, yaw_deg };
    let beams = field_of_view_deg as u32;
    RangeSensor { mount, ..RangeSensor::new(beams, field_of_view_deg, 8.0) }
}

/// Two sensors on opposite corners, as on warehouse robots: front left and rear right, 270
/// degrees each.
fn corners() -> Robot {
    let sensors = vec![mounted(0.25, 0.2, 45.0, 270.0), mounted(-0.25, -0.2, -135.0, 270.0)];
    Robot { sensors, ..Robot::jackal() }
}

fn hall() -> OccupancyGrid {
    OccupancyGrid::from_ascii(&[
        "....................",
        "....................",
        "....................",
    ])
}

fn navigator(robot: &Robot, start: Point, goal: Point) -> Navigator {
    let stack = Stack::keyway(robot).fit(robot).expect("the stack fits the robot");
    bound_for(&hall(), &stack, start, goal).expect("there is a way")
}

/// The next cycle of a stationary robot, with new scans.
fn next_step(navigator: &mut Navigator, pose: Pose, scans: &[SensorScan<'_>]) -> Step {
    let stamp_s = next_stamp_s(navigator);
    let scans: Vec<_> = scans.iter().map(|&scan| SensorScan { stamp_s, ..scan }).collect();
    navigator.observe(&Observation::new(stamp_s, pose, Velocity::ZERO, &scans));
    navigator.step()
}

/// A post is detected at its position by either sensor.
#[test]
fn a_hit_is_where_the_mount_says() {
    let robot = corners();
    let post = Disc::new(Point::new(5.0, 1.5), 0.05);
    let world = World::from_known(&hall(), vec![post]).unwrap();
    // Ahead on the left, and behind on the right.
    for (pose, sees) in [(Pose::new(4.0, 1.2, 0.4), 0), (Pose::new(6.5, 1.7, -0.3), 1)] {
        let scan = world.at(0.0).cast(pose, &robot.sensors[sees]);
        let mount = robot.sensors[sees].mount.pose();
        let from = pose.compose(mount);
        let (beam, range_m) =
            scan.ranges_m.iter().copied().enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        let bearing = from.theta + scan.bearing_rad(beam);
        let end = from.point() + Point::new(bearing.cos(), bearing.sin()) * range_m;
        assert!((end.distance(post.centre) - 0.05).abs() < 1e-9, "{end:?}");
        // The navigator marks the post, and nothing else.
        let mut navigator = navigator(&robot, pose.point(), Point::new(12.0, 1.5));
        let scans = [SensorScan { stamp_s: 0.0, sensor: sees, mount, scan: scan.borrowed() }];
        next_step(&mut navigator, pose, &scans);
        let sensed = navigator.sensed();
        assert_eq!(sensed.count_ones(), 1);
        assert!(sensed.any_in_span(1, 4, 5), "in one of the cells at the post");
    }
}

/// Two sensors at one position that share a full turn give the same map as a single one.
#[test]
fn halves_of_a_turn_are_as_good_as_all_of_it() {
    /// Number of tracked obstacles, and marked cells, cycle by cycle.
    struct Known(Vec<(usize, Vec<u64>)>);
    impl EpisodeObserver for Known {
        fn decided(&mut self, cycle: &Cycle<'_>) {
            let sensed = cycle.navigator.sensed();
            let rows = (0..sensed.height() as i32).flat_map(|y| sensed.row(y).to_vec()).collect();
            self.0.push((cycle.navigator.movers().len(), rows));
        }
    }
    let known = |sensors: Vec<RangeSensor>| {
        let robot = Robot { sensors, ..Robot::small() };
        let (start, goal) = (Point::new(1.0, 1.5), Point::new(18.0, 1.5));
        let mut episode = Episode::new(hall(), robot, start, goal);
        episode.obstacles = vec![Disc::new(Point::new(6.0, 1.4), 0.2)];
        let walker = MovingObstacle::straight(Point::new(14.0, 0.5), 0.25, Point::new(-0.4, 0.05));
        episode.movers = vec![walker.unwrap()];
        let mut known = [Known(Vec::new())];
        let report = watch_episode(&episode, RunOptions::default(), &mut known).unwrap().first();
        assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
        let [Known(known)] = known;
        (known, report.run.unwrap().time_s)
    };
    // 360 beams of a degree; each half has its beams, and both have those ahead and behind.
    let half = |yaw_deg| {
        let mount = Mount { yaw_deg, ..Mount::CENTRE };
        RangeSensor { mount, ..RangeSensor::new(181, 180.0, 8.0) }
    };
    let (whole, whole_s) = known(vec![RangeSensor::new(360, 360.0, 8.0)]);
    let (halves, halves_s) = known(vec![half(-90.0), half(90.0)]);
    let followed = |known: &[(usize, Vec<u64>)]| known.iter().filter(|it| it.0 == 1).count();
    let (one, two) = (followed(&whole), followed(&halves));
    assert!(one > 100, "the walker is followed: {one}");
    // An obstacle across the seam is detected twice, so the runs need not be equal in every
    // digit; the pedestrian may delay either robot.
    assert!(halves_s <= 1.05 * whole_s, "{whole_s} {halves_s}");
    assert!(two as f64 > 0.9 * one as f64, "one walker, followed as one: {one} {two}");
    assert!(halves.iter().all(|&(movers, _)| movers <= 1), "nobody is seen double");
    assert_eq!(whole[0].1, halves[0].1, "the first scans mark the same cells");
}

/// A robot with two lidars arrives as early as with one.
#[test]
fn two_lidars_on_corners_drive_through_a_hall() {
    let (start, goal) = (Point::new(1.0, 1.5), Point::new(18.0, 1.5));
    let mut one = Episode::new(hall(), Robot::jackal(), start, goal);
    one.obstacles =
        vec![Disc::new(Point::new(6.0, 1.0), 0.3), Disc::new(Point::new(11.0, 2.2), 0.3)];
    let two = one.clone().with_each_robot(|robot| robot.robot = corners());
    let time_s = |episode: &Episode| {
        let report = run_episode(episode).unwrap().first();
        assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
        report.run.unwrap().time_s
    };
    let (one_s, two_s) = (time_s(&one), time_s(&two));
    assert!((one_s - two_s).abs() < 0.1 * one_s, "{one_s} {two_s}");
}

/// In either order of the sensors, an obstacle that one detects between two beams of the other
/// stays.
#[test]
fn a_post_that_one_sensor_meets_is_not_cleared_by_the_other() {
    // Beams that are 10 degrees apart; those of the second are shifted by half of that.
    let sensor = |yaw_deg| {
        let mount = Mount { yaw_deg, ..Mount::CENTRE };
        RangeSensor { mount, ..RangeSensor::new(36, 360.0, 8.0) }
    };
    for yaws in [[0.0, 5.0], [5.0, 0.0]] {
        let robot = Robot { sensors: yaws.map(sensor).to_vec(), ..Robot::small() };
        let start = Point::new(4.0, 1.5);
        let mut navigator = navigator(&robot, start, Point::new(15.0, 1.5));
        let post = Disc::new(Point::new(7.0, 1.5), 0.02);
        let world = World::from_known(&hall(), vec![post]).unwrap();
        let pose = Pose::new(start.x, start.y, 0.0);
        for _ in 0..3 {
            let scans: Vec<Scan> =
                robot.sensors.iter().map(|sensor| world.at(0.0).cast(pose, sensor)).collect();
            let hits = scans.iter().flat_map(|scan| &scan.ranges_m).filter(|m| m.is_finite());
            assert_eq!(hits.count(), 1, "one beam of one sensor");
            let scans = [0, 1].map(|index| SensorScan::of(&robot, index, 0.0, &scans[index]));
            next_step(&mut navigator, pose, &scans);
            assert_eq!(navigator.sensed().count_ones(), 1, "{yaws:?}");
        }
    }
}

/// If one of two sensors fails, the robot drives with the other one; without both it stops.
#[test]
fn a_robot_drives_with_what_is_left_of_its_sensors() {
    let (start, goal) = (Point::new(1.0, 1.5), Point::new(18.0, 1.5));
    let episode = Episode::new(hall(), corners(), start, goal);
    let without = |lost: &[usize]| {
        let lost = lost.to_vec();
        let episode = episode
            .clone()
            .with_each_robot(|robot| robot.disturbances.sensor.lost.clone_from(&lost));
        run_episode(&episode).unwrap().first()
    };
    assert_eq!(without(&[1]).outcome, EpisodeOutcome::Reached);
    let blind = without(&[0, 1]);
    assert_eq!(blind.outcome, EpisodeOutcome::Stuck);
    assert!(blind.reason.unwrap().contains("no sensor has had a valid beam yet"));
    assert_eq!(blind.run.unwrap().length_m, 0.0);
}

/// The sensor with the last scan is named, and counts.
#[test]
fn silence_is_that_of_all_sensors() {
    let robot = corners();
    let start = Point::new(5.0, 1.5);
    let mut navigator = navigator(&robot, start, Point::new(15.0, 1.5));
    let scans: Vec<Scan> = robot.sensors.iter().map(Scan::of_nothing).collect();
    let mut step = |given: &[usize]| {
        let scan = |&sensor: &usize| {
            let own = sensor.min(1);
            SensorScan { sensor, ..SensorScan::of(&robot, own, 0.0, &scans[own]) }
        };
        let scans: Vec<_> = given.iter().map(scan).collect();
        let pose = Pose::new(start.x, start.y, 0.0);
        next_step(&mut navigator, pose, &scans)
    };
    let silent = |step: &Step| match step {
        Step::Blocked { why: Blocked::SensorSilent { sensor, silent_s }, .. } => {
            Some((*sensor, (silent_s * 1e9).round() / 1e9))
        }
        _ => None,
    };
    assert_eq!(silent(&step(&[])), Some((0, f64::INFINITY)), "neither has seen anything");
    assert_eq!(silent(&step(&[0, 1])), None);
    // Time-outs are 0.5 s, cycles 0.05 s. The rear sensor continues for a while.
    assert!((0..20).all(|_| silent(&step(&[1])).is_none()));
    assert!((0..10).all(|_| silent(&step(&[])).is_none()));
    assert_eq!(silent(&step(&[])), Some((1, 0.55)));
    // Scans of a sensor that the robot does not have are ignored.
    assert_eq!(silent(&step(&[5])), Some((1, 0.6)));
    assert_eq!(silent(&step(&[0])), None);
}
