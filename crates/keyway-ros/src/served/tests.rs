//! Tests of every error code, with its cause.

use super::{Asks, Drives, Told};
use crate::messages::builtin_interfaces::Duration;
use crate::messages::geometry_msgs::{PoseStamped, Vector3};
use crate::messages::nav_msgs::{Goals, Path};
use crate::messages::nav2_msgs::{
    ComputePathToPose, ComputePathToPoseGoal, FollowPath, FollowPathGoal, NavigateToPose,
    NavigateToPoseGoal, SmoothPath, SmoothPathGoal, Wait, WaitGoal, jazzy, kilted,
};
use crate::messages::std_msgs::Header;
use crate::pilot::Report;
use crate::pilot::tests::{Robot, goal, room};
use keyway::geometry::{Point, Pose};

const TOLD: Told<'static> = Told { now_s: 100.0, frame: "map" };

/// A fault of the test setup.
#[derive(Clone, Copy, Debug)]
enum Wrong {
    Nothing,
    NoMap,
    Inactive,
    /// A wall across the room.
    WallAcross,
    BesideTheMap,
    InAWall,
    Slips,
    /// The pose is no longer published.
    Lost,
}

fn robot(name: &str, wrong: Wrong) -> Robot {
    let parameters = [("robot", name)];
    let mut robot = match wrong {
        Wrong::NoMap => Robot::without_map(&parameters),
        _ => Robot::with(&parameters),
    };
    match wrong {
        Wrong::Inactive => robot.pilot.set_active(false),
        Wrong::WallAcross => {
            let mut map = room();
            let width = map.info.width as usize;
            map.data.iter_mut().skip(60).step_by(width).for_each(|cell| *cell = 100);
            robot.pilot.take_map(&map).unwrap();
        }
        Wrong::BesideTheMap => robot.pose.x = -30.0,
        Wrong::InAWall => robot.pose.x = -0.95,
        Wrong::Slips => robot.slips = true,
        Wrong::Nothing | Wrong::NoMap | Wrong::Lost => {}
    }
    robot.tell(robot.now_s);
    robot
}

/// The outcome of an action, within two minutes.
fn outcome<A: Drives>(name: &str, goal: A::Goal, wrong: Wrong) -> A::Outcome {
    let mut robot = robot(name, wrong);
    if let Err(ended) = robot.pilot.begin(A::wanted(goal), robot.now_s) {
        return A::outcome(&ended, &Report::default());
    }
    for _ in 0..2400 {
        let ended = match wrong {
            Wrong::Lost => {
                robot.now_s += 0.1;
                robot.pilot.cycle(robot.now_s).ended
            }
            _ => robot.cycle().ended,
        };
        if let Some((ended, report)) = ended {
            return A::outcome(&ended, &report);
        }
    }
    panic!("it does not end: {wrong:?}");
}

fn there(frame: &str, x: f64) -> PoseStamped {
    goal(frame, Pose::new(x, 2.0, 0.0))
}

/// A path along the middle of the room.
fn path(frame: &str, places: &[f64]) -> Path {
    let points: Vec<Point> = places.iter().map(|&x| Point::new(x, 2.0)).collect();
    Path::new(&Header::new(0.0, frame), &points, None)
}

/// A fault of the poses, and the last digits of its code.
const POSES: [(&str, f64, Wrong, u16); 6] = [
    ("nowhere", 5.0, Wrong::Nothing, 2),
    ("map", 5.0, Wrong::BesideTheMap, 3),
    ("map", 60.0, Wrong::Nothing, 4),
    ("map", 5.0, Wrong::InAWall, 5),
    ("map", 5.98, Wrong::Nothing, 6),
    ("map", 5.0, Wrong::WallAcross, 8),
];

