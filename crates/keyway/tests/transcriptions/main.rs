//! The papers' local planners against literal transcriptions of their equations, in every cycle of
//! whole runs.
//!
//! The transcriptions are plain and slow: own rollouts by Euler steps, distances to all squares of
//! the map one after the other, own normalisation, own search for the best. They share the map,
//! the robot's limits and the state at the beginning of each cycle with the planners, and nothing
//! else.
//!
//! Two commands are equal if neither component differs by more than 1e-9. Otherwise it is a tie if
//! the planner's command is a candidate of the transcription with a score that is at most 1e-9
//! below its best. In a cycle in which a candidate passes an obstacle at less than 0.2 mm, the
//! commands may differ, because that candidate may be admissible or not. Both are counted, and at
//! most one cycle of a hundred may be such a one.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

mod guided;
mod guides;
mod window;
mod world;

use guides::{KeyPoint, LocalGoal};
use keyway::geometry::{Point, Polyline, Pose, Velocity};
use keyway::guide::{
    Guide, GuideMemory, GuideView, KeyPoints, KeyPointsConfig, LocalGoals, LocalGoalsConfig,
};
use keyway::local::{
    AdaptiveDwa, AdaptiveDwaConfig, Detour, DistanceAt, DriveMemory, Dwa, DwaConfig, GuidedDwa,
    GuidedDwaConfig, GuidedWeights, KeyPointDwa, KeyPointDwaConfig, LocalPlanner, Scene, Scratch,
    WindowConfig,
};
use keyway::robot::Robot;
use window::{Evaluated, State, Terms};
use world::World;

/// The command that a transcription expects in a cycle.
pub(crate) enum Wanted {
    /// The best of the admissible candidates.
    BestOf {
        /// All of them, slowest first.
        all: Vec<Evaluated>,
        /// True if a candidate passes an obstacle so closely that it may be refused.
        has_doubt: bool,
    },
    /// This velocity, without any candidates.
    Exactly(State),
    /// No velocity is admissible.
    Nothing,
}

/// Counters of a run.
#[derive(Debug, Default)]
struct Tally {
    cycles: u32,
    ties: u32,
    /// Cycles with another command, in which a candidate touches an obstacle within rounding.
    doubts: u32,
    /// Cycles in which a dynamic window decided.
    windows: u32,
    /// Cycles without an admissible velocity.
    blocked: u32,
    arrived: u32,
    /// Cycles of the return from behind an obstacle.
    back: u32,
}

/// Compares a decision with the expectation of a transcription.
fn compare(ours: Option<Velocity>, wanted: &Wanted, tally: &mut Tally, at: &str) {
    let is_same = |command: Velocity, v: f64, omega: f64| {
        (command.v - v).abs() <= 1e-9 && (command.omega - omega).abs() <= 1e-9
    };
    tally.cycles += 1;
    match (ours, wanted) {
        (None, Wanted::Nothing) => tally.blocked += 1,
        (Some(command), Wanted::Exactly(state)) => {
            assert!(
                is_same(command, state.v, state.omega),
                "{at}: {command:?}, transcribed {state:?}"
            );
        }
        (Some(command), Wanted::BestOf { all, has_doubt }) => {
            tally.windows += 1;
            let best = all.iter().map(|one| one.score).fold(f64::NEG_INFINITY, f64::max);
            // The first of the best.
            let first = all.iter().find(|one| one.score >= best).unwrap();
            if is_same(command, first.v, first.omega) {
                return;
            }
            if *has_doubt {
                tally.doubts += 1;
                return;
            }
            let own = all.iter().find(|one| is_same(command, one.v, one.omega));
            let own =
                own.unwrap_or_else(|| panic!("{at}: {command:?} is not admissible, {first:?} is"));
            assert!(own.score >= best - 1e-9, "{at}: {own:?}, transcribed {first:?}");
            tally.ties += 1;
        }
        (ours, Wanted::Nothing) => panic!("{at}: {ours:?}, but nothing is admissible"),
        (ours, _) => panic!("{at}: {ours:?}, but something is admissible"),
    }
}

/// The decision rule of a transcription, for the state and the world as known so far.
type Transcription<'a> = dyn FnMut(&World, State) -> Wanted + 'a;

