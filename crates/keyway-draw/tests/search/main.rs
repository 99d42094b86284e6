//! Tests of searches: the shapes with which they are drawn, and (with the feature `raster`) their
//! animations.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

#[cfg(feature = "raster")]
mod animations;

use keyway::map::{Cell, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{Plan, PlannerConfig};
use keyway::search::{Observer, Query, Recording, Side, Workspace};
use keyway_draw::layers::{Meeting, SearchNodes, SearchTrace, TraceStyle};
use keyway_draw::{MapPicture, Svg};

const ROWS: [&str; 6] = [
    "............",
    "...######...",
    ".......#....",
    ".###...#....",
    "...#...#....",
    "...#........",
];

/// A planner's recorded search from the lower left to the middle, and its plan.
fn search(planner: &str) -> (OccupancyGrid, Recording, Plan) {
    let grid = OccupancyGrid::from_ascii(&ROWS);
    let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
    let query = Query::new(Cell::new(0, 0), Cell::new(9, 3));
    let planner = PlannerConfig::by_name(planner).unwrap().build(&map).unwrap();
    let (mut seen, mut plan) = (Recording::default(), Plan::default());
    let mut workspace = Workspace::default();
    planner.plan_into(&map, &query, &mut workspace, Some(&mut seen), &mut plan).unwrap();
    (grid, seen, plan)
}

fn picture(grid: &OccupancyGrid, seen: &Recording) -> Svg {
    let trace = SearchTrace::new(seen);
    MapPicture::new(grid).with(trace).with(SearchNodes(trace)).with(Meeting(trace)).svg()
}

/// Returns the texts of the legend after those of the map.
fn legend(picture: &Svg) -> Vec<String> {
    let texts = picture.as_str().lines().filter_map(|line| line.strip_suffix("</text>"));
    let texts: Vec<&str> = texts.filter_map(|line| line.rsplit('>').next()).collect();
    let map = texts.iter().position(|&text| text == "occupied" || text == "free").unwrap();
    let is_of_search = |text: &&&str| !["free", "occupied", "unknown"].contains(text);
    texts[map..].iter().filter(is_of_search).map(|&text| text.to_owned()).collect()
}

/// Returns the path data of the elements with a fill of one colour.
fn filled<'a>(picture: &'a Svg, color: &str) -> Vec<&'a str> {
    let fill = format!("fill=\"{color}\" d=\"");
    let paths = picture.as_str().lines().filter_map(|line| line.split_once(&fill));
    paths.map(|(_, data)| data.trim_end_matches("\"/>")).collect()
}

#[test]
fn cells_are_shaded_by_order_by_hand() {
    // A corridor of 6 cells: 0 and 1 are expanded, 2 is open; 4 events, so shades 0, 4, 8, 12.
    let grid = OccupancyGrid::from_ascii(&["......"]);
    let cell = |x| Cell::new(x, 0);
    let mut seen = Recording::default();
    seen.expanded(Side::Forward, cell(0), 0.0);
    seen.generated(Side::Forward, cell(1), cell(0), 1.0);
    seen.expanded(Side::Forward, cell(1), 1.0);
    seen.generated(Side::Forward, cell(2), cell(1), 2.0);
    let drawn = picture(&grid, &seen);
    assert_eq!(legend(&drawn), ["expanded, early to late", "generated only"]);
    // The darkest blue; that of shade 8, 8/15 of the distance along five steps: 2/3 from the
    // third colour (33, 113, 181) to the fourth (66, 146, 198); the tint of open cells. Shade 8
    // is the base, too.
    assert_eq!(filled(&drawn, "#08306b"), ["m0 0h1v1h-1z"]);
    assert_eq!(filled(&drawn, "#3787c0"), ["m0 0h2v1h-2z", "m1 0h1v1h-1z"]);
    assert_eq!(filled(&drawn, "#d6e8f5"), ["m2 0h1v1h-1z"]);

    // After two events cell 1 is still open, and shades are the same.
    let begin = MapPicture::new(&grid).with(SearchTrace::new(&seen).first(2)).svg();
    assert_eq!(filled(&begin, "#08306b"), ["m0 0h1v1h-1z"]);
    assert_eq!(filled(&begin, "#d6e8f5"), ["m1 0h1v1h-1z"]);
}