#[test]
fn ways_that_cannot_be_driven() {
    let to_pose = |frame, x, wrong| {
        let goal = NavigateToPoseGoal { pose: there(frame, x), ..NavigateToPoseGoal::default() };
        outcome::<NavigateToPose>("waffle", goal, wrong).error_code
    };
    let through = |poses: &[PoseStamped], wrong| {
        let goals = Goals { goals: poses.to_vec(), ..Goals::default() };
        let of_kilted = kilted::NavigateThroughPosesGoal { poses: goals, ..Default::default() };
        let of_jazzy =
            jazzy::NavigateThroughPosesGoal { poses: poses.to_vec(), ..Default::default() };
        let code = outcome::<kilted::NavigateThroughPoses>("waffle", of_kilted, wrong).error_code;
        let same = outcome::<jazzy::NavigateThroughPoses>("waffle", of_jazzy, wrong).error_code;
        assert_eq!(code, same);
        code
    };
    for (frame, x, wrong, digits) in POSES {
        assert_eq!(to_pose(frame, x, wrong), 200 + digits);
        assert_eq!(
            through(&[there("map", 2.0), there(frame, x)], wrong),
            300 + digits,
            "{wrong:?}"
        );
    }
    for (wrong, code) in [(Wrong::Slips, 105), (Wrong::Lost, 202), (Wrong::NoMap, 9000)] {
        assert_eq!(to_pose("map", 5.0, wrong), code, "{wrong:?}");
    }
    assert_eq!(to_pose("map", 5.0, Wrong::Inactive), 9000);
    assert_eq!(through(&[there("map", 5.0)], Wrong::Inactive), 9100);
    assert_eq!(through(&[], Wrong::Nothing), 309);
    assert_eq!(to_pose("map", 5.0, Wrong::Nothing), 0);
}

#[test]
fn ways_that_cannot_be_found() {
    let to_pose = |frame, x, wrong| {
        let goal = ComputePathToPoseGoal { goal: there(frame, x), ..Default::default() };
        ComputePathToPose::answer(&mut robot("waffle", wrong).pilot, goal, TOLD).1.error_code
    };
    let through = |poses: &[PoseStamped], wrong| {
        let goals = Goals { goals: poses.to_vec(), ..Goals::default() };
        let of_kilted = kilted::ComputePathThroughPosesGoal { goals, ..Default::default() };
        let of_jazzy =
            jazzy::ComputePathThroughPosesGoal { goals: poses.to_vec(), ..Default::default() };
        let pilot = &mut robot("waffle", wrong).pilot;
        let code = kilted::ComputePathThroughPoses::answer(pilot, of_kilted, TOLD).1.error_code;
        let same = jazzy::ComputePathThroughPoses::answer(pilot, of_jazzy, TOLD).1.error_code;
        assert_eq!(code, same);
        code
    };
    for (frame, x, wrong, digits) in POSES {
        assert_eq!(to_pose(frame, x, wrong), 200 + digits, "{wrong:?}");
        assert_eq!(
            through(&[there("map", 2.0), there(frame, x)], wrong),
            300 + digits,
            "{wrong:?}"
        );
    }
    assert_eq!(to_pose("map", 5.0, Wrong::NoMap), 200);
    assert_eq!(through(&[there("map", 5.0)], Wrong::NoMap), 300);
    assert_eq!(through(&[], Wrong::Nothing), 309);
    assert_eq!(to_pose("map", 5.0, Wrong::Nothing), 0);
}

#[test]
fn paths_that_cannot_be_used() {
    let follow = |path, wrong| {
        let goal = FollowPathGoal { path, ..FollowPathGoal::default() };
        outcome::<FollowPath>("waffle", goal, wrong).error_code
    };
    let across = || path("map", &[1.5, 5.0]);
    assert_eq!(follow(across(), Wrong::Inactive), 100);
    assert_eq!(follow(path("nowhere", &[1.5, 5.0]), Wrong::Nothing), 102);
    assert_eq!(follow(across(), Wrong::Lost), 102);
    for places in [&[][..], &[1.5], &[4.0, 5.0], &[1.5, 9.0]] {
        assert_eq!(follow(path("map", places), Wrong::Nothing), 103, "{places:?}");
    }
    assert_eq!(follow(across(), Wrong::WallAcross), 103);
    assert_eq!(follow(across(), Wrong::Slips), 105);
    assert_eq!(follow(across(), Wrong::Nothing), 0);
    let smooth = |path, wrong| {
        let goal = SmoothPathGoal { path, check_for_collisions: true, ..Default::default() };
        SmoothPath::answer(&mut robot("waffle", wrong).pilot, goal, TOLD).1.error_code
    };
    assert_eq!(smooth(across(), Wrong::NoMap), 500);
    assert_eq!(smooth(across(), Wrong::WallAcross), 503);
    assert_eq!(smooth(path("map", &[1.5]), Wrong::Nothing), 505);
    assert_eq!(smooth(across(), Wrong::Nothing), 0);
}

