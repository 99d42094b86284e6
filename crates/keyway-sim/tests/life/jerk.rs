//! A robot with jerk limits in all situations.

use super::robot_in_a_world::{RobotInAWorld, hall, wall_with_doors};
use keyway::geometry::{Point, Pose, Velocity, wrap_angle};
use keyway::navigate::{Navigator, Step};
use keyway::robot::Robot;
use keyway::sense::Observation;
use keyway_sim::metrics::CommandJerk;

/// The small robot, which averages ten commands and has a lag of 0.45 s.
fn gentle() -> Robot {
    let mut robot = Robot::small();
    robot.limits.v_min_mps = -0.3;
    (robot.limits.jerk_mps3, robot.limits.angular_jerk_radps3) = (Some(1.0), Some(6.0));
    assert!((robot.smoothing_lag_s() - 0.45).abs() < 1e-12);
    robot
}

struct Gentle {
    life: RobotInAWorld,
    jerk: CommandJerk,
}

impl Gentle {
    fn new(pose: Pose) -> Self {
        let robot = gentle();
        let jerk = CommandJerk::new(robot.cycle_s);
        Self { life: RobotInAWorld::of(robot, &hall(wall_with_doors(&[4.0])), pose), jerk }
    }

    /// Runs one cycle and checks the limits.
    fn cycle(&mut self) -> Step {
        let step = self.life.cycle();
        self.check(step.command());
        step
    }

    fn check(&mut self, command: Velocity) {
        self.jerk.note(command);
        assert!(self.jerk.max_mps3() <= 1.0 + 1e-9, "{command:?} {}", self.jerk.max_mps3());
        assert!(self.jerk.max_radps3() <= 6.0 + 1e-9, "{command:?} {}", self.jerk.max_radps3());
    }

    /// Drives until a given step; returns the number of cycles.
    fn until(&mut self, wanted: &Step) -> u32 {
        let mut cycles = 0;
        while self.cycle() != *wanted {
            cycles += 1;
            assert!(cycles < 1200, "{:?}", self.life.pose);
        }
        assert_eq!(self.life.velocity, Velocity::ZERO);
        cycles
    }

    fn drive(&mut self, cycles: u32) {
        (0..cycles).for_each(|_| drop(self.cycle()));
    }
}

#[test]
fn it_turns_drives_and_backs_up_exactly() {
    let mut robot = Gentle::new(Pose::new(4.0, 4.0, 0.3));
    robot.life.navigator.spin(1.5, 60.0).unwrap();
    robot.until(&Step::Arrived);
    let turned = robot.life.pose;
    assert!(wrap_angle(turned.theta - 1.8).abs() < 0.01, "{turned:?}");
    robot.life.navigator.drive_on_heading(1.0, 30.0).unwrap();
    robot.until(&Step::Arrived);
    let ahead = robot.life.pose;
    assert!((ahead.point().distance(turned.point()) - 1.0).abs() < 0.01, "{ahead:?}");
    robot.life.navigator.back_up(1.0, 30.0).unwrap();
    robot.until(&Step::Arrived);
    assert!(robot.life.pose.point().distance(turned.point()) < 0.02, "{:?}", robot.life.pose);
}

/// Goals change and are cancelled during the run, and the robot is stationary when it arrives.
#[test]
fn goals_change_and_end_on_the_way() {
    let mut robot = Gentle::new(Pose::new(2.0, 4.0, 0.0));
    robot.life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    robot.drive(40);
    assert!(robot.life.velocity.v > 0.45, "{:?}", robot.life.velocity);
    robot.life.navigator.set_goal(Point::new(2.0, 2.0)).unwrap();
    robot.drive(25);
    robot.life.navigator.cancel();
    robot.until(&Step::Idle);
    robot.life.navigator.set_goal(Point::new(10.0, 5.0)).unwrap();
    robot.until(&Step::Arrived);
    assert!(robot.life.pose.point().distance(Point::new(10.0, 5.0)) < 0.2);
}

/// Without observations it continues the motion that was found free of collisions.
#[test]
fn it_stops_within_its_limits_where_nothing_is_known() {
    let mut robot = Gentle::new(Pose::new(2.0, 4.0, 0.0));
    robot.life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    robot.drive(40);
    let mut cycles = 0;
    while robot.life.velocity != Velocity::ZERO {
        let nowhere = Observation::new(
            robot.life.stamp_s,
            Pose::new(f64::NAN, 0.0, 0.0),
            Velocity::ZERO,
            &[],
        );
        robot.life.navigator.observe(&nowhere);
        let command = robot.life.navigator.step().command();
        robot.check(command);
        robot.life.obey(command);
        cycles += 1;
        assert!(cycles < 40);
    }
    // Ten cycles of braking, and nine of averaging.
    assert_eq!(cycles, 19);
    // An old pose does not cause jerk either.
    robot.until(&Step::Arrived);
}

#[test]
fn a_pose_that_gets_old_is_no_reason_to_jerk() {
    let mut robot = Gentle::new(Pose::new(2.0, 4.0, 0.0));
    robot.life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    robot.drive(40);
    for _ in 0..40 {
        let command = robot.life.navigator.step().command();
        robot.check(command);
        robot.life.obey(command);
    }
    assert_eq!(robot.life.velocity, Velocity::ZERO);
}

/// The robot is stopped externally and released: it begins at rest, and keeps its limits.
#[test]
fn a_robot_that_was_stopped_begins_at_rest() {
    let mut robot = Gentle::new(Pose::new(2.0, 4.0, 0.0));
    robot.life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    robot.drive(40);
    assert!(robot.cycle().command().v > 0.45);
    let mut command = Velocity::ZERO;
    for _ in 0..5 {
        robot.life.velocity = Velocity::ZERO;
        robot.life.observe();
        command = robot.life.navigator.step().command();
        robot.life.stamp_s += robot.life.robot.cycle_s;
    }
    assert!(command.v < 0.02, "{command:?}");
    robot.jerk = CommandJerk::new(robot.life.robot.cycle_s);
    robot.check(command);
    robot.until(&Step::Arrived);
}

/// The navigator can be stored during the run, and gives the same commands.
#[test]
fn what_is_averaged_is_stored() {
    let mut robot = Gentle::new(Pose::new(2.0, 4.0, 0.0));
    robot.life.navigator.set_goal(Point::new(10.0, 5.0)).unwrap();
    robot.drive(15);
    let mut bytes = Vec::new();
    ciborium::into_writer(&robot.life.navigator.snapshot(), &mut bytes).unwrap();
    let mut other = Navigator::restore(ciborium::from_reader(&bytes[..]).unwrap()).unwrap();
    std::mem::swap(&mut robot.life.navigator, &mut other);
    let again: Vec<Velocity> = (0..40).map(|_| robot.cycle().command()).collect();
    // The other one drives the same commands.
    let mut twin = Gentle::new(Pose::new(2.0, 4.0, 0.0));
    twin.life.navigator.set_goal(Point::new(10.0, 5.0)).unwrap();
    twin.drive(15);
    for command in again {
        assert_eq!(twin.cycle().command(), command);
    }
}
