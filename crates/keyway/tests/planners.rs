//! Jump point search against an independent truth, and the errors of planners if there is no path.
#![allow(clippy::unwrap_used)]

mod support;

use keyway::geometry::Pose;
use keyway::map::{
    Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap, UnknownPolicy,
};
use keyway::plan::{AStar, GlobalPlanner, Jps, Plan, PlanError, PlannerConfig};
use keyway::search::{Cost, Query, Workspace};
use proptest::prelude::*;
use support::{Rules, any_raw};

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn jps_finds_the_optimum(raw in any_raw(), free_unknown: bool,
                             ends in (0i32..14, 0i32..11, 0i32..14, 0i32..11)) {
        let unknown = if free_unknown { UnknownPolicy::Free } else { UnknownPolicy::Blocked };
        let rules = Rules { unknown, ..Rules::default() };
        let start = Cell::new(ends.0 % raw.width, ends.1 % raw.height);
        let goal = Cell::new(ends.2 % raw.width, ends.3 % raw.height);
        let query = Query::new(start, goal);
        let map = SearchMap::new(&raw.grid(), rules.layers()).unwrap();
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        for _ in 0..2 {
            match Jps.plan_into(&map, &query, &mut workspace, None, &mut plan) {
                Ok(()) => {
                    prop_assert_eq!(plan.cost.steps(), raw.optimum(&query, &rules), "{}", raw.drawing());
                    prop_assert_eq!((plan.cells[0], *plan.cells.last().unwrap()), (start, goal));
                    let steps = plan.cells.windows(2).map(|pair| raw.step(pair[0], pair[1], &rules));
                    let walked = steps.collect::<Option<Vec<Cost>>>().map(|steps| {
                        steps.into_iter().fold(Cost::default(), |sum, step| sum + step)
                    });
                    prop_assert_eq!(walked, plan.cost.steps(), "illegal step\n{}", raw.drawing());
                }
                Err(PlanError::NoPath { .. }) => {
                    prop_assert_eq!(raw.optimum(&query, &rules), None, "{}", raw.drawing());
                }
                Err(PlanError::Blocked { .. }) => {}
                Err(other) => prop_assert!(false, "{}", other),
            }
        }
    }

    /// Wide maps, so that scans cross words, and many queries on one workspace.
    #[test]
    fn jps_agrees_with_astar(width in 60u64..200, height in 1u64..70, density in 0.02..0.4f64, seed: u64) {
        let frame = GridFrame::new(width, height, 1.0, Pose::default()).unwrap();
        let mut state = seed | 1;
        let mut random = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state
        };
        let grid = OccupancyGrid::from_fn(frame, |_| {
            let is_occupied = (random() % 10_000) as f64 / 10_000.0 < density;
            if is_occupied { CellState::Occupied } else { CellState::Free }
        });
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let mut workspace = Workspace::default();
        let (mut by_jps, mut by_astar) = (Plan::default(), Plan::default());
        for _ in 0..3 {
            let mut cell = || Cell::new((random() % width) as i32, (random() % height) as i32);
            let query = Query::new(cell(), cell());
            let jps = Jps.plan_into(&map, &query, &mut workspace, None, &mut by_jps);
            let astar = AStar::default().plan_into(&map, &query, &mut workspace, None, &mut by_astar);
            prop_assert_eq!(jps.is_ok(), astar.is_ok());
            prop_assert_eq!(by_jps.cost, by_astar.cost);
        }
    }
}

/// Also on maps without a free cell, and with one.
#[test]
fn plans_are_the_same_after_a_warm_up() {
    let drawings: [&[&str]; 4] =
        [&["#"], &["."], &["##.", "###"], &["....#...", ".##.#.#.", "...#..#.", ".#...#.."]];
    for (rows, name) in drawings.iter().flat_map(|rows| PlannerConfig::NAMES.map(|n| (rows, n))) {
        let map = SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap();
        let planner = PlannerConfig::by_name(name).unwrap().build(&map).unwrap();
        let (width, height) = (map.frame().width() as i32, map.frame().height() as i32);
        let query = Query::new(Cell::new(0, 0), Cell::new(width - 1, height - 1));
        let planned = |is_warm: bool| {
            let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
            if is_warm {
                planner.warm_up(&map, &mut workspace);
            }
            (planner.plan_into(&map, &query, &mut workspace, None, &mut plan), plan)
        };
        assert_eq!(planned(false), planned(true), "{name} on {rows:?}");
    }
}

#[test]
fn who_needs_one_cost_refuses_penalised_cells() {
    let grid = OccupancyGrid::from_ascii(&[".?."]);
    let config = LayerConfig { unknown: UnknownPolicy::Penalised, ..LayerConfig::default() };
    let map = SearchMap::new(&grid, config).unwrap();
    let query = Query::new(Cell::new(0, 0), Cell::new(2, 0));
    let refused = PlannerConfig::NAMES.into_iter().filter(|&name| {
        let planner = match PlannerConfig::by_name(name).unwrap().build(&map) {
            Ok(planner) => planner,
            Err(error) => {
                assert_eq!(error, PlanError::NeedsUniformCost { planner: name });
                return true;
            }
        };
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        let result = planner.plan_into(&map, &query, &mut workspace, None, &mut plan);
        match result {
            Ok(()) => assert_eq!(plan.cells.len(), 3, "{name}"),
            Err(error) => assert_eq!(error, PlanError::NeedsUniformCost { planner: name }),
        }
        assert_eq!(planner.needs_uniform_cost(), plan.cells.is_empty(), "{name}");
        plan.cells.is_empty()
    });
    let expected = [
        "jps",
        "prepared",
        "bidirectional-24",
        "bidirectional-jps-fixed",
        "bidirectional-jps",
        "rrt",
        "theta-star",
        "lazy-theta-star",
    ];
    assert_eq!(refused.collect::<Vec<_>>(), expected);
}

#[test]
fn a_budget_ends_the_search() {
    let grid = OccupancyGrid::from_ascii(&["....", "....", "...."]);
    let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
    let query = Query { budget: Some(2), ..Query::new(Cell::new(0, 0), Cell::new(3, 2)) };
    let mut plan = Plan::default();
    let error = AStar::default()
        .plan_into(&map, &query, &mut Workspace::default(), None, &mut plan)
        .unwrap_err();
    assert!(matches!(error, PlanError::BudgetExhausted { budget: 2, .. }));
    assert!(plan.cells.is_empty());
}

#[test]
fn errors_name_the_cell_and_the_nearest_free_one() {
    let grid = OccupancyGrid::from_ascii(&["..#"]);
    let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
    let ask = |start, goal| {
        AStar::default()
            .plan_into(
                &map,
                &Query::new(start, goal),
                &mut Workspace::default(),
                None,
                &mut Plan::default(),
            )
            .unwrap_err()
            .to_string()
    };
    let free = Cell::new(0, 0);
    assert_eq!(
        ask(free, Cell::new(2, 0)),
        "goal (2, 0) is inside an obstacle; the nearest free cell is (1, 0)"
    );
    assert_eq!(ask(Cell::new(-1, 0), free), "start (-1, 0) is outside the map of 3 x 1 cells");
}