#[test]
fn stops_that_are_missed() {
    let stops = |poses: &[PoseStamped], wrong| {
        let goal = || jazzy::FollowWaypointsGoal { poses: poses.to_vec(), ..Default::default() };
        let of_kilted = outcome::<kilted::FollowWaypoints>("waffle", goal(), wrong);
        let of_jazzy = outcome::<jazzy::FollowWaypoints>("waffle", goal(), wrong);
        assert_eq!(of_kilted.error_code, of_jazzy.error_code);
        let missed = of_kilted.missed_waypoints.iter().map(|missed| missed.error_code);
        (of_kilted.error_code, missed.collect::<Vec<_>>())
    };
    assert_eq!(stops(&[], Wrong::Nothing), (602, vec![]));
    assert_eq!(stops(&[there("map", 5.0)], Wrong::Inactive), (600, vec![]));
    let beside = [there("map", 60.0), there("map", 3.0)];
    assert_eq!(stops(&beside, Wrong::Nothing), (0, vec![204]));
}

#[test]
fn motions_that_cannot_be_made() {
    let allowed = |time_s: f64| Duration::of(time_s);
    let turn = |time_s, wrong| {
        let goal = kilted::SpinGoal {
            target_yaw: 3.0,
            time_allowance: allowed(time_s),
            ..Default::default()
        };
        outcome::<kilted::Spin>("jackal", goal, wrong).error_code
    };
    let drive = |x: f64, speed, time_s| kilted::DriveGoal {
        target: Vector3 { x, ..Vector3::default() },
        speed,
        time_allowance: allowed(time_s),
        ..Default::default()
    };
    let ahead = |x, speed, time_s, wrong| {
        outcome::<kilted::DriveOnHeading>("jackal", drive(x, speed, time_s), wrong).error_code
    };
    let back = |name, x, time_s, wrong| {
        outcome::<kilted::BackUp>(name, drive(x, 0.2, time_s), wrong).error_code
    };
    assert_eq!(turn(20.0, Wrong::Inactive), 700);
    assert_eq!(turn(0.5, Wrong::Nothing), 701);
    assert_eq!(turn(200.0, Wrong::Lost), 702);
    assert_eq!(turn(20.0, Wrong::InAWall), 703);
    assert_eq!(turn(20.0, Wrong::Nothing), 0);
    assert_eq!(back("jackal", 0.3, 20.0, Wrong::Inactive), 710);
    assert_eq!(back("jackal", 0.3, 0.5, Wrong::Nothing), 711);
    assert_eq!(back("jackal", 0.3, 200.0, Wrong::Lost), 712);
    assert_eq!(back("waffle", f64::NAN, 20.0, Wrong::Nothing), 713);
    assert_eq!(back("jackal", 5.0, 90.0, Wrong::Nothing), 714);
    assert_eq!(back("jackal", 0.3, 20.0, Wrong::Nothing), 0);
    assert_eq!(ahead(0.3, 0.2, 20.0, Wrong::Inactive), 720);
    assert_eq!(ahead(0.3, 0.2, 0.5, Wrong::Nothing), 721);
    assert_eq!(ahead(0.3, 0.2, 200.0, Wrong::Lost), 722);
    assert_eq!(ahead(9.0, 0.5, 90.0, Wrong::Nothing), 723);
    assert_eq!(ahead(0.3, -0.2, 20.0, Wrong::Nothing), 724);
    assert_eq!(ahead(0.3, 0.2, 20.0, Wrong::Nothing), 0);
    let pause = |wrong| {
        let goal = WaitGoal { time: allowed(1.0) };
        outcome::<Wait>("waffle", goal, wrong).error_code
    };
    assert_eq!((pause(Wrong::Inactive), pause(Wrong::Nothing)), (740, 0));
}
