//! Tests of the pilot with a robot that follows commands at once, in a mapped room.

mod faults;
mod ground;

use super::*;
use crate::arguments::Arguments;
use crate::messages::geometry_msgs::PoseStamped;
use crate::messages::nav_msgs::{MapMetaData, OccupancyGrid, Odometry, Path};
use crate::messages::nav2_msgs::SpeedLimit;
use crate::messages::sensor_msgs::LaserScan;
use crate::messages::std_msgs::Header;
use crate::transforms::Placement;
use keyway::geometry::Point;

/// A robot, and the frames and messages of its drivers.
pub(crate) struct Robot {
    pub(crate) pilot: Pilot,
    /// In the frame `odom`, whose origin is 1 m to the right of the map's origin.
    pub(crate) pose: Pose,
    velocity: Velocity,
    pub(crate) now_s: f64,
    /// True if the wheels slip.
    pub(crate) slips: bool,
}

const ODOM: Pose = Pose { x: 1.0, y: 0.0, theta: 0.0 };

/// A room of 6 m x 4 m in cells of 5 cm, with walls around it.
pub(crate) fn room() -> OccupancyGrid {
    let (width, height) = (120, 80);
    let is_wall = |x: u32, y: u32| x == 0 || y == 0 || x + 1 == width || y + 1 == height;
    let cells = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let info = MapMetaData { resolution: 0.05, width, height, ..MapMetaData::default() };
    let data = cells.map(|(x, y)| if is_wall(x, y) { 100 } else { 0 }).collect();
    OccupancyGrid { header: Header::new(0.0, "map"), info, data }
}

fn settings() -> Settings {
    settings_with(&[])
}

fn settings_with(parameters: &[(&str, &str)]) -> Settings {
    let given = [("robot", "waffle")].iter().chain(parameters);
    let parameters = given.map(|&(name, value)| (name.to_owned(), value.to_owned())).collect();
    Settings::of(&Arguments { parameters, ..Arguments::default() }, None).unwrap()
}

impl Robot {
    fn new() -> Self {
        Self::with(&[])
    }

    /// Creates a robot with these parameters.
    pub(crate) fn with(parameters: &[(&str, &str)]) -> Self {
        let mut robot = Self::without_map(parameters);
        robot.pilot.take_map(&room()).unwrap();
        robot
    }

    pub(crate) fn without_map(parameters: &[(&str, &str)]) -> Self {
        let (pose, velocity) = (Pose::new(0.5, 2.0, 0.0), Velocity::ZERO);
        let mut pilot = Pilot::new(settings_with(parameters));
        let mount = Placement::upright(Pose::default());
        pilot.transforms.insert(["base_link", "base_scan"], (0.0, mount), true);
        Self { pilot, pose, velocity, now_s: 100.0, slips: false }
    }

    /// The true pose in the map.
    fn in_map(&self) -> Pose {
        ODOM.compose(self.pose)
    }

    /// Publishes all inputs of the drivers with this stamp.
    pub(crate) fn tell(&mut self, stamp_s: f64) {
        for (names, pose) in [(["map", "odom"], ODOM), (["odom", "base_link"], self.pose)] {
            self.pilot.transforms.insert(names, (stamp_s, Placement::upright(pose)), false);
        }
        let mut odometry = Odometry { header: Header::new(stamp_s, "odom"), ..Odometry::default() };
        odometry.twist.twist = self.velocity.into();
        self.pilot.sensing.take_odometry(&odometry);
        let beams = 360;
        let scan = LaserScan {
            header: Header::new(stamp_s, "base_scan"),
            angle_increment: std::f32::consts::TAU / beams as f32,
            range_min: 0.1,
            range_max: 3.5,
            ranges: vec![f32::INFINITY; beams],
            ..LaserScan::default()
        };
        self.pilot.sensing.take_scan(0, scan);
    }

    /// Runs one cycle and executes its command.
    pub(crate) fn cycle(&mut self) -> Cycle {
        self.tell(self.now_s);
        self.cycle_untold()
    }

