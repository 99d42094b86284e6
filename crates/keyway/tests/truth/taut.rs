//! The taut path without clearance against the topology of the plane: it passes every obstacle on
//! the same side as the line that it was pulled from, and is the shortest line that does.

use crate::homotopy::Obstacles;
use crate::sleeve::Sleeves;
use crate::support::{Raw, Rules, any_raw, query_on};
use keyway::geometry::Polyline;
use keyway::map::formats::{parse_scenarios, read_map};
use keyway::map::{Cell, LayerConfig, SearchMap};
use keyway::plan::shortest_line;
use keyway::plan::{Plan, PlannerConfig};
use keyway::search::{CornerRule, Query, Workspace};
use keyway::smooth::{Smoother, Taut};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// Relative rounding of lengths.
const ROUNDING: f64 = 1e-9;

/// Two ways to distinguish classes, which share only the definition of a point.
struct Classes {
    obstacles: Obstacles,
    sleeves: Sleeves,
}

impl Classes {
    fn new(map: &SearchMap) -> Self {
        let (width, height) = (map.frame().width() as i32, map.frame().height() as i32);
        let is_blocked = |cell| !map.is_free(cell);
        Self {
            obstacles: Obstacles::new(width, height, is_blocked),
            sleeves: Sleeves::new(width, height, is_blocked),
        }
    }
}

fn in_cells(map: &SearchMap, line: &Polyline) -> Polyline {
    Polyline::new(line.points().iter().map(|&p| map.frame().grid_from_world(p)).collect())
}

/// The line of a plan, if there is one.
pub(crate) fn planned(planner: &str, map: &SearchMap, query: &Query) -> Option<Polyline> {
    let planner = PlannerConfig::by_name(planner)?.build(map).ok()?;
    let mut plan = Plan::default();
    planner.plan_into(map, query, &mut Workspace::default(), None, &mut plan).ok()?;
    let centre = |cell| map.frame().world_from_cell(cell);
    Some(plan.line(map, centre(query.start), centre(query.goal)).into_polyline())
}

/// Pulls a line tight and checks that the result is the shortest line of its class. True if the
/// class is that of the shortest line of all.
fn check(map: &SearchMap, classes: &Classes, line: &Polyline) -> bool {
    let Classes { obstacles, sleeves } = classes;
    let smoothed = Taut.smooth(&line.clone().into(), &map.clearance(), 0.0);
    let path = smoothed.path.flattened(0.0);
    let context = || format!("{line:?}\n{path:?}");
    assert!(
        smoothed.sharp_corners.is_empty() && smoothed.kept_clearance_m.is_none(),
        "{}",
        context()
    );
    let (before, after) = (in_cells(map, line), in_cells(map, &path).merged());
    assert_eq!(obstacles.class(&after), obstacles.class(&before), "another class: {}", context());
    assert!(Obstacles::is_exact(&after), "{}", context());
    assert_eq!(obstacles.flaw(&after), None, "{}", context());
    let passages = sleeves.passages(&before);
    assert!(passages.is_some(), "{}", context());
    assert_eq!(sleeves.passages(&after), passages, "other gates: {}", context());
    let (length, least) = (after.length_m(), sleeves.shortest(&before).unwrap());
    assert!((length - least).abs() <= ROUNDING * least, "{least} cells: {}", context());
    assert!(length <= before.length_m() * (1.0 + ROUNDING), "longer: {}", context());

    let again = Taut.smooth(&path.clone().into(), &map.clearance(), 0.0);
    assert_eq!(again.path, smoothed.path, "again: {}", context());

    let points = line.points();
    let (start, goal) = (points[0], points[points.len() - 1]);
    let shortest = shortest_line(map, CornerRule::Forbid, start, goal).unwrap();
    let (length_m, least_m) = (path.length_m(), shortest.length_m());
    assert!(length_m >= least_m * (1.0 - ROUNDING), "shorter than possible: {}", context());
    let is_best = obstacles.class(&in_cells(map, &shortest)) == obstacles.class(&after);
    if is_best {
        assert!(length_m <= least_m * (1.0 + ROUNDING), "{least_m} m is possible: {}", context());
    }
    is_best
}

/// Folder of the bundled maps.
pub(crate) fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../keyway-cli/scenes")
}

#[test]
fn the_scenarios_of_a_bundled_map() {
    let grid = read_map(&scenes().join("rooms.map"), None).unwrap().grid;
    let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
    let classes = Classes::new(&map);
    let text = std::fs::read(scenes().join("rooms.map.scen")).unwrap();
    let mut checked = [0, 0];
    for scenario in parse_scenarios(&text).unwrap() {
        for planner in ["jps", "theta-star", "bidirectional-jps"] {
            let query = Query::new(scenario.start, scenario.goal);
            let Some(line) = planned(planner, &map, &query) else { continue };
            if scenario.start != scenario.goal {
                checked[usize::from(check(&map, &classes, &line))] += 1;
            }
        }
    }
    assert!(checked[0] > 20 && checked[1] > 70, "{checked:?}");
}

