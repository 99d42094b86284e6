//! Plans, runs and statistics are bitwise the same on every machine: their digests are those of
//! `testdata/digests.toml`.
//!
//! To change a value on purpose, write the digests again with `KEYWAY_WRITE_DIGESTS=1`, and
//! explain the change in the changelog.
#![allow(clippy::unwrap_used)]

use keyway::geometry::Point;
use keyway::map::{LayerConfig, OccupancyGrid, SearchMap};
use keyway::navigate::{Goal, Stack};
use keyway::plan::PlannerConfig;
use keyway::robot::Robot;
use keyway::search::{IfUnreachable, Workspace};
use keyway::smooth::SmootherConfig;
use keyway_sim::episode::{Episode, EpisodeRobot, RandomMoving, RandomObstacles, RandomUnknown};
use keyway_sim::episode::{RobotReport, run_episode};
use keyway_sim::metrics::statistics::{Confidence, McNemarTest, Rate, Sample, SignedRankTest};
use keyway_sim::report::RouteRequest;
use keyway_sim::worlds::{Clutter, Corridors, GeneratedMap, Maze, Pattern, Rooms};
use std::collections::BTreeMap;
use std::path::Path;

/// Digests by name.
type Digests = BTreeMap<String, String>;

/// FNV-1a with 64 bits.
struct Digest(u64);

impl Digest {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        self
    }

    fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) -> &mut Self {
        for number in numbers {
            self.bytes(&number.to_bits().to_le_bytes());
        }
        self
    }

    fn text(&self) -> String {
        format!("{:016x}", self.0)
    }
}

/// A map of 12 m x 9 m.
fn map(seed: u64, obstacles: Pattern) -> OccupancyGrid {
    let map = GeneratedMap { obstacles, ..GeneratedMap::empty(12.0, 9.0, 0.1) };
    map.generate(seed, &ENDS.map(Point::from)).unwrap()
}

const ENDS: [[f64; 2]; 2] = [[1.05, 1.05], [10.95, 7.95]];