    /// The same without inputs.
    fn cycle_untold(&mut self) -> Cycle {
        let cycle = self.pilot.cycle(self.now_s);
        let cycle_s = self.pilot.settings.stack.robot().cycle_s;
        if !self.slips {
            self.pose = self.pose.after_ramp(self.velocity, cycle.command, cycle_s);
        }
        (self.velocity, self.now_s) = (cycle.command, self.now_s + cycle_s);
        cycle
    }

    /// Drives until the task ends, for a minute at most.
    fn drive(&mut self) -> Option<Ended> {
        (0..600).find_map(|_| self.cycle().ended).map(|(ended, _)| ended)
    }
}

pub(crate) fn goal(frame: &str, pose: Pose) -> PoseStamped {
    PoseStamped { header: Header::new(0.0, frame), pose: pose.into() }
}

/// A task to drive to a pose.
fn to(frame: &str, pose: Pose) -> Wanted {
    Wanted::Poses(vec![goal(frame, pose)])
}

#[test]
fn it_drives_to_a_pose() {
    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    let wanted = to("map", Pose::new(5.0, 1.0, 1.0));
    robot.pilot.begin(wanted, robot.now_s).unwrap();
    let began_s = robot.now_s;
    assert_eq!(robot.cycle().waits, None);
    let report = robot.pilot.report(robot.now_s).unwrap();
    assert!((3.6..4.2).contains(&report.way_m), "{report:?}");
    assert_eq!(robot.drive(), Some(Ended::Succeeded));
    let pose = robot.pilot.pose.unwrap();
    assert!(pose.point().distance(Point::new(5.0, 1.0)) < 0.15 && (pose.theta - 1.0).abs() < 0.2);
    assert!(robot.now_s - began_s < 40.0 && robot.cycle().command == Velocity::ZERO);
}

/// Goals in the frames of the odometry and of the robot are converted.
#[test]
fn goals_have_frames() {
    for (frame, pose) in
        [("odom", Pose::new(3.0, 2.0, 0.0)), ("base_link", Pose::new(2.5, 0.0, 0.0))]
    {
        let mut robot = Robot::new();
        robot.tell(robot.now_s);
        robot.pilot.begin(to(frame, pose), robot.now_s).unwrap();
        assert_eq!(robot.drive(), Some(Ended::Succeeded));
        let reached = robot.pilot.pose.unwrap().point();
        assert!(reached.distance(Point::new(4.0, 2.0)) < 0.15, "{frame}: {reached:?}");
    }
}

#[test]
fn it_drives_along_a_path() {
    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    let header = Header::new(0.0, "odom");
    let corners = [Point::new(0.5, 2.0), Point::new(2.0, 3.0), Point::new(3.5, 2.0)];
    let mut path = Path::new(&header, &corners, None);
    // Poses without a frame are in that of the path.
    path.poses.iter_mut().for_each(|pose| pose.header.frame_id.clear());
    robot.pilot.begin(Wanted::Path(path), robot.now_s).unwrap();
    let mut highest_m = 0.0f64;
    let ended = (0..600).find_map(|_| {
        let ended = robot.cycle().ended;
        highest_m = highest_m.max(robot.pose.y);
        ended
    });
    assert_eq!(ended.map(|(ended, _)| ended), Some(Ended::Succeeded));
    assert!((2.6..3.2).contains(&highest_m), "{highest_m}");
}

/// If any input is missing, the robot stops and reports it.
#[test]
fn without_something_it_stands() {
    let mut pilot = Pilot::new(settings());
    assert_eq!(pilot.cycle(100.0).waits, Some(Waits::Map));
    pilot.take_map(&room()).unwrap();
    let Some(Waits::Transform(error)) = pilot.cycle(100.0).waits else { panic!() };
    assert!(error.to_string().contains("`map`"), "{error}");
    for (names, pose) in
        [(["map", "odom"], ODOM), (["odom", "base_link"], Pose::new(0.5, 2.0, 0.0))]
    {
        pilot.transforms.insert(names, (100.0, Placement::upright(pose)), false);
    }
    assert_eq!(pilot.cycle(100.0).waits, Some(Waits::Odometry));
    let odometry = Odometry { header: Header::new(100.0, "odom"), ..Odometry::default() };
    pilot.sensing.take_odometry(&odometry);
    let outcome = pilot.begin(to("camera", Pose::default()), 100.0);
    let Err(Ended::Failed { fault: Fault::Transform, why }) = outcome else { panic!() };
    assert!(why.contains("camera"), "{why}");
}

