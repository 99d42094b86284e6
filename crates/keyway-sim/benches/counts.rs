//! Work of a fixed kind, once, between marks that callgrind knows: `.ci/counts` runs each case and
//! compares its instructions and cache misses with those that are committed. By hand: `counts`
//! lists the cases, `counts CASE` does the work of one.

#![allow(clippy::unwrap_used, missing_docs)]

use keyway::Robot;
use keyway::geometry::{Point, Pose, Velocity};
use keyway::map::{Cell, CellState, Edit, LayerConfig, OccupancyGrid, SearchMap};
use keyway::navigate::{Navigator, Stack};
use keyway::plan::{GlobalPlanner, Jps, Plan, PlannerConfig};
use keyway::random::Random;
use keyway::search::{Query, Workspace};
use keyway::sense::{Observation, SensorScan};
use keyway_sim::sim::{MovingObstacle, World};
use keyway_sim::worlds::{Clutter, GeneratedMap, Maze, Pattern, Rooms};
use std::hint::black_box;

const SIDE: i32 = 512;

/// Counts what this does, and nothing before or after it.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
}

/// A map of 512 x 512 cells of 1 m.
fn map(kind: &str) -> SearchMap {
    let clutter = |share, radius_m| Pattern::Clutter(Clutter { share, radius_m });
    let obstacles = match kind {
        "open" => clutter(0.1, [4.0, 20.0]),
        "rooms" => {
            Pattern::Rooms(Rooms { room_m: 31.0, door_m: 1.0, wall_m: 1.0, more_doors: 0.5 })
        }
        "clutter" => clutter(0.2, [0.4, 0.6]),
        "maze" => Pattern::Maze(Maze { corridor_m: 4.0, wall_m: 1.0 }),
        other => panic!("there is no map {other}"),
    };
    let side_m = f64::from(SIDE);
    let generated = GeneratedMap { obstacles, ..GeneratedMap::empty(side_m, side_m, 1.0) };
    SearchMap::new(&generated.generate(46, &[]).unwrap(), LayerConfig::default()).unwrap()
}

/// Pairs of cells with a path between them.
fn queries(map: &SearchMap, count: usize) -> Vec<Query> {
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let mut random = Random::new(46);
    let mut cell = || {
        let mut coordinate = || (random.unit() * f64::from(SIDE)) as i32;
        Cell::new(coordinate(), coordinate())
    };
    // On a map of its own: what a map learns of its queries is part of what is counted.
    let map = map.clone();
    std::iter::repeat_with(|| Query::new(cell(), cell()))
        .filter(|query| Jps.plan_into(&map, query, &mut workspace, None, &mut plan).is_ok())
        .take(count)
        .collect()
}

/// Queries to a planner, of which so many rounds were asked before.
fn plan(planner: &str, kind: &str, count: usize, rounds_before: usize) {
    let map = map(kind);
    let queries = queries(&map, count);
    let planner = PlannerConfig::by_name(planner).unwrap().build(&map).unwrap();
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let mut ask = || {
        for query in &queries {
            planner.plan_into(&map, query, &mut workspace, None, &mut plan).unwrap();
            black_box(&plan);
        }
    };
    (0..rounds_before).for_each(|_| ask());
    counted(&mut ask);
}

fn layers() {
    let side_m = 2048.0;
    let rooms = Rooms { room_m: 31.0, door_m: 1.0, wall_m: 1.0, more_doors: 0.5 };
    let obstacles = Pattern::Rooms(rooms);
    let generated = GeneratedMap { obstacles, ..GeneratedMap::empty(side_m, side_m, 1.0) };
    let grid = generated.generate(46, &[]).unwrap();
    let config = LayerConfig { clearance_m: 2.5, ..LayerConfig::default() };
    counted(&mut || _ = black_box(SearchMap::new(&grid, config.clone()).unwrap()));
}

