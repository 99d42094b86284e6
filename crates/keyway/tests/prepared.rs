//! Prepared maps: path costs equal to A* everywhere, valid only for their own map, and read from
//! files completely or not at all.
#![allow(clippy::unwrap_used)]

use keyway::geometry::Pose;
use keyway::map::{
    Cell, CellState, Edit, GridFrame, LayerConfig, OccupancyGrid, SearchMap, UnknownPolicy,
};
use keyway::plan::{AStar, GlobalPlanner, Plan, PlanError, PlannerConfig, PrepareError, Prepared};
use keyway::search::{Cost, Query, Workspace};
use proptest::prelude::*;
use std::ops::ControlFlow;

fn search_map(grid: &OccupancyGrid) -> SearchMap {
    SearchMap::new(grid, LayerConfig::default()).unwrap()
}

/// A map of scattered cells, or of rectangles, which have long walls.
fn grid(width: i32, height: i32, rectangles: bool, density: f64, seed: u64) -> OccupancyGrid {
    let mut random = xorshift(seed);
    let mut below = move |limit: i32| (random() % limit as u64) as i32;
    let mut occupied = vec![false; (width * height) as usize];
    let wanted = (density * f64::from(width * height)) as usize;
    while occupied.iter().filter(|cell| **cell).count() < wanted {
        let (x, y) = (below(width), below(height));
        let (w, h) = if rectangles { (1 + below(7), 1 + below(7)) } else { (1, 1) };
        for (x, y) in (y..y + h).flat_map(|y| (x..x + w).map(move |x| (x, y))) {
            if x < width && y < height {
                occupied[(y * width + x) as usize] = true;
            }
        }
    }
    let frame = GridFrame::new(width as u64, height as u64, 1.0, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let is_occupied = occupied[(cell.y * width + cell.x) as usize];
        if is_occupied { CellState::Occupied } else { CellState::Free }
    })
}

/// A transformed map: its size, and the mapping from its cells to those of the original.
type Held<'a> = (i32, i32, &'a dyn Fn(Cell) -> Cell);

fn xorshift(seed: u64) -> impl FnMut() -> u64 {
    let mut state = seed | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    }
}

fn drawing(map: &SearchMap) -> String {
    let (width, height) = (map.frame().width() as i32, map.frame().height() as i32);
    let cell = |x, y| if map.is_free(Cell::new(x, y)) { '.' } else { '#' };
    let row = |y| (0..width).map(|x| cell(x, y)).collect::<String>();
    (0..height).rev().map(row).collect::<Vec<_>>().join("\n")
}

/// The cost of a path that is legal step by step, judged on the blocked cells alone.
fn walked(map: &SearchMap, cells: &[Cell]) -> Option<Cost> {
    let step = |from: Cell, to: Cell| {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let free = |x, y| map.is_free(Cell::new(x, y));
        let beside = free(from.x + dx, from.y) && free(from.x, from.y + dy);
        let is_step = (dx, dy) != (0, 0) && dx.abs() <= 1 && dy.abs() <= 1;
        (is_step && beside && free(to.x, to.y))
            .then(|| Cost::octile(dx.unsigned_abs(), dy.unsigned_abs()))
    };
    cells.windows(2).try_fold(Cost::default(), |cost, pair| Some(cost + step(pair[0], pair[1])?))
}