/// A pose older than allowed stops the robot, in the first cycle in which it is.
#[test]
fn an_old_pose_is_none() {
    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    let wanted = to("map", Pose::new(5.0, 2.0, 0.0));
    robot.pilot.begin(wanted, robot.now_s).unwrap();
    (0..30).for_each(|_| drop(robot.cycle()));
    let told_s = robot.now_s;
    robot.tell(told_s);
    for (age_s, is_old) in [(0.0, false), (0.1, false), (0.19, false), (0.21, true), (5.0, true)] {
        let cycle = robot.pilot.cycle(told_s + age_s);
        let waits = matches!(cycle.waits, Some(Waits::NewPose { .. }));
        assert_eq!((waits, cycle.command == Velocity::ZERO), (is_old, is_old), "{age_s}");
    }
    let given_up = robot.pilot.cycle(told_s + 62.0);
    let Some((Ended::Failed { fault: Fault::Transform, .. }, _)) = given_up.ended else {
        panic!("{given_up:?}")
    };
    robot.now_s = told_s + 70.0;
    robot.tell(robot.now_s);
    robot.pilot.begin(to("map", Pose::new(5.0, 2.0, 0.0)), robot.now_s).unwrap();
    assert_eq!(robot.drive(), Some(Ended::Succeeded), "once there is one again");
}

#[test]
fn goals_that_cannot_be_reached_have_numbers() {
    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    for (pose, expected) in [
        (Pose::new(9.0, 2.0, 0.0), Fault::GoalOutsideMap),
        (Pose::new(0.02, 2.0, 0.0), Fault::GoalOccupied),
        (Pose::new(f64::NAN, 2.0, 0.0), Fault::Transform),
    ] {
        let outcome = robot.pilot.begin(to("map", pose), robot.now_s);
        let Err(Ended::Failed { fault, .. }) = outcome else { panic!("{outcome:?}") };
        assert_eq!(fault, expected, "{pose:?}");
    }
    let empty = Wanted::Path(Path::default());
    let outcome = robot.pilot.begin(empty, robot.now_s);
    assert!(matches!(outcome, Err(Ended::Failed { fault: Fault::InvalidPath, .. })));
}

#[test]
fn a_way_is_found_without_driving() {
    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    let end = goal("map", Pose::new(5.0, 2.0, 0.5));
    let (points, heading_rad) =
        robot.pilot.path(None, std::slice::from_ref(&end), robot.now_s).unwrap();
    assert!(points[0].distance(Point::new(1.5, 2.0)) < 0.06 && heading_rad == 0.5, "{points:?}");
    let from = goal("odom", Pose::new(2.0, 1.0, 0.0));
    let (points, _) = robot.pilot.path(Some(&from), &[end], robot.now_s).unwrap();
    assert!(points[0].distance(Point::new(3.0, 1.0)) < 0.06, "{points:?}");
    assert_eq!(robot.cycle().command, Velocity::ZERO);
}

#[test]
fn speed_limits_hold() {
    let fastest = |percentage, most| {
        let mut robot = Robot::new();
        robot.tell(robot.now_s);
        let wanted = to("map", Pose::new(5.0, 2.0, 0.0));
        robot.pilot.begin(wanted, robot.now_s).unwrap();
        robot.pilot.limit_speed(&SpeedLimit { percentage, most, ..SpeedLimit::default() });
        (0..60).map(|_| robot.cycle().command.v).fold(0.0, f64::max)
    };
    let most_mps = settings().stack.robot().limits.v_max_mps;
    let half_mps = fastest(true, 50.0);
    assert!((half_mps - 0.5 * most_mps).abs() < 1e-3, "{half_mps}");
    assert!((fastest(false, 0.1) - 0.1).abs() < 1e-3);
    assert!((fastest(false, 0.0) - most_mps).abs() < 1e-3);
}

