//! The rollouts of a cycle against a literal transcription: each candidate by itself, pose after
//! pose, with distances measured at every pose and at many points between.

use super::motion::euler_step;
use super::roller::{RollMemory, Roller};
use super::window::{Lattice, Window};
use super::*;
use crate::geometry::{Polyline, Pose};
use crate::map::{BitGrid, DistanceField, FieldConfig, GridFrame};
use crate::robot::Footprint;
use proptest::prelude::*;

/// Points that are checked on each stretch.
const SAMPLES: u32 = 100;

struct Literal {
    end: Pose,
    distance_m: f64,
    /// The least clearance at any checked point \[m\]; negative if the core is inside something.
    room_m: f64,
    /// Between two points nothing is nearer by more than this \[m\].
    coarse_m: f64,
}

fn literal(
    window: &DynamicWindow,
    roller: &Roller<'_>,
    candidate: Velocity,
    samples: u32,
) -> Literal {
    let (config, robot, scene, body) = (&window.config, &window.robot, roller.scene, &roller.body);
    let clearance = scene.obstacles.clearance();
    let farthest_m = config.distance_cap_m + body.offset_m;
    let distance_m = |pose: Pose| body.core.distance_m(pose, &clearance, farthest_m);
    let core = match &robot.footprint {
        Footprint::Circle(_) => Footprint::circle(0.0).unwrap(),
        polygon @ Footprint::Polygon(_) => polygon.clone(),
    };
    let room_m = |pose: Pose| {
        let room_m = body.core.distance_m(pose, &clearance, 9.0);
        let room_m = if core.is_free(pose, scene.obstacles) { room_m } else { -1.0 };
        room_m.min(body.core.to_border_m(pose, &clearance))
    };
    let mut literal = Literal {
        end: scene.pose,
        distance_m: distance_m(scene.pose),
        room_m: room_m(scene.pose),
        coarse_m: 0.0,
    };
    let mut stretch = |moves_m: f64, between: &dyn Fn(Pose, f64) -> Pose| {
        let begin = literal.end;
        literal.end = between(begin, 1.0);
        literal.distance_m = literal.distance_m.min(distance_m(literal.end));
        for sample in 1..=samples {
            let pose = between(begin, f64::from(sample) / f64::from(samples));
            literal.room_m = literal.room_m.min(room_m(pose));
        }
        literal.coarse_m = literal.coarse_m.max(moves_m / f64::from(samples));
    };
    let moves_m = |velocity: Velocity, duration_s: f64| {
        let from = scene.velocity;
        let (v, omega) =
            (velocity.v.abs().max(from.v.abs()), velocity.omega.abs().max(from.omega.abs()));
        body.core.moves_m(v * duration_s, omega * duration_s)
    };
    let mut left_s = config.horizon_s;
    if config.prediction == Prediction::Arcs {
        let cycle_s = robot.cycle_s.min(left_s);
        let to = scene.velocity.lerp(candidate, cycle_s / robot.cycle_s);
        stretch(moves_m(candidate, cycle_s), &|begin, fraction| {
            let reached = scene.velocity.lerp(to, fraction);
            begin.after_ramp(scene.velocity, reached, cycle_s * fraction)
        });
        left_s -= cycle_s;
    }
    let steps = (left_s / config.prediction_step_s - 1e-9).ceil().max(0.0);
    for _ in 0..steps as u32 {
        let step_s = left_s / steps;
        stretch(moves_m(candidate, step_s), &|begin, fraction| match config.prediction {
            Prediction::Arcs => begin.after_arc(candidate, step_s * fraction),
            Prediction::Euler => euler_step(begin, candidate, step_s * fraction),
        });
    }
    if config.distance_at == DistanceAt::End {
        literal.distance_m = distance_m(literal.end);
    }
    literal.distance_m -= body.offset_m;
    literal
}