/// A whole run of a planner with its guide; compares every decision.
fn run(
    world: &mut World,
    path: &Polyline,
    planner: &dyn LocalPlanner,
    guide: &dyn Guide,
    transcription: &mut Transcription<'_>,
    tally: &mut Tally,
) {
    let robot = Robot::paper();
    let (start, goal) = (path.points()[0], *path.points().last().unwrap());
    let ahead = path.points()[1] - start;
    let mut state = State { x: start.x, y: start.y, theta: ahead.heading(), v: 0.0, omega: 0.0 };
    let (mut memory, mut guide_memory) = (DriveMemory::default(), GuideMemory::default());
    let mut scratch = Scratch::default();
    for cycle in 0..900 {
        let position = Point::new(state.x, state.y);
        if position.distance(goal) <= 0.5 {
            tally.arrived += 1;
            return;
        }
        world.sense(position, f64::from(cycle) * robot.cycle_s);
        let field = world.field();
        let pose = Pose::new(state.x, state.y, state.theta);
        let velocity = Velocity::new(state.v, state.omega);
        let view = GuideView { path, position, obstacles: field.clearance(), clearance_m: 0.0 };
        let point = guide.guide(&view, &mut guide_memory).unwrap().point;
        let sensed = world.sensed();
        let scene = Scene {
            obstacles: &field,
            sensed: &sensed,
            seen: keyway::sense::SeenCells::ANYWHERE,
            movers: &[],
            walked: &[],
            pose,
            velocity,
            guide: point,
            path,
            goal_heading_rad: None,
            remaining_m: f64::INFINITY,
            jerk_limited: None,
        };
        let decision = planner.decide(&scene, &mut memory, &mut scratch);
        let wanted = transcription(world, state);
        tally.back += u32::from(matches!(memory.detour(), Some(Detour::Back { .. })));
        let at = format!("cycle {cycle} at {state:?} with {memory:?}");
        let ours = decision.as_ref().ok().map(|decision| decision.command);
        compare(ours, &wanted, tally, &at);
        let command = decision.map_or_else(|why| why.fallback, |decision| decision.command);
        state = state.driven(command.v, command.omega);
    }
}

/// Small maps with cells of 1 m, and a route on each.
fn cases() -> Vec<(World, Polyline)> {
    let line = |points: &[[f64; 2]]| Polyline::new(points.iter().map(|&p| p.into()).collect());
    let blocks = [
        "............",
        "..........#.",
        "......##....",
        "......##....",
        "............",
        "..##........",
        "..##....#...",
        "............",
    ];
    let doorway = [
        "....#.......",
        "....#.......",
        "....#....##.",
        ".........##.",
        "....#.......",
        "....#...#...",
        "....#.......",
    ];
    let corridor = [
        "###############",
        "...............",
        "...............",
        "...............",
        "#######...#####",
        "......#...#....",
        "......#...#....",
        "......#...#....",
    ];
    let hall =
        ["..............", "..............", "..............", "..............", ".............."];
    vec![
        (World::new(&blocks, &[]), line(&[[1.5, 0.5], [5.0, 2.0], [9.0, 4.0], [10.5, 7.5]])),
        (World::new(&doorway, &[]), line(&[[0.7, 5.5], [3.5, 3.5], [5.5, 3.5], [10.5, 0.7]])),
        (World::new(&corridor, &[]), line(&[[8.5, 0.6], [8.5, 5.0], [7.0, 5.5], [0.8, 5.5]])),
        // An unknown obstacle straight ahead.
        (World::new(&hall, &[(6, 2)]), line(&[[0.5, 2.5], [13.5, 2.5]])),
        (World::new(&hall, &[(6, 1), (7, 1)]), line(&[[0.5, 2.0], [13.2, 2.4]])),
    ]
}

/// Complete runs on all maps; returns the totals.
fn runs<'p>(
    planner: &dyn LocalPlanner,
    guide: &dyn Guide,
    mut transcription: impl FnMut(&'p Polyline) -> Box<Transcription<'p>>,
    cases: &'p mut [(World, Polyline)],
) -> Tally {
    let mut tally = Tally::default();
    for (world, path) in cases {
        let mut transcribed = transcription(path);
        run(world, path, planner, guide, &mut *transcribed, &mut tally);
    }
    assert!(tally.cycles > 500 && tally.windows > 300, "{tally:?}");
    assert!((tally.ties + tally.doubts) * 100 <= tally.cycles, "{tally:?}");
    tally
}

#[test]
fn classic_dwa_with_the_distance_along_the_trajectory() {
    let planner = Dwa::new(DwaConfig::PAPER, Robot::paper()).unwrap();
    let guide = KeyPoints::new(KeyPointsConfig::PAPER).unwrap();
    let transcription = |path| -> Box<Transcription<'_>> {
        let mut key_point = KeyPoint::on(path);
        Box::new(move |world, state| {
            let target = key_point.at(state);
            window::best(world, state, target, [false; 2], |all| {
                window::classic(all, [0.08, 0.2, 0.1], 5.0)
            })
        })
    };
    let tally = runs(&planner, &guide, transcription, &mut cases());
    assert!(tally.arrived >= 4, "{tally:?}");
}