#[test]
fn maps_that_cannot_be_used_change_nothing() {
    let mut robot = Robot::new();
    let mut short = room();
    short.data.pop();
    assert!(matches!(robot.pilot.take_map(&short), Err(MapError::Count { .. })));
    let mut nowhere = room();
    nowhere.info.origin.orientation.w = 0.0;
    assert_eq!(robot.pilot.take_map(&nowhere), Err(MapError::Origin));
    let mut flat = room();
    flat.info.resolution = 0.0;
    assert!(matches!(robot.pilot.take_map(&flat), Err(MapError::Frame(_))));
    robot.tell(robot.now_s);
    let wanted = to("map", Pose::new(5.0, 2.0, 0.0));
    assert_eq!(robot.pilot.begin(wanted, robot.now_s), Ok(()));
}

/// Via a pose, and with stops, of which one cannot be reached, from there on and once more.
#[test]
fn it_drives_to_several_poses() {
    let poses = [Pose::new(3.0, 3.2, 0.0), Pose::new(9.0, 2.0, 0.0), Pose::new(4.0, 1.0, 0.0)];
    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    let by_way_of = [poses[0], poses[2]].map(|pose| goal("map", pose)).to_vec();
    robot.pilot.begin(Wanted::Poses(by_way_of), robot.now_s).unwrap();
    let mut highest_m = 0.0f64;
    let ended = (0..600).find_map(|_| {
        highest_m = highest_m.max(robot.pose.y);
        robot.cycle().ended
    });
    let Some((Ended::Succeeded, report)) = ended else { panic!("{ended:?}") };
    assert!(highest_m > 2.9 && report.passed == 1, "{highest_m} {report:?}");

    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    let stops = |poses: &[Pose]| poses.iter().map(|&pose| goal("map", pose)).collect();
    let twice = Wanted::Stops { poses: stops(&poses), first: 1, again: 1 };
    robot.pilot.begin(twice, robot.now_s).unwrap();
    let ended = (0..1200).find_map(|_| robot.cycle().ended);
    let Some((Ended::Succeeded, report)) = ended else { panic!("{ended:?}") };
    let missed: Vec<usize> = report.made.missed.iter().map(|missed| missed.stop).collect();
    assert_eq!((report.made.stop, missed), (0, vec![1, 1]));
    assert!(report.pose.point().distance(poses[2].point()) < 0.15, "{report:?}");
    let no_stops = Wanted::Stops { poses: Vec::new(), first: 0, again: 3 };
    for empty in [Wanted::Poses(Vec::new()), no_stops] {
        let outcome = robot.pilot.begin(empty, robot.now_s);
        assert!(matches!(outcome, Err(Ended::Failed { fault: Fault::NoGoals, .. })));
    }
}

/// Turns, drives, waits; and a drive that a wall blocks.
#[test]
fn it_does_single_motions() {
    let act = |motion, allowance_s| {
        Wanted::Act(Act { motion, allowance_s, most_mps: Some(0.1), fault: None })
    };
    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    let mut does = |wanted| {
        robot.pilot.begin(wanted, robot.now_s).unwrap();
        let (began, began_s, mut fastest_mps) = (robot.pose, robot.now_s, 0.0f64);
        let (ended, report) = (0..900)
            .find_map(|_| {
                let cycle = robot.cycle();
                fastest_mps = fastest_mps.max(cycle.command.v.abs());
                cycle.ended
            })
            .unwrap();
        let moved_m = robot.pose.point().distance(began.point());
        (ended, report.made, moved_m, robot.now_s - began_s, fastest_mps)
    };
    let (ended, made, moved_m, ..) = does(act(Motion::Turn(2.0), 20.0));
    assert_eq!(ended, Ended::Succeeded);
    assert!((made.turned_rad - 2.0).abs() < 0.05 && moved_m < 0.01, "{made:?}");
    let (ended, made, moved_m, _, fastest_mps) = does(act(Motion::Ahead(0.4), 20.0));
    assert_eq!(ended, Ended::Succeeded);
    assert!((moved_m - 0.4).abs() < 0.02 && (made.driven_m - 0.4).abs() < 0.02, "{made:?}");
    assert!(fastest_mps < 0.11, "{fastest_mps}");
    let (ended, _, _, passed_s, _) = does(Wanted::Wait(2.0));
    assert!(ended == Ended::Succeeded && (1.9..2.3).contains(&passed_s), "{passed_s}");
    let (ended, ..) = does(act(Motion::Ahead(30.0), 20.0));
    assert!(matches!(ended, Ended::Failed { fault: Fault::NoRoom, .. }), "{ended:?}");
    let (ended, ..) = does(act(Motion::Ahead(0.5), 0.5));
    assert!(matches!(ended, Ended::Failed { fault: Fault::Timeout, .. }), "{ended:?}");
    let outcome = robot.pilot.begin(act(Motion::Ahead(-1.0), 5.0), robot.now_s);
    assert!(matches!(outcome, Err(Ended::Failed { fault: Fault::InvalidInput, .. })));
}

