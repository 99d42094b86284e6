use super::*;
use crate::geometry::{Point, Polyline};
use crate::local::Remedy;
use crate::local::{
    Admissible, Change, Decision, DriveMemory, Dwa, DwaConfig, Evaluation, LocalPlanner, NoCommand,
    Scratch,
};
use crate::map::{CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
use crate::robot::{Footprint, Limits};
use proptest::prelude::*;
use std::f64::consts::PI;

static NO_PATH: Polyline = Polyline::new(Vec::new());

/// 3 m x 3 m.
fn grid(occupied: impl Fn(i32, i32) -> bool) -> DistanceField {
    let frame = GridFrame::new(60, 60, 0.05, Pose::default()).unwrap();
    let grid = OccupancyGrid::from_fn(frame, |cell| {
        if occupied(cell.x, cell.y) { CellState::Occupied } else { CellState::Free }
    });
    let config = FieldConfig { reach_m: 1.0, ..FieldConfig::default() };
    DistanceField::new(&frame, grid.occupied(), &config)
}

fn scene(obstacles: &DistanceField, pose: Pose, velocity: Velocity) -> Scene<'_> {
    let sensed = obstacles.clearance().obstacles();
    Scene {
        obstacles,
        sensed,
        seen: crate::sense::SeenCells::ANYWHERE,
        movers: &[],
        walked: &[],
        pose,
        velocity,
        guide: Point::new(2.5, 1.0),
        path: &NO_PATH,
        goal_heading_rad: None,
        remaining_m: f64::INFINITY,
        jerk_limited: None,
    }
}

fn small(shape: usize) -> Robot {
    let robot = Robot::small();
    match shape {
        0 => robot,
        1 => Robot { footprint: Footprint::rectangle(0.6, 0.3).unwrap(), ..robot },
        2 => {
            let limits = Limits { min_turning_radius_m: 0.3, v_min_mps: -0.3, ..robot.limits };
            Robot { limits, ..robot }
        }
        // Turns around its back.
        _ => {
            let vertices = [[0.5, 0.1], [-0.05, 0.1], [-0.05, -0.1], [0.5, -0.1]];
            let footprint = Footprint::polygon(vertices.map(Point::from).to_vec()).unwrap();
            Robot { footprint, ..robot }
        }
    }
}

/// All rules have something to refuse; the horizon is a cycle and twice the time to stop.
fn config(robot: &Robot, prediction: Prediction) -> DwaConfig {
    let usual = DwaConfig::for_robot(robot);
    let window = WindowConfig {
        prediction,
        horizon_s: 2.1,
        judged_s: 2.1,
        admissible: Admissible::StoppingDistance,
        ..usual.window
    };
    DwaConfig { window, ..usual }
}

fn decide(dwa: &Dwa, scene: &Scene<'_>) -> Result<Decision, NoCommand> {
    dwa.decide(scene, &mut DriveMemory::default(), &mut Scratch::default())
}

fn explain(dwa: &Dwa, scene: &Scene<'_>) -> Explanation {
    dwa.explain(scene, &DriveMemory::default())
}

fn evaluation(dwa: &Dwa, scene: &Scene<'_>) -> Evaluation {
    match decide(dwa, scene) {
        Ok(decision) => decision.evaluation,
        Err(why) => why.evaluation,
    }
}

/// Applies a change as a user would: other parameters, another robot, another pose.
fn drives_after(change: Change, robot: &Robot, config: &DwaConfig, at: &Scene<'_>) -> bool {
    let (mut robot, mut config, mut changed) = (robot.clone(), config.clone(), *at);
    if matches!(change, Change::Wait { .. } | Change::Turn { .. } | Change::BackUp { .. }) {
        while changed.velocity != Velocity::ZERO {
            let slower = robot.limits.braked(changed.velocity, robot.cycle_s);
            changed.pose = changed.pose.after_ramp(changed.velocity, slower, robot.cycle_s);
            changed.velocity = slower;
        }
    }
    match change {
        Change::Wait { .. } => {}
        Change::Turn { by_rad } => {
            let Pose { x, y, theta } = changed.pose;
            changed.pose = Pose::new(x, y, theta + by_rad);
        }
        Change::BackUp { v_min_mps } => {
            robot.limits.v_min_mps = v_min_mps;
            config.window.backwards = true;
        }
        Change::SafetyMargin { safety_margin_m } => config.window.safety_margin_m = safety_margin_m,
        Change::Footprint { smaller_by_m } => {
            robot.footprint = robot.footprint.smaller_by(smaller_by_m).unwrap();
        }
    }
    evaluation(&Dwa::new(config, robot).unwrap(), &changed).driving > 0
}

fn remedies(explanation: &Explanation) -> Vec<(&'static str, bool)> {
    let name = |change| match change {
        Change::Wait { .. } => "wait",
        Change::Turn { .. } => "turn",
        Change::BackUp { .. } => "back up",
        Change::SafetyMargin { .. } => "margin",
        Change::Footprint { .. } => "footprint",
    };
    explanation.remedies.iter().map(|remedy| (name(remedy.change), remedy.frees)).collect()
}

