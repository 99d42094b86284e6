//! Tests of the flight recorder as a caller uses it.
#![allow(clippy::unwrap_used)]

use keyway::geometry::{Point, Pose, Velocity};
use keyway::map::{CellState, GridFrame, OccupancyGrid};
use keyway::navigate::{Navigator, Stack, Step};
use keyway::robot::Robot;
use keyway::sense::{FieldOfView, Observation, Scan, SensorPoints, SensorScan};
use keyway_lab::recording::{FlightRecorder, RecordingError, decide_again};
use std::fs::File;
use std::path::Path;

/// A robot that drives in an empty hall by commands and sees a box with its camera only; its
/// clock begins before 0.
struct Drive {
    robot: Robot,
    navigator: Navigator,
    recorder: FlightRecorder<File>,
    pose: Pose,
    velocity: Velocity,
    stamp_s: f64,
}

impl Drive {
    fn new(path: &Path) -> Self {
        let robot = Robot::mir100();
        let frame = GridFrame::new(160, 100, 0.1, Pose::default()).unwrap();
        let map = OccupancyGrid::from_fn(frame, |_| CellState::Free);
        let stack = Stack::keyway(&robot).fit(&robot).unwrap();
        let mut navigator = Navigator::new(&map, &stack).unwrap();
        let pose = Pose::new(2.0, 5.0, 0.0);
        navigator.relocate(pose);
        navigator.set_goal(Point::new(12.0, 5.0)).unwrap();
        let mut recorder = FlightRecorder::new(File::create(path).unwrap()).unwrap();
        let stamp_s = -1.0;
        recorder.begin(stamp_s, &navigator).unwrap();
        Self { robot, navigator, recorder, pose, velocity: Velocity::ZERO, stamp_s }
    }

    fn cycle(&mut self) -> Step {
        let view = FieldOfView { from_rad: -0.6, to_rad: 0.6, range_min_m: 0.3, range_max_m: 3.0 };
        let boxed = (0..12).map(|i| Point::new(6.0, 4.6 + 0.05 * f64::from(i)));
        let camera = self.pose;
        let seen: Vec<Point> = boxed
            .map(|place| camera.body_from_world(place))
            .filter(|point| point.heading().abs() < 0.6 && (0.3..3.0).contains(&point.norm()))
            .collect();
        let clears = Some(view);
        let mount = Pose::default();
        let stamp_s = self.stamp_s;
        let points = [SensorPoints { stamp_s, sensor: 2, mount, points: &seen, clears }];
        let nothing: Vec<Scan> = self.robot.sensors.iter().map(Scan::of_nothing).collect();
        // The rear scanner is late.
        let scans = [0, 1].map(|sensor| {
            let made_s = stamp_s - 0.03 * sensor as f64;
            SensorScan::of(&self.robot, sensor, made_s, &nothing[sensor])
        });
        let observation =
            Observation::new(stamp_s, self.pose, self.velocity, &scans).with_points(&points);
        self.navigator.observe(&observation);
        self.recorder.observed(&observation).unwrap();
        let step = self.navigator.step();
        self.recorder.stepped(&step, &self.navigator).unwrap();
        let reached = self.robot.limits.reached(self.velocity, step.command(), self.robot.cycle_s);
        self.pose = self.pose.after_ramp(self.velocity, reached, self.robot.cycle_s);
        self.velocity = reached;
        self.stamp_s += self.robot.cycle_s;
        step
    }
}

#[test]
fn a_life_with_changes_is_decided_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("life.mcap");
    let mut drive = Drive::new(&path);
    let mut furthest_m: f64 = 0.0;
    for cycle in 0..600 {
        if cycle == 80 {
            drive.navigator.set_goal(Point::new(12.0, 3.0)).unwrap();
            drive.recorder.changed(&drive.navigator).unwrap();
        }
        if cycle == 120 {
            drive.navigator.set_speed_limit(Some(0.4)).unwrap();
            drive.recorder.changed(&drive.navigator).unwrap();
        }
        let step = drive.cycle();
        furthest_m = furthest_m.max((drive.pose.y - 5.0).abs());
        if step == Step::Arrived {
            break;
        }
    }
    assert!(drive.pose.point().distance(Point::new(12.0, 3.0)) < 0.3, "{:?}", drive.pose);
    drive.recorder.finish().unwrap();
    let (mut decided, mut scans, mut points) = (0, 0, 0);
    let flight = decide_again(&path, &mut |cycle| {
        assert_eq!(cycle.index, decided);
        decided += 1;
        scans += cycle.observation.scans.len();
        points += cycle.observation.points[0].points.len();
    });
    let flight = flight.unwrap();
    assert_eq!((flight.cycles, flight.snapshots, flight.is_complete), (decided, 3, true));
    assert!(decided > 200 && scans == 2 * decided as usize && points > 100, "{decided} {points}");
    let bytes = std::fs::read(&path).unwrap();
    let shown = mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap);
    let clouds = shown.filter(|message| message.channel.topic == "/points_2").count();
    assert_eq!(clouds as u64, decided);
}

/// A change that was not reported to the recorder is detected.
#[test]
fn an_untold_change_is_a_difference() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("life.mcap");
    let mut drive = Drive::new(&path);
    for cycle in 0..60 {
        if cycle == 30 {
            drive.navigator.set_goal(Point::new(3.0, 9.0)).unwrap();
        }
        drive.cycle();
    }
    drive.recorder.finish().unwrap();
    match decide_again(&path, &mut |_| {}) {
        Err(RecordingError::Differs { cycle, stamp_s, .. }) => {
            assert!((30..34).contains(&cycle), "{cycle}");
            assert!((stamp_s - (cycle as f64 * 0.05 - 1.0)).abs() < 1e-9, "{stamp_s}");
        }
        other => panic!("{other:?}"),
    }
}

/// A power failure: the file is not finished.
#[test]
fn what_is_more_than_a_second_old_is_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let (path, copy) = (folder.path().join("life.mcap"), folder.path().join("copy.mcap"));
    let mut drive = Drive::new(&path);
    for cycle in 0..100 {
        drive.cycle();
        if cycle % 7 == 0 {
            std::fs::copy(&path, &copy).unwrap();
            let flight = decide_again(&copy, &mut |_| {}).unwrap();
            assert!(!flight.is_complete && flight.cycles <= cycle + 1);
            assert!(flight.cycles + 21 >= cycle, "{flight:?} in cycle {cycle}");
        }
    }
}