#[test]
fn a_path_is_made_smooth() {
    let mut robot = Robot::new();
    let header = Header::new(0.0, "map");
    let zigzag = [[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 3.0], [5.0, 3.0]].map(Point::from);
    let (points, fits) = robot.pilot.smoothed(&Path::new(&header, &zigzag, None)).unwrap();
    let length_m: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    assert!(fits && length_m < 5.5 && points[0] == zigzag[0], "{length_m} {points:?}");
    let wall = [Point::new(1.0, 1.0), Point::new(1.0, 3.99)];
    assert!(!robot.pilot.smoothed(&Path::new(&header, &wall, None)).unwrap().1);
    let nothing = robot.pilot.smoothed(&Path::default());
    assert!(matches!(nothing, Err(Ended::Failed { fault: Fault::InvalidPath, .. })));
}

/// A task ends when the node is deactivated, and no task starts until it is activated.
#[test]
fn a_node_that_is_stopped_does_not_drive() {
    let mut robot = Robot::new();
    robot.tell(robot.now_s);
    let wanted = to("map", Pose::new(5.0, 2.0, 0.0));
    robot.pilot.begin(wanted.clone(), robot.now_s).unwrap();
    (0..10).for_each(|_| drop(robot.cycle()));
    robot.pilot.set_active(false);
    let cycle = robot.cycle();
    assert!(matches!(cycle.ended, Some((Ended::Failed { .. }, _))), "{cycle:?}");
    assert!(!robot.pilot.is_active() && robot.pilot.begin(wanted.clone(), robot.now_s).is_err());
    (0..20).for_each(|_| drop(robot.cycle()));
    assert_eq!(robot.velocity, Velocity::ZERO);
    robot.pilot.set_active(true);
    robot.pilot.begin(wanted, robot.now_s).unwrap();
    assert_eq!(robot.drive(), Some(Ended::Succeeded));
}

/// 254 is a wall, 253 a cell where the robot's centre is in contact, 0 far from all obstacles.
#[test]
fn costs_are_those_of_nav2() {
    let robot = Robot::new();
    let costmap = robot.pilot.costmap(crate::costmaps::Shown::Global, 1.0).unwrap();
    assert_eq!((costmap.metadata.size_x, costmap.metadata.size_y), (120, 80));
    let cost = |x: usize, y: usize| costmap.data[y * 120 + x];
    assert_eq!((cost(0, 40), cost(1, 40), cost(60, 40)), (254, 253, 0));
    assert!((1..253).contains(&cost(8, 40)), "{}", cost(8, 40));
}

#[test]
fn maps_come_from_files() {
    let mut robot = Robot::new();
    let file = tempfile::Builder::new().suffix(".map").tempfile().unwrap();
    std::fs::write(file.path(), "type octile\nheight 2\nwidth 3\nmap\n..@\n...\n").unwrap();
    let url = format!("file://{}", file.path().display());
    let loaded = robot.pilot.load_map(&url, 1.0).unwrap();
    assert_eq!((loaded.info.width, loaded.info.height), (3, 2));
    assert_eq!(loaded.data, [0, 0, 0, 0, 0, 100]);
    let missing = robot.pilot.load_map("/nowhere.yaml", 1.0);
    assert!(matches!(missing, Err(UrlError::Missing(_))));
    std::fs::write(file.path(), "nonsense").unwrap();
    assert!(matches!(robot.pilot.load_map(&url, 1.0), Err(UrlError::File(_))));
}