#[test]
fn contacts_are_where_the_wall_is() {
    // The robot's front is 0.4 m from the wall, less a margin of 5 mm: 0.79 s at 0.5 m/s.
    let wall = grid(|x, _| x >= 40);
    let at = scene(&wall, Pose::new(2.0 - 0.18 - 0.4, 1.5, 0.0), Velocity::new(0.5, 0.0));
    for (prediction, tolerance_s) in [(Prediction::Arcs, 1.1e-3), (Prediction::Euler, 0.1)] {
        let robot = small(0);
        let dwa = Dwa::new(config(&robot, prediction), robot).unwrap();
        let explanation = explain(&dwa, &at);
        let straight_on = |one: &&JudgedCandidate| one.velocity == Velocity::new(0.5, 0.0);
        let one = explanation.candidates.iter().find(straight_on).unwrap();
        let Fate::Refused { rule, free_for_s: Some(free_for_s), .. } = &one.fate else {
            panic!("{one:?}")
        };
        assert_eq!(rule, CONTACT);
        assert!((0.79 - tolerance_s..=0.79 + 1e-9).contains(free_for_s), "{free_for_s}");
        assert!((one.poses[9].x - (at.pose.x + 0.5 * free_for_s)).abs() < 1e-9);
    }
}

#[test]
fn facing_a_wall_a_turn_frees_and_waiting_does_not() {
    let wall = grid(|x, _| x >= 40);
    let robot = small(0);
    let dwa = Dwa::new(config(&robot, Prediction::Arcs), robot).unwrap();
    let at = scene(&wall, Pose::new(2.0 - 0.18 - 0.021, 1.5, 0.0), Velocity::ZERO);
    let explanation = explain(&dwa, &at);
    let expected =
        [("wait", false), ("turn", true), ("back up", true), ("margin", true), ("footprint", true)];
    assert_eq!(remedies(&explanation), expected);
    // To the right is the guide point. The slowest candidate, v = 0.01 m/s with omega = 0.3 rad/s
    // after a cycle of ramps, turns from 0.015 to 0.615 rad and comes 0.5 mm + v / omega (sin(a +
    // 0.615) - sin(a + 0.015)) nearer to the wall: 19.2 mm when it faces the wall, 17.0 mm after 15
    // degrees, 13.3 mm after 30; 16 mm are free.
    let Change::Turn { by_rad } = explanation.remedies[1].change else { panic!() };
    assert!((by_rad + PI / 6.0).abs() < 1e-9, "{by_rad}");
    // Without turning first, only candidates that hardly turn remain: so near to the wall, (7)
    // refuses the others. Straight on at 0.01 m/s, 20.5 mm are driven, so 0.5 mm may be left to the
    // margin.
    let Change::SafetyMargin { safety_margin_m } = explanation.remedies[3].change else { panic!() };
    assert!((0.0004..=0.0005).contains(&safety_margin_m), "{safety_margin_m}");
    // As soon as it can drive, there are no remedies.
    let away = Scene { pose: Pose::new(1.0, 1.5, 0.0), ..at };
    assert_eq!(explain(&dwa, &away).remedies, []);
}

#[test]
fn in_a_narrow_room_a_turn_does_not_help() {
    // A box of 0.6 m x 0.3 m in a room of 0.65 m x 0.35 m.
    let room = grid(|x, y| !((20..33).contains(&x) && (20..27).contains(&y)));
    let robot = small(1);
    let dwa = Dwa::new(config(&robot, Prediction::Arcs), robot).unwrap();
    let middle = Pose::new(1.325, 1.175, 0.0);
    let at = scene(&room, Pose { x: middle.x + 0.017, ..middle }, Velocity::ZERO);
    let explanation = explain(&dwa, &at);
    let expected = [
        ("wait", false),
        ("turn", false),
        ("back up", true),
        ("margin", false),
        ("footprint", true),
    ];
    assert_eq!(remedies(&explanation), expected);
    let Change::Footprint { smaller_by_m } = explanation.remedies[4].change else { panic!() };
    // 8 mm are free ahead; the slowest candidate drives 20.5 mm and keeps 5 mm. The front, 0.3 m
    // away, moves back twice as far as the sides: 8 + 2 x >= 25.5.
    assert!((0.00875..=0.00985).contains(&smaller_by_m), "{smaller_by_m}");
}