#[test]
fn pairs_on_a_map_of_a_house() {
    let grid = read_map(&scenes().join("small_house.yaml"), None).unwrap().grid;
    for clearance_m in [0.0, 0.2] {
        // A line of zero width around the cells that are blocked for a robot.
        let config = LayerConfig { clearance_m, ..LayerConfig::default() };
        let inflated = SearchMap::new(&grid, config).unwrap();
        let blocked = keyway::map::OccupancyGrid::from_fn(*grid.frame(), |cell| {
            if inflated.is_free(cell) {
                keyway::map::CellState::Free
            } else {
                keyway::map::CellState::Occupied
            }
        });
        let map = SearchMap::new(&blocked, LayerConfig::default()).unwrap();
        let classes = Classes::new(&map);
        let free: Vec<Cell> = map.frame().cells().filter(|&cell| map.is_free(cell)).collect();
        let mut checked = [0, 0];
        for k in 0..60 {
            let cell = |step: usize| free[(k + 1) * step % free.len()];
            let query = Query::new(cell(7919), cell(104_729));
            let planner = ["jps", "theta-star", "astar4"][k % 3];
            let Some(line) = planned(planner, &map, &query) else { continue };
            checked[usize::from(check(&map, &classes, &line))] += 1;
        }
        assert!(checked[0] + checked[1] > 20, "{checked:?}");
    }
}

/// Along the map's border, past cells on it, and past gaps between cells that touch only at a
/// corner.
#[test]
fn borders_and_diagonal_gaps() {
    let drawings: [&[&str]; 5] = [
        &["....", ".#..", ".#..", ".##."],
        &["......", "..#...", ".#.#..", "..#...", "......"],
        &["#....#", "......", "..##..", "#....#"],
        &[".#....", "..#...", "...#..", "....#.", "......"],
        &["......", ".####.", ".#..#.", ".#.#..", ".#....", "......"],
    ];
    for drawing in drawings {
        let height = drawing.len() as i32;
        let is_free =
            |x: i32, y: i32| drawing[(height - 1 - y) as usize].as_bytes()[x as usize] == b'.';
        let raw = Raw::from_fn(drawing[0].len() as i32, height, is_free);
        let map = raw.search_map(&Rules::default());
        let classes = Classes::new(&map);
        for start in raw.cells() {
            for goal in raw.cells().filter(|&goal| goal != start) {
                for planner in ["jps", "theta-star", "astar4"] {
                    if let Some(line) = planned(planner, &map, &Query::new(start, goal)) {
                        check(&map, &classes, &line);
                    }
                }
            }
        }
    }
}

#[test]
fn classes_by_hand() {
    // Two obstacles: a ring of cells that touch at corners, and one cell.
    let drawing = ["........", "..#.....", ".#.#..#.", "..#.....", "........"];
    let is_blocked = |cell: Cell| drawing[4 - cell.y as usize].as_bytes()[cell.x as usize] == b'#';
    let obstacles = Obstacles::new(8, 5, is_blocked);
    let line = |points: &[[f64; 2]]| Polyline::new(points.iter().map(|&p| p.into()).collect());
    let class = |points: &[[f64; 2]]| obstacles.class(&line(points));
    let above = class(&[[0.5, 2.5], [2.5, 4.5], [4.5, 2.5]]);
    assert_eq!(above.len(), 1);
    assert_eq!(class(&[[0.5, 2.5], [2.5, 0.5], [4.5, 2.5]]), []);
    assert_eq!(
        class(&[[0.5, 2.5], [1.0, 4.5], [7.5, 4.5], [4.5, 2.5]]),
        above,
        "over both and back"
    );
    let around =
        [[0.5, 2.5], [4.5, 4.5], [4.5, 0.5], [0.5, 0.5], [0.5, 4.5], [4.5, 4.5], [4.5, 2.5]];
    assert_eq!(class(&around), [above.clone(), above].concat(), "once around the ring");
    // Through the gap at (2, 2), along the side at its end, around a corner, and around nothing.
    let flaw = |points: &[[f64; 2]]| obstacles.flaw(&line(points));
    assert!(flaw(&[[1.5, 1.5], [2.5, 2.5]]).is_some(), "a gap");
    assert!(
        flaw(&[[0.5, 2.0], [3.5, 2.0]]).is_some(),
        "along two edges, through the gap between them"
    );
    assert!(flaw(&[[0.5, 1.0], [5.5, 1.0]]).is_none(), "along an edge");
    assert!(flaw(&[[0.5, 1.5], [5.5, 1.5]]).is_some(), "through a cell");
    assert!(flaw(&[[2.5, 4.5], [4.0, 3.0], [4.5, 0.5]]).is_none(), "around a corner");
    assert!(flaw(&[[0.5, 4.5], [4.0, 4.0], [4.5, 0.5]]).is_some(), "around nothing");
    assert!(flaw(&[[4.5, 4.5], [4.0, 3.0], [5.5, 4.5]]).is_some(), "away from the obstacle");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, ..ProptestConfig::default() })]

    #[test]
    fn random_maps(raw in any_raw(), ends: (u32, u32, u32, u32)) {
        let map = raw.search_map(&Rules::default());
        let query = query_on(&raw, ends);
        prop_assume!(query.start != query.goal);
        for planner in ["jps", "theta-star", "astar4"] {
            if let Some(line) = planned(planner, &map, &query) {
                check(&map, &Classes::new(&map), &line);
            }
        }
    }
}