/// Plans with both planners, and checks that they agree.
fn check(prepared: &Prepared, map: &SearchMap, query: &Query, workspace: &mut Workspace) {
    let (mut ours, mut theirs) = (Plan::default(), Plan::default());
    let answer = prepared.plan_into(map, query, workspace, None, &mut ours);
    let truth = AStar::default().plan_into(map, query, workspace, None, &mut theirs);
    let context = || format!("{query:?}\n{}", drawing(map));
    assert_eq!(answer.is_ok(), truth.is_ok(), "{}", context());
    assert_eq!(ours.cost, theirs.cost, "{}", context());
    if answer.is_ok() {
        let ends = (ours.cells[0], *ours.cells.last().unwrap());
        assert_eq!(ends, (query.start, query.goal), "{}", context());
        assert_eq!(walked(map, &ours.cells), ours.cost.steps(), "{}", context());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, ..ProptestConfig::default() })]

    #[test]
    fn all_pairs_of_small_maps(width in 1i32..13, height in 1i32..11, rectangles: bool,
                               density in 0.0..0.6f64, seed: u64) {
        let map = search_map(&grid(width, height, rectangles, density, seed));
        let prepared = Prepared::build(&map).unwrap();
        let mut workspace = Workspace::default();
        for start in map.frame().cells().filter(|&cell| map.is_free(cell)) {
            for goal in map.frame().cells() {
                check(&prepared, &map, &Query::new(start, goal), &mut workspace);
            }
        }
    }

    /// Scans cross words, and paths have many turns.
    #[test]
    fn large_maps(width in 60i32..220, height in 1i32..130, rectangles: bool,
                  density in 0.01..0.45f64, seed: u64) {
        let map = search_map(&grid(width, height, rectangles, density, seed));
        let prepared = Prepared::build(&map).unwrap();
        let mut workspace = Workspace::default();
        let mut random = xorshift(seed ^ 0x5555);
        let mut cell = || {
            let at = random();
            Cell::new((at % width as u64) as i32, (at / 1000 % height as u64) as i32)
        };
        for _ in 0..40 {
            check(&prepared, &map, &Query::new(cell(), cell()), &mut workspace);
        }
    }

    /// The cost does not depend on the orientation of a map.
    #[test]
    fn mirrored_and_turned_maps(width in 2i32..40, height in 2i32..40, rectangles: bool,
                                density in 0.0..0.4f64, seed: u64) {
        let original = grid(width, height, rectangles, density, seed);
        let mut random = xorshift(seed ^ 0xaaaa);
        let mut cell = || Cell::new((random() % width as u64) as i32, (random() % height as u64) as i32);
        let queries: Vec<(Cell, Cell)> = (0..20).map(|_| (cell(), cell())).collect();
        let mirrored = |cell: Cell| Cell::new(width - 1 - cell.x, cell.y);
        let turned = |cell: Cell| Cell::new(cell.y, cell.x);
        // Each transformation is undone by applying it again.
        let held: [Held<'_>; 3] =
            [(width, height, &|cell| cell), (width, height, &mirrored), (height, width, &turned)];
        let costs = held.map(|(width, height, hold)| {
            let frame = GridFrame::new(width as u64, height as u64, 1.0, Pose::default()).unwrap();
            let turned = OccupancyGrid::from_fn(frame, |cell| original.state(hold(cell)).unwrap());
            let map = search_map(&turned);
            let prepared = Prepared::build(&map).unwrap();
            let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
            let cost = |&(start, goal): &(Cell, Cell)| {
                let query = Query::new(hold(start), hold(goal));
                let answer = prepared.plan_into(&map, &query, &mut workspace, None, &mut plan);
                answer.ok().map(|()| plan.cost)
            };
            queries.iter().map(cost).collect::<Vec<_>>()
        });
        prop_assert_eq!(&costs[0], &costs[1]);
        prop_assert_eq!(&costs[0], &costs[2]);
    }
}

#[test]
fn maps_without_turns() {
    for rows in [&["."][..], &["......"], &["....", "....", "...."], &["..#", "###", "#.."]] {
        let map = search_map(&OccupancyGrid::from_ascii(rows));
        let prepared = Prepared::build(&map).unwrap();
        assert_eq!(prepared.preparation().corner_cells, 0);
        for start in map.frame().cells().filter(|&cell| map.is_free(cell)) {
            for goal in map.frame().cells() {
                check(&prepared, &map, &Query::new(start, goal), &mut Workspace::default());
            }
        }
    }
    let closed = search_map(&OccupancyGrid::from_ascii(&["##", "##"]));
    assert_eq!(Prepared::build(&closed).unwrap().preparation().label_entries, 0);
}

