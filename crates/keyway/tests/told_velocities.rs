//! The commands of a navigator for arbitrary velocity estimates.
#![allow(clippy::unwrap_used)]

#[path = "support/driving.rs"]
mod driving;

use driving::{bound_for, next_step};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::map::OccupancyGrid;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway::sense::Scan;
use proptest::prelude::*;

/// Every stack with its parameters for a robot, with and without the stop rule, and every one as
/// it was published.
fn stacks(robot: &Robot) -> Vec<Stack> {
    let usual = Stack::NAMES.iter().filter_map(|name| Stack::by_name(name, robot));
    let published = Stack::NAMES.iter().filter_map(|name| Stack::published_by_name(name));
    let mut stacks: Vec<Stack> = published.collect();
    for stack in usual {
        let controller = stack.controller.clone().with_stop_rule(robot);
        stacks.extend([Stack { controller, ..stack.clone() }, stack]);
    }
    stacks
}

/// Mostly plausible values: up to twice the limits.
fn told(most: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -2.0 * most..=2.0 * most,
        1 => Just(-most), 1 => Just(most), 1 => -1e6..1e6f64, 1 => any::<f64>(),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn commands_are_within_the_limits_whatever_velocity_is_told(
        velocities in prop::collection::vec((told(2.0), told(3.0)), 4), name in prop::sample::select(&["jackal", "paper"][..]),
        delay_cycles in prop_oneof![Just(0.0), Just(1.5)], (x, theta) in (1.5..8.5f64, -3.1..3.1f64), range_m in 0.5..6.0f64,
    ) {
        let map = OccupancyGrid::from_ascii(&["..........", "......#...", "..........", ".........."]);
        let mut robot = Robot::by_name(name).unwrap();
        robot.actuation_delay_s = delay_cycles * robot.cycle_s;
        let mut scan = Scan::of_nothing(&robot.sensors[0]);
        scan.ranges_m[robot.sensors[0].beams as usize / 2] = range_m;
        let limits = &robot.limits;
        let mut driven = 0;
        for stack in stacks(&robot) {
            let ends = (Point::new(1.5, 2.0), Point::new(8.5, 1.5));
            let Ok(fitted) = stack.fit(&robot) else { continue };
            let Ok(mut navigator) = bound_for(&map, &fitted, ends.0, ends.1) else { continue };
            driven += 1;
            for &(v, omega) in &velocities {
                let step = next_step(&mut navigator, Pose::new(x, 2.0, theta), Velocity::new(v, omega), &scan);
                let command = step.command();
                prop_assert!((limits.v_min_mps..=limits.v_max_mps).contains(&command.v), "{step:?} {v} {omega}");
                prop_assert!(command.omega.abs() <= limits.omega_max_radps, "{step:?} {v} {omega}");
            }
        }
        prop_assert!(driven >= 5, "{driven}");
    }
}