/// A block of 20 x 20 cells comes and goes at 50 places.
fn edits() {
    let mut map = map("rooms");
    let block = |at: i32, state| -> Vec<Edit> {
        let (x, y) = (at * 37 % 480, at * 101 % 480);
        let cells = (0..400).map(|i| Cell::new(x + i % 20, y + i / 20));
        cells.map(|cell| Edit { cell, state }).collect()
    };
    let edits: Vec<Vec<Edit>> = (0..50)
        .flat_map(|at| [block(at, CellState::Occupied), block(at, CellState::Free)])
        .collect();
    counted(&mut || edits.iter().for_each(|edits| map.apply(edits)));
}

/// A hundred cycles across a hall with posts that the map does not show, and people who walk.
fn cycles(robot: &str, movers: bool) {
    let robot = Robot::by_name(robot).unwrap();
    let clutter = Clutter { share: 0.06, radius_m: [0.15, 0.3] };
    let (start, goal) = (Pose::new(2.0, 5.0, 0.0), Point::new(18.0, 15.0));
    let obstacles = Pattern::Clutter(clutter);
    let generated =
        GeneratedMap { obstacles, free_ends_m: 1.5, ..GeneratedMap::empty(20.0, 20.0, 0.05) };
    let truth = generated.generate(46, &[start.point(), goal]).unwrap();
    let known = OccupancyGrid::all_free(*truth.frame());
    let walker = |x: f64, y: f64, vx: f64, vy: f64| {
        MovingObstacle::straight(Point::new(x, y), 0.25, Point::new(vx, vy)).unwrap()
    };
    let walkers = [walker(6.0, 9.0, 0.3, -0.4), walker(9.0, 6.0, -0.4, 0.3)];
    let world = World::from_known(&known, vec![]).unwrap().with_hidden(truth.occupied()).unwrap();
    let world = world.with_movers(if movers { walkers.to_vec() } else { Vec::new() });
    let stack = Stack::keyway(&robot).fit(&robot).unwrap();
    let mut navigator = Navigator::new(&known, &stack).unwrap();
    let (mut pose, mut velocity, mut t_s) = (start, Velocity::ZERO, 0.0);
    navigator.relocate(pose);
    navigator.set_goal(goal).unwrap();
    for _ in 0..100 {
        let scan = world.at(t_s).cast(pose, &robot.sensors[0]);
        let scans = [SensorScan::centred(t_s, &scan)];
        let mut command = Velocity::ZERO;
        counted(&mut || {
            navigator.observe(&Observation::new(t_s, pose, velocity, &scans));
            command = navigator.step().command();
        });
        let reached = robot.limits.reached(velocity, command, robot.cycle_s);
        pose = pose.after_ramp(velocity, reached, robot.cycle_s);
        (velocity, t_s) = (reached, t_s + robot.cycle_s);
    }
    assert!(pose.point().distance(start.point()) > 1.0, "it has not set out: {pose:?}");
}

/// The cases, by their names.
const CASES: [(&str, fn()); 14] = [
    ("jps-open-first", || plan("jps", "open", 1, 0)),
    ("jps-open", || plan("jps", "open", 200, 3)),
    ("jps-rooms-first", || plan("jps", "rooms", 1, 0)),
    ("jps-rooms", || plan("jps", "rooms", 200, 3)),
    ("jps-maze", || plan("jps", "maze", 100, 3)),
    ("jps-clutter", || plan("jps", "clutter", 50, 3)),
    ("bidirectional-optimal-rooms", || plan("bidirectional-optimal", "rooms", 50, 1)),
    ("astar-rooms", || plan("astar", "rooms", 10, 1)),
    ("prepared-rooms", || plan("prepared", "rooms", 1000, 1)),
    ("layers-rooms-2048", layers),
    ("edits-rooms", edits),
    ("cycles-small", || cycles("small", false)),
    ("cycles-jackal", || cycles("jackal", false)),
    ("cycles-jackal-movers", || cycles("jackal", true)),
];

fn main() {
    // `cargo bench` adds an option of its own.
    let wanted = std::env::args().skip(1).find(|argument| !argument.starts_with("--"));
    match wanted {
        None => CASES.iter().for_each(|(name, _)| println!("{name}")),
        Some(wanted) => match CASES.iter().find(|(name, _)| *name == wanted) {
            Some((_, work)) => work(),
            None => panic!("there is no case {wanted}"),
        },
    }
}
