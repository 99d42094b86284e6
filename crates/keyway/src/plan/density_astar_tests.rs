//! The formulas by hand, a scene by hand, safe children, and the bounds on paths.

use super::*;
use crate::map::{
    CellState, GridFrame, LayerConfig, OccupancyGrid, PublishedConstraints, UnknownPolicy,
};
use crate::plan::{AStar, AStarConfig, Stop};
use crate::search::{Cost, Neighbours, Side, Successors, Uniform};
use proptest::prelude::*;

const SCOPES: [Density; 4] = [Density::Box, Density::Remaining, Density::Map, Density::None];

/// Expanded cells.
#[derive(Default)]
struct Log(Vec<Cell>);

impl Observer for Log {
    fn expanded(&mut self, _: Side, at: Cell, _: f64) {
        self.0.push(at);
    }
}

fn map(rows: &[&str]) -> SearchMap {
    SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
}

fn run(config: DensityAStarConfig, map: &SearchMap, query: &Query) -> (Option<Plan>, Log) {
    let (mut log, mut plan) = (Log::default(), Plan::default());
    let mut workspace = Workspace::default();
    let result =
        DensityAStar::new(config).plan_into(map, query, &mut workspace, Some(&mut log), &mut plan);
    (result.is_ok().then_some(plan), log)
}

fn cells(pairs: &[(i32, i32)]) -> Vec<Cell> {
    pairs.iter().map(|&(x, y)| Cell::new(x, y)).collect()
}

/// At the start e^0 = 1: 1 + 1 / 2. At the goal e^2 = 7.389: 1 + 1 / 8.389 = 1.1192. Halfway e^1 =
/// 2.718: 1 + 1 / 3.718 = 1.2689.
#[test]
fn the_weight_by_hand() {
    assert_eq!(sigmoid_weight(0.0), 1.5);
    assert!((sigmoid_weight(0.5) - 1.2689).abs() < 1e-4);
    assert!((sigmoid_weight(1.0) - 1.1192).abs() < 1e-4);
    assert_eq!(sigmoid_weight(1e9), 1.0);
}

/// Without the sigmoid and without density the search is A*.
#[test]
fn without_weights_it_is_astar() {
    let map = map(&["..#..", "..#..", "..#..", ".....", "....."]);
    let query = Query::new(Cell::new(0, 4), Cell::new(4, 4));
    let (weight, density) = (EstimateWeight::One, Density::None);
    let config = DensityAStarConfig { weight, density, ..DensityAStarConfig::PAPER };
    let expanded = |weight| run(DensityAStarConfig { weight, ..config.clone() }, &map, &query).1.0;
    let (mut log, mut plan) = (Log::default(), Plan::default());
    let astar =
        AStar::new(AStarConfig { heuristic: Heuristic::Euclidean, ..AStarConfig::default() });
    let mut workspace = Workspace::default();
    astar.plan_into(&map, &query, &mut workspace, Some(&mut log), &mut plan).unwrap();
    assert_eq!(expanded(EstimateWeight::One), log.0);
    assert_ne!(expanded(EstimateWeight::Sigmoid), log.0);
}

/// 1.25 * 2 + 1.5 * 3 = 7.
#[test]
fn the_evaluation_by_hand() {
    assert_eq!(evaluation(0.25, 2.0, 1.5, 3.0), 7.0);
}

fn share(density: Density, map: &SearchMap, query: &Query, at: Cell) -> f64 {
    Share::of(density, map, query, &mut SummedArea::default()).at(map.index(at))
}

/// Start (0, 0), goal (3, 1), node (1, 2). The box of start and goal has 8 cells with one obstacle,
/// that of node and goal 6 with two (the unknown cell does not count), the map 15 with four.
#[test]
fn the_density_by_hand() {
    let grid = OccupancyGrid::from_ascii(&["..#.#", ".?#..", "....#"]);
    let (query, node) = (Query::new(Cell::new(0, 0), Cell::new(3, 1)), Cell::new(1, 2));
    for unknown in [UnknownPolicy::Blocked, UnknownPolicy::Free, UnknownPolicy::Penalised] {
        let published = PublishedConstraints { expansion_cells: 1, ..PublishedConstraints::NONE };
        let config = LayerConfig { unknown, published, ..LayerConfig::default() };
        let map = SearchMap::new(&grid, config).unwrap();
        let share = |density| share(density, &map, &query, node);
        assert_eq!(SCOPES.map(share), [1.0 / 8.0, 2.0 / 6.0, 4.0 / 15.0, 0.0]);
    }
}