#[test]
fn two_sides_have_two_colours_and_meet() {
    let (grid, seen, plan) = search("bidirectional-optimal");
    assert!(plan.meeting.is_some());
    let drawn = picture(&grid, &seen);
    for text in
        ["expanded, early to late, from the start", "expanded, early to late, from the goal"]
    {
        assert!(legend(&drawn).iter().any(|entry| entry == text), "{:?}", legend(&drawn));
    }
    assert_eq!(legend(&drawn).last().unwrap(), "the two sides met");
    assert_eq!(drawn.as_str().matches(">M</text>").count(), 2, "on the map and in the legend");
    assert!(!legend(&picture(&grid, &search("astar").1)).iter().any(|text| text.contains("met")));
}

#[test]
fn jump_points_are_dots_and_scans_lines() {
    let (grid, seen, _) = search("jps");
    assert_eq!(TraceStyle::of(&seen), TraceStyle::JumpPoints);
    let drawn = picture(&grid, &seen);
    let entries = ["scans, early to late", "jump point, generated only", "jump point, expanded"];
    assert_eq!(legend(&drawn), entries);
    // The start is expanded: a line of length 0.
    assert!(drawn.as_str().contains("M0 0h0"), "{}", drawn.as_str());
}

#[test]
fn trees_are_distinguished_from_cells() {
    // A tree as RRT grows it: from the nearest node a step in any direction.
    let mut tree = Recording::default();
    let nodes = [(0, 0), (4, 1), (2, 5), (8, 3)].map(|(x, y)| Cell::new(x, y));
    for (at, parent) in [(1, 0), (2, 0), (3, 1)] {
        tree.expanded(Side::Forward, nodes[parent], 0.0);
        tree.generated(Side::Forward, nodes[at], nodes[parent], 0.0);
        tree.linked(Side::Forward, nodes[at], nodes[parent]);
    }
    tree.reparented(Side::Forward, nodes[2], nodes[1], 0.0);
    assert_eq!(TraceStyle::of(&tree), TraceStyle::Tree);
    let grid = OccupancyGrid::from_ascii(&ROWS);
    let drawn = picture(&grid, &tree);
    assert!(legend(&drawn).contains(&"search tree, early to late".to_owned()));
    assert!(drawn.as_str().contains("M4 1l-2 4"), "the last known link");
    assert!(!drawn.as_str().contains("M0 0l2 5"), "not the one before");

    // A preprocessed map has nodes on both sides, even if none is expanded.
    tree.generated(Side::Backward, nodes[2], nodes[3], 0.0);
    let entries = legend(&picture(&grid, &tree));
    for end in ["start", "goal"] {
        assert!(entries.contains(&format!("search tree, early to late, from the {end}")));
    }

    for name in ["rrt", "prepared"] {
        assert_eq!(TraceStyle::of(&search(name).1), TraceStyle::Tree, "{name}");
    }

    // Any-angle searches look at neighbours, though parents may be far.
    let mut cells = Recording::default();
    for x in 0..6 {
        cells.expanded(Side::Forward, Cell::new(x, 0), 0.0);
        cells.generated(Side::Forward, Cell::new(x + 1, 0), Cell::new(0, 0), 0.0);
    }
    assert_eq!(TraceStyle::of(&cells), TraceStyle::Cells);
    for name in ["dijkstra", "greedy", "astar", "astar4", "theta-star", "bidirectional-optimal"] {
        assert_eq!(TraceStyle::of(&search(name).1), TraceStyle::Cells, "{name}");
    }
    assert_eq!(TraceStyle::of(&Recording::default()), TraceStyle::Cells);
}

#[test]
fn events_outside_the_map_and_empty_recordings_are_harmless() {
    let grid = OccupancyGrid::from_ascii(&["."]);
    let mut seen = Recording::default();
    assert!(legend(&picture(&grid, &seen)).is_empty());
    for at in [Cell::new(-7, 0), Cell::new(0, 99), Cell::new(i32::MAX, i32::MIN)] {
        seen.expanded(Side::Backward, at, 0.0);
        seen.met(at);
    }
    assert!(!picture(&grid, &seen).as_str().contains("NaN"));
}
