//! Moving obstacles that keep their bounds, and nothing else.

use super::tests::{Ground, commands, direction, every_cycle, instants, robots};
use super::*;
use crate::geometry::Point;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Moving obstacles that turn around in every cycle, the first one always towards the robot;
    /// or that accelerate as hard as they may. They are observed with errors.
    #[test]
    fn no_mover_touches_a_robot_that_moves(
        robot in robots(), commands in commands(), has_acceleration: bool, off_m in 0.0..0.1f64,
        places in prop::collection::vec((-4.0..4.0f64, -4.0..4.0f64, 0.05..0.5f64), 1..4),
        turns in prop::collection::vec((-3.1..3.1f64, 0.0..1.0f64), 120),
    ) {
        let bounds = MoverBounds { speed_mps: 0.8, acceleration_mps2: has_acceleration.then_some(1.0) };
        let config = StopRuleConfig { movers: bounds, ..StopRuleConfig::for_robot(&robot) };
        let rule = StopRule::new(config, robot.clone()).unwrap();
        let (ground, mut scratch) = (Ground::open(), Scratch::default());
        let (mut pose, mut velocity) = (Pose::default(), Velocity::ZERO);
        let (core, radius_m) = robot.footprint.core();
        let gap_m = |pose: Pose, at: Point, mover_m: f64| core.distance_to_m(pose, at) - mover_m - radius_m;
        let mut movers: Vec<Walker> = places.iter().map(|&(x, y, radius_m)| Walker {
            centre: Point::new(x, y), before: Point::default(), after: Point::default(), radius_m,
        }).collect();
        for (cycle, command) in every_cycle(&robot, &commands).into_iter().enumerate() {
            let seen: Vec<Mover> = movers.iter().enumerate().map(|(i, walker)| Mover {
                velocity_mps: walker.after, position_uncertainty_m: off_m,
                ..Mover::standing(i as u64, walker.centre + direction((cycle * 2 + i) as f64) * off_m, walker.radius_m)
            }).collect();
            let gated = rule.gate(&ground.around(pose, velocity, &seen), command, &mut scratch);
            let next = robot.limits.reached(velocity, gated.command, robot.cycle_s);
            for (i, walker) in movers.iter_mut().enumerate() {
                let (turn_rad, share) = turns[(cycle * 3 + i) % turns.len()];
                let wish = if i == 0 { pose.point() - walker.centre } else { direction(turn_rad) };
                walker.turn(wish, if i == 0 { 1.0 } else { share }, &bounds, robot.cycle_s);
                for (on_way, moving, elapsed_s) in instants(&robot, pose, velocity, next) {
                    let gap_m = gap_m(on_way, walker.at(elapsed_s, robot.cycle_s), walker.radius_m);
                    // A disc that turns on the spot covers no other ground.
                    let arc_s = robot.cycle_s / f64::from(Pose::RAMP_ARCS);
                    let moves = core.moves_m(moving.v * arc_s, moving.omega * arc_s) > 1e-9;
                    prop_assert!(gap_m > 0.0 || !moves, "{gap_m} {moving:?} {gated:?}");
                }
                walker.centre = walker.at(robot.cycle_s, robot.cycle_s);
            }
            (pose, velocity) = (pose.after_ramp(velocity, next, robot.cycle_s), next);
        }
    }
}

/// The true state of a moving obstacle.
struct Walker {
    centre: Point,
    before: Point,
    after: Point,
    radius_m: f64,
}

impl Walker {
    /// Goes on towards `wish`: at once, or as fast as its acceleration allows.
    fn turn(&mut self, wish: Point, share: f64, bounds: &MoverBounds, cycle_s: f64) {
        let wish = wish * (share / wish.norm().max(1e-9));
        self.before = self.after;
        self.after = match bounds.acceleration_mps2 {
            None => wish * bounds.speed_mps,
            Some(most) => self.before + wish * (most * cycle_s),
        };
        let speed = self.after.norm();
        if speed > bounds.speed_mps {
            self.after = self.after * (bounds.speed_mps / speed);
        }
        if bounds.acceleration_mps2.is_none() {
            self.before = self.after;
        }
    }

    fn at(&self, elapsed_s: f64, cycle_s: f64) -> Point {
        self.centre + self.before.lerp(self.after, 0.5 * elapsed_s / cycle_s) * elapsed_s
    }
}
