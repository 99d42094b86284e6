//! Robots with jerk limits: the motion of the robot itself is checked.

use super::tests::{Ground, commands, every_cycle, instants, robots, rule};
use super::*;
use crate::geometry::Point;
use crate::map::{BitGrid, GridFrame};
use crate::robot::CommandWindow;
use proptest::prelude::*;

/// A moving robot whose commands are averaged.
#[derive(Clone, Debug)]
struct Averaged {
    robot: Robot,
    window: CommandWindow,
    pose: Pose,
    velocity: Velocity,
}

impl Averaged {
    fn new(robot: Robot, pose: Pose) -> Self {
        let window = CommandWindow::of(&robot).unwrap();
        Self { robot, window, pose, velocity: Velocity::ZERO }
    }

    /// The surroundings of the robot and its reference.
    fn among<'a>(&'a self, ground: &'a Ground) -> Surroundings<'a> {
        let &Self { ref robot, ref window, pose, velocity } = self;
        let reference = window.reference_pose(pose, velocity, robot.cycle_s);
        let jerk_limited = Some(JerkLimited { window, pose, velocity });
        Surroundings { jerk_limited, ..ground.around(reference, window.reference(), &[]) }
    }

    /// Drives for a cycle in which the reference moves towards a command; returns the poses on
    /// the way.
    fn drive(&mut self, command: Velocity) -> Vec<Pose> {
        let Self { robot, window, pose, velocity } = self;
        let (limits, cycle_s) = (&robot.limits, robot.cycle_s);
        let given = window.push(limits.reached(window.reference(), command, cycle_s));
        let next = limits.reached(*velocity, given, cycle_s);
        let on_way = instants(robot, *pose, *velocity, next).map(|(pose, ..)| pose).collect();
        (*pose, *velocity) = (pose.after_ramp(*velocity, next, cycle_s), next);
        on_way
    }

    fn braked(&self) -> Velocity {
        self.robot.limits.braked(self.window.reference(), self.robot.cycle_s)
    }

    fn is_at_rest(&self) -> bool {
        self.velocity == Velocity::ZERO && self.window.is_zero()
    }
}

/// Robots at a pose, with random averaging times \[s\] and brakes.
fn averaged(pose: Pose) -> impl Strategy<Value = Averaged> {
    (robots(), 0.12..1.9f64, prop_oneof![Just(1.0), 0.5..2.0f64]).prop_map(
        move |(mut robot, smoothed_s, brakes)| {
            let limits = &mut robot.limits;
            limits.deceleration_mps2 *= brakes;
            limits.jerk_mps3 =
                Some(2.0 * limits.acceleration_mps2.max(limits.deceleration_mps2) / smoothed_s);
            Averaged::new(robot, pose)
        },
    )
}

fn frame() -> GridFrame {
    GridFrame::new(60, 50, 0.1, Pose::new(1.0, -2.0, 0.3)).unwrap()
}

fn cells() -> impl Strategy<Value = Vec<bool>> {
    prop::collection::vec(prop::bool::weighted(0.01), 60 * 50)
}

fn somewhere() -> impl Strategy<Value = Pose> {
    (4.0..56.0f64, 4.0..46.0f64, -3.1..3.1f64).prop_map(|(x, y, theta)| {
        let at = frame().world_from_grid(Point::new(x, y));
        Pose::new(at.x, at.y, theta)
    })
}

#[test]
fn stops_before_a_wall_by_hand() {
    let mut robot = Robot::small();
    // 0.5 m/s² up and down: an average over ten cycles, 0.45 s behind.
    robot.limits.jerk_mps3 = Some(1.0);
    let (ground, rule) = (Ground::wall(), rule(&robot));
    let ahead = Velocity::new(0.5, 0.0);
    let at = |to_wall_m: f64| {
        let mut robot = Averaged::new(robot.clone(), Pose::new(5.0 - to_wall_m, 4.0, 0.0));
        robot.window.refill(ahead);
        robot.velocity = ahead;
        rule.gate(&robot.among(&ground), ahead, &mut Scratch::default())
    };
    // The distance of a robot without jerk limits, and that of 0.45 s.
    let least_m = 0.05 + 0.25 + 0.18 + 0.0025 + 0.225;
    assert!(!at(least_m + 1e-6).changed());
    let refused = at(least_m - 1e-6);
    assert!(matches!(refused.why, Some(Refusal::Standing { after_s }) if after_s > 1.5));
    assert!(refused.command.v > 0.45 && refused.command.v < 0.5, "{refused:?}");
}

/// Considers the remaining motion of the averaged velocities, also if a stop is requested.
#[test]
fn what_is_averaged_counts() {
    let mut robot = Robot::small();
    robot.limits.jerk_mps3 = Some(1.0);
    let (ground, rule) = (Ground::wall(), rule(&robot));
    let mut robot = Averaged::new(robot, Pose::new(4.72, 4.0, 0.0));
    robot.window.refill(Velocity::new(0.3, 0.0));
    (0..9).for_each(|_| _ = robot.window.push(Velocity::ZERO));
    robot.velocity = Velocity::new(0.03, 0.0);
    let turn = Velocity::new(0.0, 0.3);
    let changed = |robot: &Averaged| {
        rule.gate(&robot.among(&ground), turn, &mut Scratch::default()).changed()
    };
    assert!(!changed(&robot));
    // 0.1 m before the wall, and 0.12 m of remaining motion.
    robot.window.refill(Velocity::new(0.3, 0.0));
    robot.velocity = robot.window.push(Velocity::ZERO);
    assert!(changed(&robot));
}