/// The scene, with g and f of each cell for P = 1/4 (the box is the row of S and G, one of four
/// cells an obstacle) and D = 3. The upper row is like the lower one.
///
/// ```text
///   .    .    .    .
///   S    #    .    G      G: g 4.414, f 1.25 * 4.414             = 5.518
///   .    .    .    .
///  (0, 0): g 1, d 1,     weight 1.3393, h 3.162: f 1.25 + 4.235 = 5.485
///  (1, 0): g 2, d 1.414, weight 1.2803, h 2.236: f 2.50 + 2.863 = 5.363
///  (2, 0): g 3, d 2.236, weight 1.1838, h 1.414: f 3.75 + 1.674 = 5.424
///  (3, 0): g 4, d 3.162, weight 1.1083, h 1:     f 5.00 + 1.108 = 6.108
///  (2, 1): g 4, d 2,     weight 1.2086, h 1:     f 5.00 + 1.209 = 6.209
/// ```
///
/// Corners are not cut, so the lower row is followed up to (2, 0). It generates the goal with
/// 5.518, but (0, 2) has 5.485, so the upper row is followed, too. Without P the lower row has
/// 5.235, 4.863, 4.674 and the goal 4.414: it comes before (0, 2) with 5.235.
#[test]
fn a_scene_by_hand() {
    let map = map(&["....", ".#..", "...."]);
    let query = Query::new(Cell::new(0, 1), Cell::new(3, 1));
    let (plan, log) = run(DensityAStarConfig::PAPER, &map, &query);
    let both_rows = [(0, 1), (0, 0), (1, 0), (2, 0), (0, 2), (1, 2), (2, 2), (3, 1)];
    assert_eq!(log.0, cells(&both_rows));
    let plan = plan.unwrap();
    assert_eq!(plan.cells, cells(&[(0, 1), (0, 0), (1, 0), (2, 0), (3, 1)]));
    assert_eq!(plan.cost.steps(), Some(Cost::new(3, 1)));

    let config = DensityAStarConfig { density: Density::None, ..DensityAStarConfig::PAPER };
    let (_, log) = run(config, &map, &query);
    assert_eq!(log.0, cells(&[(0, 1), (0, 0), (1, 0), (2, 0), (3, 1)]));
}

/// With a straight-line g the goal ends the search as soon as the cell beside it is expanded.
#[test]
fn the_letter_of_the_paper() {
    let map = map(&["...."]);
    let query = Query::new(Cell::new(0, 0), Cell::new(3, 0));
    let config = DensityAStarConfig { g: PathCost::StraightLine, ..DensityAStarConfig::PAPER };
    let (plan, log) = run(config, &map, &query);
    assert_eq!(log.0, cells(&[(0, 0), (1, 0), (2, 0)]));
    assert_eq!(plan.unwrap().stop, Some(Stop::GoalGenerated));
}

/// The children 1 2 3 / 4 . 5 / 6 7 8 of section 1.3 that are kept; obstacles themselves never
/// are.
fn safe_children(is_blocked: impl Fn(usize) -> bool) -> Vec<usize> {
    let dropped_by = |obstacle| match obstacle {
        // Class I: above, below.
        2 => [1, 2, 3],
        7 => [6, 7, 8],
        // Class II: left, right.
        4 => [1, 4, 6],
        5 => [3, 5, 8],
        // Class III: an obstacle on a diagonal drops no other child.
        corner => [corner; 3],
    };
    let obstacles = || (1..=8).filter(|&child| is_blocked(child));
    (1..=8).filter(|child| !obstacles().any(|o| dropped_by(o).contains(child))).collect()
}