/// A closed form: along a winding corridor of one cell.
#[test]
fn a_serpentine() {
    let rows = ["......", ".#####", "......", "#####.", "......"];
    let map = search_map(&OccupancyGrid::from_ascii(&rows));
    let prepared = Prepared::build(&map).unwrap();
    let query = Query::new(Cell::new(0, 0), Cell::new(5, 4));
    let mut plan = Plan::default();
    prepared.plan_into(&map, &query, &mut Workspace::default(), None, &mut plan).unwrap();
    assert_eq!((plan.cost.steps(), plan.cells.len()), (Some(Cost::new(3 * 5 + 4, 0)), 20));
}

#[test]
fn only_on_its_own_map() {
    let grid = OccupancyGrid::from_ascii(&["....", ".##.", "...."]);
    let mut map = search_map(&grid);
    let prepared = Prepared::build(&map).unwrap();
    let ask = |map: &SearchMap| {
        let query = Query::new(Cell::new(0, 0), Cell::new(3, 2));
        prepared.plan_into(map, &query, &mut Workspace::default(), None, &mut Plan::default())
    };
    assert_eq!(ask(&map), Ok(()));
    let cell = Cell::new(3, 1);
    map.apply(&[Edit { cell, state: CellState::Occupied }]);
    assert_eq!(ask(&map), Err(PlanError::OtherMap));
    map.apply(&[Edit { cell, state: CellState::Free }]);
    assert_eq!(ask(&map), Ok(()), "the same cells as before");
    let inflated = LayerConfig { clearance_m: 0.6, ..LayerConfig::default() };
    let inflated = SearchMap::new(&OccupancyGrid::from_ascii(&["......."; 5]), inflated).unwrap();
    let query = Query::new(Cell::new(1, 1), Cell::new(5, 3));
    let answer = prepared.plan_into(
        &inflated,
        &query,
        &mut Workspace::default(),
        None,
        &mut Plan::default(),
    );
    assert_eq!(answer, Err(PlanError::OtherMap));
}

#[test]
fn penalised_cells_and_budgets() {
    let grid = OccupancyGrid::from_ascii(&["...?", ".##.", "...."]);
    let config = LayerConfig { unknown: UnknownPolicy::Penalised, ..LayerConfig::default() };
    let penalised = SearchMap::new(&grid, config).unwrap();
    assert_eq!(Prepared::build(&penalised).unwrap_err(), PrepareError::NeedsUniformCost);

    // Two turns, so that labels are needed.
    let map = search_map(&OccupancyGrid::from_ascii(&["......", ".####.", ".#...."]));
    let prepared = Prepared::build(&map).unwrap();
    let query = Query { budget: Some(1), ..Query::new(Cell::new(0, 0), Cell::new(2, 0)) };
    let mut plan = Plan::default();
    let answer = prepared.plan_into(&map, &query, &mut Workspace::default(), None, &mut plan);
    assert!(matches!(answer, Err(PlanError::BudgetExhausted { budget: 1, .. })), "{answer:?}");
    assert!(plan.cells.is_empty());
}

#[test]
fn progress_ends_with_everything() {
    let map = search_map(&grid(30, 30, true, 0.3, 7));
    let (mut last, mut total) = (0, 0);
    Prepared::build_with_progress(&map, |progress| {
        assert!(progress.done > last, "it only increases");
        (last, total) = (progress.done, progress.total);
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(total > 0 && last == total);
}

#[test]
fn whoever_watches_it_may_stop_it() {
    let map = search_map(&grid(30, 30, true, 0.3, 7));
    let stopped_at = |wanted: u64| {
        let mut last = 0;
        let planner = PlannerConfig::by_name(Prepared::NAME).unwrap();
        let stopped = planner.build_with_progress(&map, &mut |progress| {
            last = progress.done;
            if last < wanted { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        (stopped.err(), last)
    };
    let corner_cells = Prepared::build(&map).unwrap().preparation().corner_cells;
    let stopped = || Some(PlanError::Preparation(PrepareError::Stopped));
    assert_eq!(stopped_at(1), (stopped(), 1), "at the first corner cell in order");
    assert_eq!(stopped_at(corner_cells + 5), (stopped(), corner_cells + 5), "at a label");
    assert_eq!(stopped_at(u64::MAX), (None, 2 * corner_cells));
}