#[test]
fn classic_dwa_of_the_matlab_sample() {
    let planner = Dwa::new(DwaConfig::SAMPLE, Robot::paper()).unwrap();
    assert_eq!(DwaConfig::SAMPLE.window.distance_at, DistanceAt::End);
    let guide = KeyPoints::new(KeyPointsConfig::PAPER).unwrap();
    let transcription = |path| -> Box<Transcription<'_>> {
        let mut key_point = KeyPoint::on(path);
        Box::new(move |world, state| {
            let target = key_point.at(state);
            window::best(world, state, target, [true; 2], |all| {
                window::classic(all, [0.08, 0.2, 0.1], 1.0)
            })
        })
    };
    let tally = runs(&planner, &guide, transcription, &mut cases());
    assert!(tally.arrived >= 4, "{tally:?}");
}

#[test]
fn key_point_dwa() {
    let planner = KeyPointDwa::new(KeyPointDwaConfig::PAPER, Robot::paper()).unwrap();
    let guide = KeyPoints::new(KeyPointsConfig::PAPER).unwrap();
    let mut gammas = Vec::new();
    let mut all_cases = cases();
    let transcription = |path| -> Box<Transcription<'_>> {
        let mut key_point = KeyPoint::on(path);
        Box::new(move |world, state| {
            let target = key_point.at(state);
            let gamma = window::gamma(world, state);
            window::best(world, state, target, [false; 2], |all| {
                window::classic(all, [0.15, 0.1, gamma], 5.0)
            })
        })
    };
    let tally = runs(&planner, &guide, transcription, &mut all_cases);
    assert!(tally.arrived >= 4, "{tally:?}");
    for (world, path) in &all_cases {
        for point in path.points() {
            let state = State { x: point.x, y: point.y, theta: 0.0, v: 0.0, omega: 0.0 };
            gammas.push(window::gamma(world, state));
        }
    }
    assert!(gammas.contains(&0.3) && gammas.iter().any(|&gamma| gamma < 0.2), "{gammas:?}");
}

#[test]
fn adaptive_dwa() {
    let planner = AdaptiveDwa::new(AdaptiveDwaConfig::PAPER, Robot::paper()).unwrap();
    let guide = LocalGoals::new(LocalGoalsConfig::PAPER).unwrap();
    let transcription = |path| -> Box<Transcription<'_>> {
        let mut local_goal = LocalGoal::on(path);
        Box::new(move |world, state| {
            let target = local_goal.at(state);
            window::best(world, state, target, [true; 2], window::adaptive)
        })
    };
    let tally = runs(&planner, &guide, transcription, &mut cases());
    assert!(tally.arrived >= 2, "{tally:?}");
}

/// The guidance with the published weights, and with weights that keep the robot far from
/// obstacles. With the published ones it stops in front of the obstacle that it should drive
/// around: the point behind it is straight ahead.
#[test]
fn guided_dwa() {
    let guide = KeyPoints::new(KeyPointsConfig::PAPER).unwrap();
    let paper = GuidedDwaConfig::PAPER.weights;
    assert_eq!((paper.heading, paper.target_distance, paper.obstacle_distance), (0.08, 0.1, 0.2));
    for (weights, least_arrived) in [([0.08, 0.1, 0.2], 2), ([0.05, 0.1, 1.0], 4)] {
        let [heading, target_distance, obstacle_distance] = weights;
        let of_config = GuidedWeights { heading, target_distance, obstacle_distance };
        let config = GuidedDwaConfig { weights: of_config, ..GuidedDwaConfig::PAPER };
        let planner = GuidedDwa::new(config, Robot::paper()).unwrap();
        let transcription = |path| -> Box<Transcription<'_>> {
            let mut whole = guided::Whole::on(path, weights);
            Box::new(move |world, state| whole.wanted(world, state))
        };
        let tally = runs(&planner, &guide, transcription, &mut guided::cases());
        assert!(tally.arrived >= least_arrived, "{tally:?}");
        assert!(tally.cycles - tally.windows - tally.blocked > 100, "follows: {tally:?}");
        assert!(least_arrived == 2 || tally.back > 20, "returns: {tally:?}");
    }
}

/// The window that the transcriptions assume is the published one.
#[test]
fn the_published_window() {
    let WindowConfig { horizon_s, prediction_step_s, v_step_mps, omega_step_radps, .. } =
        WindowConfig::PAPER;
    assert_eq!((horizon_s, prediction_step_s, v_step_mps), (3.0, 0.1, 0.01));
    assert!((omega_step_radps.to_degrees() - 1.0).abs() < 1e-12);
    let _: fn(&[Terms]) -> Vec<f64> = window::adaptive;
}