#[test]
fn safe_children_are_the_steps_without_corner_cutting() {
    let offset = |child: usize| {
        let place = if child < 5 { child - 1 } else { child } as i32;
        (place % 3 - 1, 1 - place / 3)
    };
    let frame = *OccupancyGrid::from_ascii(&["...", "...", "..."]).frame();
    for pattern in 0..256_u32 {
        let is_blocked = |child: usize| pattern >> (child - 1) & 1 == 1;
        let grid = OccupancyGrid::from_fn(frame, |cell| {
            let child = (1..=8).find(|&child| offset(child) == (cell.x - 1, cell.y - 1));
            if child.is_some_and(is_blocked) { CellState::Occupied } else { CellState::Free }
        });
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let mut found = Vec::new();
        let neighbours = Neighbours::new(&map, Moves::Eight(CornerRule::Forbid), Uniform);
        neighbours.for_each(map.index(Cell::new(1, 1)), |step| {
            let to = map.cell(step.to);
            found.extend((1..=8).find(|&child| offset(child) == (to.x - 1, to.y - 1)));
        });
        found.sort_unstable();
        assert_eq!(found, safe_children(is_blocked), "pattern {pattern:08b}");
    }
}

fn any_scene() -> impl Strategy<Value = (OccupancyGrid, Query)> {
    let state = prop_oneof![
        7 => Just(CellState::Free),
        2 => Just(CellState::Occupied),
        1 => Just(CellState::Unknown)
    ];
    let states = prop::collection::vec(state, 20 * 12);
    (states, (0i32..20, 0i32..12), (0i32..20, 0i32..12)).prop_map(|(mut states, start, goal)| {
        for (x, y) in [start, goal] {
            states[(y * 20 + x) as usize] = CellState::Free;
        }
        let frame = GridFrame::new(20, 12, 1.0, crate::geometry::Pose::default()).unwrap();
        let grid = OccupancyGrid::from_fn(frame, |cell| states[(cell.y * 20 + cell.x) as usize]);
        (grid, Query::new(Cell::new(start.0, start.1), Cell::new(goal.0, goal.1)))
    })
}

fn any_corners() -> impl Strategy<Value = CornerRule> {
    prop_oneof![Just(CornerRule::Forbid), Just(CornerRule::Allow)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn the_density_by_brute_force((grid, query) in any_scene(), at in (0i32..20, 0i32..12), free_unknown: bool) {
        let unknown = if free_unknown { UnknownPolicy::Free } else { UnknownPolicy::Blocked };
        let map = SearchMap::new(&grid, LayerConfig { unknown, ..LayerConfig::default() }).unwrap();
        let at = Cell::new(at.0, at.1);
        let between = |v: i32, a: i32, b: i32| (a <= v && v <= b) || (b <= v && v <= a);
        let count = |a: Cell, b: Cell| {
            let inside = grid.frame().cells()
                .filter(|c| between(c.x, a.x, b.x) && between(c.y, a.y, b.y)).collect::<Vec<_>>();
            let occupied = inside.iter().filter(|&&c| grid.state(c) == Some(CellState::Occupied));
            occupied.count() as f64 / inside.len() as f64
        };
        let expected = [
            count(query.start, query.goal),
            count(at, query.goal),
            count(Cell::new(0, 0), Cell::new(19, 11)),
            0.0,
        ];
        prop_assert_eq!(SCOPES.map(|density| share(density, &map, &query, at)), expected);
    }

    #[test]
    fn the_excess_is_bounded((grid, query) in any_scene(), corners in any_corners(), octile: bool) {
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let optimal = AStar::new(AStarConfig { corners, ..AStarConfig::default() });
        let mut optimum = Plan::default();
        let is_found = optimal
            .plan_into(&map, &query, &mut Workspace::default(), None, &mut optimum).is_ok();
        let heuristic = if octile { Heuristic::Octile } else { Heuristic::Euclidean };
        for density in [Density::Box, Density::Map, Density::None] {
            let closed = Closed::Reopen;
            let config =
                DensityAStarConfig { density, corners, closed, heuristic, ..DensityAStarConfig::PAPER };
            let (plan, _) = run(config, &map, &query);
            prop_assert_eq!(plan.is_some(), is_found);
            let Some(plan) = plan else { continue };
            let p = share(density, &map, &query, query.start);
            let bound = (1.5 / (1.0 + p)).max(1.0) * optimum.cost.cells() + 1e-6;
            prop_assert!(plan.cost >= optimum.cost, "{:?}", density);
            prop_assert!(plan.cost.cells() <= bound, "{:?} {:?} {}", density, plan.cost, bound);
        }
    }
}