/// The pose that is compared with the guide point.
fn literal_judged(window: &DynamicWindow, scene: &Scene<'_>, candidate: Velocity) -> Pose {
    let WindowConfig { horizon_s, judged_s, prediction_step_s, .. } = window.config;
    let (start, from, cycle_s) = (scene.pose, scene.velocity, window.robot.cycle_s);
    if window.config.prediction == Prediction::Arcs {
        return start.after_ramp(from, candidate, cycle_s).after_arc(candidate, judged_s - cycle_s);
    }
    let step_s = horizon_s / (horizon_s / prediction_step_s - 1e-9).ceil();
    let (mut pose, mut left_s) = (start, judged_s);
    while left_s > 1e-9 {
        pose = euler_step(pose, candidate, step_s.min(left_s));
        left_s -= step_s;
    }
    pose
}

/// A disc, a box, a box that turns around its back, one that is not convex, one beside its centre
/// of rotation, a point.
fn robot(shape: usize) -> Robot {
    let shapes: [&[[f64; 2]]; 4] = [
        &[[0.3, 0.15], [-0.3, 0.15], [-0.3, -0.15], [0.3, -0.15]],
        &[[0.5, 0.1], [-0.05, 0.1], [-0.05, -0.1], [0.5, -0.1]],
        &[[0.3, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.3, -0.2], [0.05, 0.0]],
        &[[0.3, 0.3], [0.1, 0.3], [0.1, 0.1]],
    ];
    let mut robot = Robot::small();
    robot.limits.v_min_mps = -0.2;
    if shape == shapes.len() + 1 {
        robot.footprint = Footprint::circle(0.0).unwrap();
    } else if shape > 0 {
        let vertices = shapes[shape - 1].iter().map(|&vertex| vertex.into()).collect();
        robot.footprint = Footprint::polygon(vertices).unwrap();
    }
    robot
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn rollouts_are_those_of_the_literal_transcription(
        blocks in prop::collection::vec((0i32..60, 0i32..60, 0i32..9), 0..40), yaw in -3.0..3.0f64,
        at in (0.3..2.7f64, 0.3..2.7f64, -3.0..3.0f64),
        moving in (prop_oneof![-0.2..0.5f64, -1e-6..1e-6f64], prop_oneof![Just(0.0), -1.5..1.5f64]), shape in 0..6usize,
        is_euler: bool, is_at_end: bool, step_s in 0.03..0.12f64, judged in prop_oneof![Just(1.0), 0.0..1.0f64], margin_m in prop_oneof![Just(0.0), 0.0..0.1f64],
    ) {
        let frame = GridFrame::new(60, 60, 0.05, Pose::new(3.0, -7.0, yaw)).unwrap();
        let mut obstacles = BitGrid::new(60, 60, false);
        for &(x, y, length) in &blocks {
            obstacles.fill_span(y, x, x + length);
        }
        let world = DistanceField::new(&frame, &obstacles, &FieldConfig { reach_m: 1.0, ..FieldConfig::default() });
        let robot = robot(shape);
        let mut config = WindowConfig::for_robot(&robot);
        (config.horizon_s, config.prediction_step_s) = (2.1, step_s);
        config.judged_s = (2.1 * judged).max(robot.cycle_s);
        config.safety_margin_m = margin_m;
        (config.v_step_mps, config.omega_step_radps) = (0.021, 0.13);
        if is_euler {
            (config.prediction, config.admissible) = (Prediction::Euler, Admissible::StoppingDistance);
        }
        config.distance_at = if is_at_end { DistanceAt::End } else { DistanceAt::Trajectory };
        let window = DynamicWindow::new(config, robot.clone()).unwrap();
        let place = frame.world_from_grid(Point::new(at.0 / 0.05, at.1 / 0.05));
        let pose = Pose::new(place.x, place.y, at.2);
        prop_assume!(robot.footprint.is_free(pose, &world)
            && robot.footprint.distance_m(pose, &world.clearance(), 1.0) > 1e-3);
        let velocity = Velocity::new(moving.0, moving.1);
        let path = Polyline::default();
        let scene = Scene { obstacles: &world, sensed: &obstacles, seen: crate::sense::SeenCells::ANYWHERE, movers: &[], walked: &[], pose, velocity, guide: place, path: &path, goal_heading_rad: None, remaining_m: f64::INFINITY, jerk_limited: None };
        let mut shrunk = Vec::new();
        let roller = window.roller(&scene, &mut shrunk);
        let mut lattice = Lattice::default();
        let reachable = Window::of(&robot, velocity, f64::INFINITY, true);
        lattice.fill(&reachable, window.config.v_step_mps, window.config.omega_step_radps);
        let mut memory = RollMemory::default();
        roller.roll(&lattice, &mut memory);
        for (candidate, rollout) in memory.rollouts().all(&lattice) {
            let expected = literal(&window, &roller, candidate, SAMPLES);
            let spare_m = expected.room_m - roller.body.contact_m;
            let Some(rollout) = rollout else {
                let little_m = expected.coarse_m + 1e-3;
                prop_assert!(spare_m < little_m, "{candidate:?} has room: {spare_m}");
                continue;
            };
            prop_assert!(spare_m > -2e-5, "{candidate:?} touches: {spare_m}");
            let (Pose { x, y, theta }, judged) = (rollout.judged, literal_judged(&window, &scene, candidate));
            prop_assert!(judged.point().distance(Point::new(x, y)) < 1e-9);
            prop_assert!(crate::geometry::wrap_angle(judged.theta - theta).abs() < 1e-9);
            let off_m = rollout.distance_m - expected.distance_m;
            prop_assert!(off_m.abs() < 1e-9, "{candidate:?}: {} {}", rollout.distance_m, expected.distance_m);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// Many speeds are judged together, in parts and alone: the nearest obstacle changes with the
    /// speed.
    #[test]
    fn distances_of_many_speeds_are_exact(
        pillars in prop::collection::vec((0i32..60, 0i32..60, 0i32..4), 0..60), at in (0.3..2.7f64, 0.3..2.7f64, -3.0..3.0f64),
        moving in (0.0..0.5f64, -0.5..0.5f64), shape in 0..6usize, speeds in 1..80u32, is_at_end: bool, cap_m in 0.05..1.5f64,
        acceleration_mps2 in 0.5..4.0f64,
    ) {
        let frame = GridFrame::new(60, 60, 0.05, Pose::default()).unwrap();
        let mut obstacles = BitGrid::new(60, 60, false);
        for &(x, y, length) in &pillars {
            obstacles.fill_span(y, x, x + length);
        }
        let world = DistanceField::new(&frame, &obstacles, &FieldConfig::default());
        let mut robot = robot(shape);
        robot.limits.acceleration_mps2 = acceleration_mps2;
        let mut config = WindowConfig::for_robot(&robot);
        (config.horizon_s, config.prediction_step_s) = (2.1, 0.2);
        config.judged_s = robot.cycle_s;
        (config.safety_margin_m, config.distance_cap_m) = (0.0, cap_m);
        (config.v_step_mps, config.omega_step_radps) = (0.1 / f64::from(speeds), 0.29);
        config.distance_at = if is_at_end { DistanceAt::End } else { DistanceAt::Trajectory };
        let window = DynamicWindow::new(config, robot.clone()).unwrap();
        let pose = Pose::new(at.0, at.1, at.2);
        prop_assume!(robot.footprint.is_free(pose, &world)
            && robot.footprint.distance_m(pose, &world.clearance(), 1.0) > 1e-3);
        assert_distances_are_exact(&window, &world, pose, Velocity::new(moving.0, moving.1));
    }
}

/// Checks the distances of all candidates that touch nothing.
fn assert_distances_are_exact(
    window: &DynamicWindow,
    world: &DistanceField,
    pose: Pose,
    velocity: Velocity,
) {
    let scene = Scene {
        obstacles: world,
        sensed: world.clearance().obstacles(),
        seen: crate::sense::SeenCells::ANYWHERE,
        movers: &[],
        walked: &[],
        pose,
        velocity,
        guide: pose.point(),
        path: &Polyline::default(),
        goal_heading_rad: None,
        remaining_m: f64::INFINITY,
        jerk_limited: None,
    };
    let mut shrunk = Vec::new();
    let roller = window.roller(&scene, &mut shrunk);
    let mut lattice = Lattice::default();
    window.fill(&mut lattice, &scene);
    let mut memory = RollMemory::default();
    roller.roll(&lattice, &mut memory);
    for (candidate, rollout) in memory.rollouts().all(&lattice) {
        let Some(rollout) = rollout else {
            continue;
        };
        let expected = literal(window, &roller, candidate, 1);
        let off_m = rollout.distance_m - expected.distance_m;
        let Literal { distance_m, .. } = expected;
        assert!(off_m.abs() < 1e-9, "{candidate:?}: {} {distance_m}", rollout.distance_m);
    }
}

/// A wall at the side is the nearest for the slow speeds, and one ahead for the fast: while the
/// wall ahead is the nearest for half of some speeds, the one at the side still is for the
/// others.
#[test]
fn in_a_corner_one_wall_or_the_other_is_nearest() {
    let frame = GridFrame::new(80, 80, 0.05, Pose::default()).unwrap();
    for ahead in (52..72).step_by(5) {
        let mut obstacles = BitGrid::new(80, 80, false);
        obstacles.fill_span(10, 0, 79);
        (0..80).for_each(|y| obstacles.fill_span(y, ahead, ahead));
        let world = DistanceField::new(&frame, &obstacles, &FieldConfig::default());
        for shape in [0, 1] {
            let mut robot = robot(shape);
            robot.limits.acceleration_mps2 = 3.0;
            let mut config = WindowConfig::for_robot(&robot);
            (config.horizon_s, config.prediction_step_s) = (2.1, 0.1);
            (config.v_step_mps, config.omega_step_radps) = (0.004, 0.3);
            config.judged_s = robot.cycle_s;
            (config.safety_margin_m, config.distance_cap_m) = (0.0, 1.0);
            let window = DynamicWindow::new(config, robot).unwrap();
            let pose = Pose::new(2.0, 1.0, 0.0);
            assert_distances_are_exact(&window, &world, pose, Velocity::new(0.2, 0.0));
        }
    }
}

/// After the first cycle nothing is allocated, even if much is in doubt.
#[test]
fn a_warm_cycle_allocates_nothing() {
    let frame = GridFrame::new(60, 60, 0.05, Pose::default()).unwrap();
    let mut obstacles = BitGrid::new(60, 60, false);
    for y in (0..60).step_by(9) {
        (0..60).step_by(11).for_each(|x| obstacles.fill_span(y, x, x + 1));
    }
    let world = DistanceField::new(&frame, &obstacles, &FieldConfig::default());
    for shape in 0..6 {
        let robot = robot(shape);
        let window = DynamicWindow::new(WindowConfig::for_robot(&robot), robot).unwrap();
        let mut scratch = Scratch::default();
        let weighing = Weighing([Term::of("speed", 1.0)]);
        let path = Polyline::default();
        let mut decide = |theta: f64| {
            let (pose, guide) = (Pose::new(1.4, 1.4, theta), Point::default());
            let velocity = Velocity::new(0.3, 0.1);
            let scene = Scene {
                obstacles: &world,
                sensed: &obstacles,
                seen: crate::sense::SeenCells::ANYWHERE,
                movers: &[],
                walked: &[],
                pose,
                velocity,
                guide,
                path: &path,
                goal_heading_rad: None,
                remaining_m: f64::INFINITY,
                jerk_limited: None,
            };
            window
                .decide(&scene, &mut scratch, &weighing, |velocity, _| [TermValue::of(velocity.v)])
                .is_ok()
        };
        decide(0.4);
        let mut is_admissible = false;
        let counted = allocation_counter::measure(|| is_admissible = decide(0.4));
        assert_eq!(counted.count_total, 0, "shape {shape}, {is_admissible}");
    }
}