fn maps() -> [(&'static str, OccupancyGrid); 4] {
    let rooms = Rooms { room_m: 3.0, door_m: 1.0, wall_m: 0.1, more_doors: 0.5 };
    let corridors = Corridors { corridor_m: 1.5, room_m: [3.0, 2.5], door_m: 1.0, wall_m: 0.1 };
    [
        ("clutter", map(1, Pattern::Clutter(Clutter { share: 0.15, radius_m: [0.1, 0.4] }))),
        ("rooms", map(2, Pattern::Rooms(rooms))),
        ("maze", map(3, Pattern::Maze(Maze { corridor_m: 1.0, wall_m: 0.1 }))),
        ("corridors", map(4, Pattern::Corridors(corridors))),
    ]
}

/// Digest of the route of a planner and a smoother, and of the search statistics.
fn route_digest(
    grid: &OccupancyGrid,
    planner: &PlannerConfig,
    smoother: &SmootherConfig,
) -> String {
    let layers = LayerConfig { clearance_m: 0.2, ..LayerConfig::default() };
    let map = SearchMap::new(grid, layers).unwrap();
    let request = RouteRequest {
        grid,
        map: &map,
        planner: &*planner.build(&map).unwrap(),
        smoother: Some(&*smoother.build().unwrap()),
        start: Point::from(ENDS[0]),
        goals: &[Point::from(ENDS[1])],
        budget: None,
        if_unreachable: IfUnreachable::Fail,
        with_optimum: false,
    };
    let answer = request.answer(None, &mut Workspace::default()).unwrap();
    let mut digest = Digest::new();
    digest.bytes(&answer.plan.expanded.to_le_bytes());
    digest.bytes(&answer.plan.generated.to_le_bytes());
    let Some(route) = answer.route else { return digest.text() };
    digest.numbers(route.smoothed.points().iter().flat_map(|point| [point.x, point.y]));
    digest.text()
}

fn plans() -> Digests {
    let mut digests = Digests::new();
    for (name, grid) in maps() {
        let smoother = SmootherConfig::by_name("line-of-sight").unwrap();
        for planner in PlannerConfig::NAMES {
            let config = PlannerConfig::by_name(planner).unwrap();
            let digest = route_digest(&grid, &config, &smoother);
            digests.insert(format!("{name} {planner}"), digest);
        }
        let planner = PlannerConfig::by_name("jps").unwrap();
        for smoother in SmootherConfig::NAMES {
            let config = SmootherConfig::by_name(smoother)
                .unwrap()
                .keeping(Robot::small().preferred_clearance_m());
            let digest = route_digest(&grid, &planner, &config);
            digests.insert(format!("{name} jps {smoother}"), digest);
        }
    }
    digests
}

fn run_digest(reports: &[RobotReport]) -> String {
    let mut digest = Digest::new();
    for report in reports {
        digest.bytes(format!("{:?}", report.outcome).as_bytes());
        digest.numbers(report.trajectory.iter().flatten().flatten().copied());
        let run = report.run.as_ref();
        digest.numbers(run.into_iter().flat_map(|run| [run.time_s, run.length_m]));
    }
    digest.text()
}

/// An episode among unmapped obstacles, with a disturbed robot.
fn episode(known: &OccupancyGrid, robot: &Robot, stack: &str, moving: u32) -> RobotReport {
    let [start, goal] = ENDS.map(Point::from);
    let mut episode = Episode::new(known.clone(), robot.clone(), start, goal);
    episode.robots[0].stack = Stack::by_name(stack, robot).unwrap();
    let obstacles = RandomObstacles {
        unknown: Some(RandomUnknown { count: 3, radius_m: [0.1, 0.2] }),
        moving: Some(RandomMoving {
            count: moving,
            radius_m: [0.2, 0.3],
            speed_mps: [0.2, 0.6],
            gives_way: false,
        }),
        near_way_m: RandomObstacles::USUAL_NEAR_WAY_M,
        free_ends_m: RandomObstacles::USUAL_FREE_ENDS_M,
    };
    obstacles.put_into(&mut episode, 5).unwrap();
    let disturbances = &mut episode.robots[0].disturbances;
    disturbances.sensor.range_m = 0.01;
    disturbances.actuation.v_relative = 0.05;
    disturbances.actuation.delay_s = 0.05;
    disturbances.localisation.position_m = 0.02;
    episode.rules.time_limit_s = Some(60.0);
    run_episode(&episode).unwrap().first()
}

fn runs() -> Digests {
    let mut digests = Digests::new();
    let (small, jackal) = (Robot::small(), Robot::jackal());
    let [(_, clutter), (_, rooms), ..] = maps();
    for stack in Stack::NAMES {
        let report = episode(&clutter, &small, stack, 2);
        digests.insert(format!("clutter small {stack}"), run_digest(&[report]));
    }
    for (name, known) in [("rooms", &rooms), ("clutter", &clutter)] {
        for stack in [Stack::DEFAULT, "key-point-fusion"] {
            let report = episode(known, &jackal, stack, 1);
            digests.insert(format!("{name} jackal {stack}"), run_digest(&[report]));
        }
    }
    digests.insert("team".to_owned(), team());
    digests
}

/// Four robots of two kinds with crossing routes.
fn team() -> String {
    let known = map(0, Pattern::None);
    // All robots of a team have the same cycle.
    let jackal = || Robot { cycle_s: Robot::small().cycle_s, ..Robot::jackal() };
    let robot = |robot, from: [f64; 2], to: [f64; 2]| {
        let goal = Goal { position: Point::from(to), heading_rad: Some(1.0) };
        EpisodeRobot::new(robot, Point::from(from), goal)
    };
    let team = Episode::of_robots(
        known,
        vec![
            robot(Robot::small(), [2.0, 2.0], [9.0, 6.0]),
            robot(Robot::small(), [9.0, 6.5], [2.0, 2.5]),
            robot(jackal(), [2.0, 6.0], [9.0, 2.0]),
            robot(jackal(), [9.5, 2.5], [2.5, 7.0]),
        ],
    );
    run_digest(&run_episode(&team).unwrap().robots)
}

fn statistics() -> Digests {
    let half = Confidence::new(0.95).unwrap();
    let mut digests = Digests::new();
    for count in [5_u32, 12, 40, 200] {
        // Spread without a pattern, and some of them equal.
        let values = (0..count).map(|i| f64::from(i * i * 7 % 101) / 8.0 - 5.0);
        let sample = Sample::new(values.collect()).unwrap();
        let outcomes = || (0..count).map(|i| i * i % 7 < 3);
        let pairs = outcomes().zip((0..count).map(|i| i * i % 5 < 2));
        let mut digest = Digest::new();
        digest.numbers([sample.mean(), sample.quantile(0.3)]);
        digest.numbers(sample.standard_deviation());
        let texts = [
            format!("{:?}", sample.mean_interval(half, 3)),
            format!("{:?}", SignedRankTest::of_differences(&sample, half)),
            format!("{:?}", Rate::of(outcomes()).interval(half)),
            format!("{:?}", McNemarTest::of_pairs(pairs.map(|(a, b)| [a, b]))),
        ];
        digest.bytes(texts.concat().as_bytes());
        digests.insert(format!("of {count}"), digest.text());
    }
    digests
}

#[test]
fn plans_runs_and_statistics_are_those_that_were_committed() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/digests.toml");
    let found = BTreeMap::from([
        ("plans".to_owned(), plans()),
        ("runs".to_owned(), runs()),
        ("statistics".to_owned(), statistics()),
    ]);
    if std::env::var_os("KEYWAY_WRITE_DIGESTS").is_some() {
        std::fs::write(&path, toml::to_string(&found).unwrap()).unwrap();
    }
    let text = std::fs::read_to_string(&path).unwrap();
    let expected: BTreeMap<String, Digests> = toml::from_str(&text).unwrap();
    for (section, digests) in &found {
        let changed: Vec<_> = digests
            .iter()
            .filter(|(name, digest)| expected[section].get(*name) != Some(digest))
            .map(|(name, _)| name)
            .collect();
        assert!(changed.is_empty(), "{section}: {changed:#?}");
        assert_eq!(digests.len(), expected[section].len(), "{section}");
    }
}
