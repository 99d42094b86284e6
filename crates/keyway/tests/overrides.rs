//! Commands that replace those of the navigator.
#![allow(clippy::unwrap_used)]

#[path = "support/driving.rs"]
mod driving;

use driving::{bound_for, next_stamp_s, next_step};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::map::OccupancyGrid;
use keyway::navigate::{Stack, Step};
use keyway::robot::Robot;
use keyway::sense::Scan;

/// Motors that obey at once, on a robot that is stopped from outside for a while again and again.
fn stopped_again_and_again(name: &str, is_told: bool) -> (Vec<String>, f64) {
    let map = OccupancyGrid::from_ascii(&["............"; 6]);
    let robot = Robot::by_name(name).unwrap();
    let fitted = Stack::keyway(&robot).fit(&robot).unwrap();
    let (start, goal) = (Point::new(1.5, 2.5), Point::new(10.5, 3.5));
    let mut navigator = bound_for(&map, &fitted, start, goal).unwrap();
    let scan = Scan::of_nothing(&robot.sensors[0]);
    let (mut pose, mut velocity) = (Pose::new(start.x, start.y, 0.0), Velocity::ZERO);
    let (mut doubts, cycle_s) = (Vec::new(), robot.cycle_s);
    for cycle in 0..400 {
        // It is stopped just after it has begun to move.
        let is_stopped = cycle % 8 >= 2 && cycle < 200;
        let command = if is_stopped {
            if is_told {
                let now_s = next_stamp_s(&navigator);
                navigator.note_override(now_s, Velocity::ZERO);
            }
            Velocity::ZERO
        } else {
            let step = next_step(&mut navigator, pose, velocity, &scan);
            if step == Step::Arrived {
                break;
            }
            step.command()
        };
        let reached = robot.limits.reached(velocity, command, cycle_s);
        pose = pose.after_ramp(velocity, reached, cycle_s);
        velocity = reached;
        doubts.extend(navigator.doubts().iter().map(ToString::to_string));
    }
    (doubts, pose.point().distance(goal))
}

#[test]
fn commands_of_others_teach_nothing() {
    for name in ["small", "jackal", "paper"] {
        let (doubts, left_m) = stopped_again_and_again(name, true);
        assert!(doubts.is_empty() && left_m < 0.3, "{name}: {doubts:?} {left_m}");
    }
    let (doubts, _) = stopped_again_and_again("small", false);
    assert!(!doubts.is_empty(), "who is not told believes that the motors are weak");
}
