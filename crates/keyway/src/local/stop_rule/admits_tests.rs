use super::*;
use crate::map::{BitGrid, FieldConfig, GridFrame};
use proptest::prelude::*;

/// Clearance from stationary obstacles and the border \[m\].
fn room_m(robot: &Robot, around: &Surroundings<'_>, pose: Pose) -> f64 {
    let (footprint, clearance) = (&robot.footprint, around.obstacles.clearance());
    footprint.distance_m(pose, &clearance, 1.0).min(footprint.to_border_m(pose, &clearance))
}

/// The least clearance from a command until the robot is stationary \[m\], checked in small
/// steps.
fn least_room_m(robot: &Robot, around: &Surroundings<'_>, command: Velocity) -> f64 {
    let room_m = |pose: Pose| room_m(robot, around, pose);
    let ramps = robot.motion_to_stop(around.pose, around.velocity, command);
    let least_m = ramps.map(|ramp| {
        let at = |part: f64| {
            let to = ramp.from.lerp(ramp.to, part);
            room_m(ramp.start.after_ramp(ramp.from, to, robot.cycle_s * part))
        };
        (0..=50).map(|part| at(f64::from(part) / 50.0)).fold(f64::INFINITY, f64::min)
    });
    least_m.fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, max_global_rejects: 20_000, ..ProptestConfig::default() })]

    /// Beside obstacles and beside the border of the map, for commands and for braking.
    #[test]
    fn a_command_is_admitted_if_and_only_if_its_way_is_free(
        blocks in prop::collection::vec((0..60i32, 0..60i32), 0..4), (x, y) in (0.3..2.7f64, 0.3..2.7f64),
        to_border in prop::option::of(0.0..1e-3f64), theta in prop_oneof![-3.1..3.1f64, 0.0..0.2f64],
        (v, omega) in (0.0..2.0f64, -3.0..3.0f64), (faster, turns) in (-0.15..0.15f64, -0.3..0.3f64),
        brakes in any::<bool>(),
    ) {
        let frame = GridFrame::new(60, 60, 0.05, Pose::default()).unwrap();
        let mut obstacles = BitGrid::new(60, 60, false);
        for &(x, y) in &blocks {
            obstacles.fill_span(y, x, x + 1);
        }
        let field = DistanceField::new(&frame, &obstacles, &FieldConfig::default());
        let robot = Robot::jackal();
        let config = StopRuleConfig::for_robot(&robot);
        let margin_m = config.margin_m;
        let rule = StopRule::new(config, robot.clone()).unwrap();
        let mut pose = Pose::new(x, y, theta);
        if let Some(to_border_m) = to_border {
            let room_m = robot.footprint.to_border_m(Pose { x: 1.5, ..pose }, &field.clearance());
            pose.y += room_m - to_border_m;
            prop_assume!(pose.y > 1.5);
        }
        let (seen, velocity) = (SeenCells::ANYWHERE, Velocity::new(v, omega));
        let around = Surroundings { obstacles: &field, seen, movers: &[], delay_s: 0.0, pose, velocity, jerk_limited: None };
        let begins_m = room_m(&robot, &around, pose);
        prop_assume!(begins_m > 1e-4);
        let asked = Velocity::new((v + faster).max(0.0), omega + turns);
        let command = if brakes { robot.limits.braked(velocity, robot.cycle_s) } else { asked };
        let least_m = least_room_m(&robot, &around, command);
        match rule.admits(&around, command, &mut Scratch::default()) {
            // Steps may use up half of the kept clearance.
            Ok(()) => prop_assert!(least_m >= 0.5 * margin_m.min(begins_m) - 1e-9, "{least_m}"),
            Err(why) => {
                prop_assert!(matches!(why, Refusal::Standing { .. }), "{why:?}");
                prop_assert!(least_m < margin_m + 1e-3, "{least_m}: {why:?}");
            }
        }
    }
}