/// Ground that the average leads to, ahead or back, has to be observed, whatever is requested.
#[test]
fn what_is_averaged_stays_on_seen_ground() {
    let mut robot = Robot::small();
    (robot.limits.v_min_mps, robot.limits.jerk_mps3) = (-0.5, Some(1.0));
    let (ground, rule) = (Ground::open(), rule(&robot));
    // 0.18 m of robot, and over 0.2 m of remaining motion.
    let refusal = |v: f64, sees_m: f64| {
        let mut cells = BitGrid::new(200, 200, false);
        let reach = (sees_m * 10.0).round() as i32;
        (0..200).for_each(|y| cells.fill_span(y, 100 - reach, 99 + reach));
        let mut robot = Averaged::new(robot.clone(), Pose::default());
        robot.window.refill(Velocity::new(v, 0.0));
        robot.window.push(Velocity::ZERO);
        robot.velocity = robot.window.command();
        let both = SeenCells { ahead: Some(&cells), behind: Some(&cells), ..SeenCells::ANYWHERE };
        let around = Surroundings { seen: both, ..robot.among(&ground) };
        rule.gate(&around, Velocity::new(0.0, 0.3), &mut Scratch::default()).why
    };
    assert_eq!([refusal(0.5, 0.8), refusal(-0.5, 0.8), refusal(0.0, 0.2)], [None; 3]);
    assert!(matches!(refusal(0.5, 0.3), Some(Refusal::OutOfSight { .. })));
    assert!(matches!(refusal(-0.5, 0.3), Some(Refusal::Unseen { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// For any requested commands, and braking at any time.
    #[test]
    fn a_mad_planner_touches_nothing_that_stands(
        cells in cells(), robot in somewhere().prop_flat_map(averaged), commands in commands(),
    ) {
        let (mut robot, ground) = (robot, Ground::new(&frame(), &cells));
        let start_m = ground.room_m(&robot.robot.footprint, robot.pose);
        prop_assume!(start_m > 2e-4);
        let rule = rule(&robot.robot);
        let mut scratch = Scratch::default();
        let mut kept_m = start_m.min(rule.config.margin_m);
        let mut commands = every_cycle(&robot.robot, &commands).into_iter();
        while let Some(command) = commands.next().or_else(|| (!robot.is_at_rest()).then(|| robot.braked())) {
            let around = robot.among(&ground);
            let gated = rule.gate(&around, command, &mut scratch);
            if !rule.is_braking(&around, gated.command) {
                kept_m = ground.room_m(&robot.robot.footprint, robot.pose).min(rule.config.margin_m);
                // The noise of a stationary robot.
                let (core, _) = robot.robot.footprint.core();
                let is_noise = robot.robot.stands(robot.velocity) && robot.window.is_still(&robot.robot);
                let drift_s = if is_noise { 0.5 * robot.robot.cycle_s } else { 0.0 };
                kept_m -= core.moves_m(robot.velocity.v * drift_s, robot.velocity.omega * drift_s);
            }
            for on_way in robot.drive(gated.command) {
                let room_m = ground.room_m(&robot.robot.footprint, on_way);
                prop_assert!(room_m >= 0.5 * kept_m - 1e-9, "{room_m} {kept_m} {on_way:?} {gated:?}");
            }
            let room_m = ground.room_m(&robot.robot.footprint, robot.pose);
            prop_assert!(room_m >= kept_m - 1e-8, "{room_m} {kept_m} {gated:?}");
        }
    }

    /// Against a literal reading of the rule, from any motion.
    #[test]
    fn admissible_is_what_the_whole_manoeuvre_says(
        cells in cells(), robot in somewhere().prop_flat_map(averaged), before in commands(),
        (v, omega) in (-0.2..1.0f64, -1.0..1.0f64),
    ) {
        let (mut robot, ground) = (robot, Ground::new(&frame(), &cells));
        let place = robot.pose;
        for command in every_cycle(&robot.robot, &before) {
            robot.drive(command);
        }
        robot.pose = place;
        let rule = rule(&robot.robot);
        let margin_m = rule.config.margin_m;
        prop_assume!(ground.room_m(&robot.robot.footprint, place) > margin_m);
        let limits = &robot.robot.limits;
        let mut command = Velocity::new(v * limits.v_max_mps, omega * limits.omega_max_radps);
        let around = robot.among(&ground);
        let gated = rule.gate(&around, command, &mut Scratch::default());
        let is_braking = rule.is_braking(&around, command);
        let (mut drives, mut least_m, mut first) = (robot.clone(), f64::INFINITY, true);
        while first || !drives.is_at_rest() {
            for on_way in drives.drive(command) {
                least_m = least_m.min(ground.room_m(&robot.robot.footprint, on_way));
            }
            (command, first) = (drives.braked(), false);
        }
        if least_m >= 2.0 * margin_m {
            prop_assert!(!gated.changed(), "{least_m} {gated:?}");
        }
        if least_m < 0.5 * margin_m && !is_braking {
            prop_assert!(gated.changed(), "{least_m}");
        }
    }
}