#[test]
fn a_follower_has_no_candidates() {
    let robot = small(0);
    let follower = crate::local::FollowerConfig::for_robot(&robot);
    let follower = crate::local::Follower::new(follower, robot).unwrap();
    let open = grid(|_, _| false);
    let at = scene(&open, Pose::new(1.5, 1.5, 0.0), Velocity::ZERO);
    assert_eq!(follower.explain(&at, &DriveMemory::default()), Explanation::default());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn says_what_a_decision_does(blocks in prop::collection::vec((0i32..60, 0i32..60), 0..60),
                                 heading in -3.0..3.0f64, speed in 0.0..0.5f64, turn in -1.0..1.0f64,
                                 shape in 0..4usize, prediction in prop_oneof![Just(Prediction::Arcs), Just(Prediction::Euler)],
                                 is_usual: bool) {
        let world = grid(|x, y| blocks.iter().any(|&(bx, by)| (bx - x).abs() < 2 && (by - y).abs() < 2));
        let robot = small(shape);
        let mut config = if is_usual { DwaConfig::for_robot(&robot) } else { config(&robot, prediction) };
        // The poses that are drawn end with the rollout.
        config.window.judged_s = config.window.horizon_s;
        let dwa = Dwa::new(config.clone(), robot.clone()).unwrap();
        let at = scene(&world, Pose::new(1.5, 1.5, heading), Velocity::new(speed, turn));
        let (decision, explanation) = (decide(&dwa, &at), explain(&dwa, &at));
        let evaluation = evaluation(&dwa, &at);

        prop_assert_eq!(explanation.candidates.len(), evaluation.candidates as usize);
        let drives = |one: &&JudgedCandidate| one.score().is_some() && one.velocity.v != 0.0;
        prop_assert_eq!(explanation.candidates.iter().filter(drives).count(), evaluation.driving as usize);
        for rejection in evaluation.rejected.as_slice() {
            let by_it = |one: &&JudgedCandidate| matches!(&one.fate,
                Fate::Refused { rule, because, .. } if *rule == rejection.rule && *because == rejection.because);
            let count = explanation.candidates.iter().filter(by_it).count();
            prop_assert_eq!(count, rejection.count as usize, "{}", rejection.rule);
        }
        let chosen = explanation.chosen();
        prop_assert_eq!(chosen.map(|one| one.velocity), decision.ok().map(|decision| decision.command));
        prop_assert_eq!(chosen.map(|one| one.shares.clone()).unwrap_or_default(), evaluation.chosen);
        prop_assert_eq!(explanation.runner_up().map(|one| one.shares.clone()), evaluation.runner_up);

        let window = DynamicWindow::new(config.window.clone(), robot.clone()).unwrap();
        let mut shrunk = Vec::new();
        let mut memory = RollMemory::default();
        let lattice = window.lattice(&at);
        window.roller(&at, &mut shrunk).roll(&lattice, &mut memory);
        for (one, (_, rollout)) in explanation.candidates.iter().zip(memory.rollouts().all(&lattice)) {
            prop_assert_eq!(one.poses.len(), 10);
            if let Some(rollout) = rollout {
                let last = one.poses[9];
                prop_assert!(last.point().distance(rollout.judged.point()) < 1e-9, "{:?} {:?}", last, rollout.judged);
                prop_assert!((last.theta - rollout.judged.theta).abs() < 1e-9);
            }
        }

        prop_assert_eq!(explanation.remedies.is_empty(), evaluation.driving > 0);
        let turns = |remedy: &Remedy| matches!(remedy.change, Change::Turn { .. });
        prop_assert!(robot.limits.turns_in_place() || !explanation.remedies.iter().any(turns));
        for remedy in &explanation.remedies {
            // If no turn helps, all of them were tried, not only this one.
            if remedy.frees || !matches!(remedy.change, Change::Turn { .. } | Change::Wait { .. } | Change::BackUp { .. }) {
                prop_assert_eq!(drives_after(remedy.change, &robot, &config, &at), remedy.frees, "{}", remedy);
            }
        }
    }

    /// Near a wall that it faces, so that cases in which nothing drives are more frequent.
    #[test]
    fn what_frees_is_true(gap_m in 0.0..0.03f64, heading in -0.7..0.7f64, speed in prop_oneof![Just(0.0), 0.1..0.5f64],
                          shape in 0..4usize, lane in 0..2usize) {
        let world = grid(|x, y| x >= 40 || (lane == 1 && !(26..=33).contains(&y)));
        let robot = small(shape);
        let config = config(&robot, Prediction::Arcs);
        let dwa = Dwa::new(config.clone(), robot.clone()).unwrap();
        let reach_m = |theta: f64| match &robot.footprint {
            Footprint::Circle(circle) => circle.radius_m(),
            Footprint::Polygon(polygon) => polygon.vertices().iter()
                .map(|v| v.x * theta.cos() - v.y * theta.sin()).fold(0.0, f64::max),
        };
        let heading = if lane == 1 { 0.0 } else { heading };
        let pose = Pose::new(2.0 - reach_m(heading) - gap_m, 1.5, heading);
        prop_assume!(robot.footprint.is_free(pose, &world));
        let at = scene(&world, pose, Velocity::new(speed, 0.0));
        let explanation = explain(&dwa, &at);
        for remedy in &explanation.remedies {
            if remedy.frees {
                prop_assert!(drives_after(remedy.change, &robot, &config, &at), "{}", remedy);
            }
        }
    }
}
