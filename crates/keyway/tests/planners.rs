//! Every planner against an independent truth: relaxation of all edges until nothing changes, on
//! the raw drawing of the map.
#![allow(clippy::unwrap_used)]

use keyway::geometry::Pose;
use keyway::map::{
    Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap, UnknownPolicy,
};
use keyway::plan::{AStar, AStarConfig, GlobalPlanner, Jps, Plan, PlanError};
use keyway::search::{CornerRule, Cost, Observer, Query, Side, Workspace};
use proptest::prelude::*;

/// A map as a plain array of cells, to be searched by brute force.
#[derive(Clone, Debug)]
struct Raw {
    width: i32,
    height: i32,
    states: Vec<CellState>,
}

impl Raw {
    fn state(&self, cell: Cell) -> Option<CellState> {
        let inside = cell.x >= 0 && cell.y >= 0 && cell.x < self.width && cell.y < self.height;
        inside.then(|| self.states[(cell.y * self.width + cell.x) as usize])
    }

    fn is_free(&self, x: i32, y: i32, unknown: UnknownPolicy) -> bool {
        match self.state(Cell::new(x, y)) {
            None | Some(CellState::Occupied) => false,
            Some(CellState::Unknown) => unknown != UnknownPolicy::Blocked,
            Some(CellState::Free) => true,
        }
    }

    fn grid(&self) -> OccupancyGrid {
        let (width, height) = (self.width as u64, self.height as u64);
        let frame = GridFrame::new(width, height, 1.0, Pose::default()).unwrap();
        OccupancyGrid::from_fn(frame, |cell| self.state(cell).unwrap())
    }

    /// The map as a drawing, top row first, for messages.
    fn drawing(&self) -> String {
        let row = |y: i32| -> String {
            let states = (0..self.width).map(|x| self.states[(y * self.width + x) as usize]);
            states
                .map(|state| match state {
                    CellState::Free => '.',
                    CellState::Occupied => '#',
                    CellState::Unknown => '?',
                })
                .collect()
        };
        (0..self.height).rev().map(row).collect::<Vec<_>>().join("\n")
    }

    /// The cost of one step, if it is allowed.
    fn step(&self, from: Cell, to: Cell, rules: &Rules) -> Option<Cost> {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let free = |x, y| self.is_free(x, y, rules.unknown);
        let beside = free(from.x + dx, from.y) && free(from.x, from.y + dy);
        if (dx, dy) == (0, 0) || dx.abs() > 1 || dy.abs() > 1 || !free(to.x, to.y) {
            return None;
        }
        if dx != 0 && dy != 0 && rules.corners == CornerRule::Forbid && !beside {
            return None;
        }
        let penalised =
            rules.unknown == UnknownPolicy::Penalised && self.state(to) == Some(CellState::Unknown);
        let factor = if penalised { u64::from(rules.penalty) } else { 1 };
        Some(if dx != 0 && dy != 0 { Cost::new(0, factor) } else { Cost::new(factor, 0) })
    }

    fn optimum(&self, query: &Query, rules: &Rules) -> Option<Cost> {
        let cells: Vec<Cell> =
            (0..self.height).flat_map(|y| (0..self.width).map(move |x| Cell::new(x, y))).collect();
        let index = |cell: Cell| (cell.y * self.width + cell.x) as usize;
        if !self.is_free(query.start.x, query.start.y, rules.unknown) {
            return None;
        }
        let mut best: Vec<Option<Cost>> = vec![None; cells.len()];
        best[index(query.start)] = Some(Cost::default());
        let mut changed = true;
        while std::mem::take(&mut changed) {
            for &from in &cells {
                let Some(cost) = best[index(from)] else { continue };
                for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
                    let to = Cell::new(from.x + dx, from.y + dy);
                    let Some(step) = self.step(from, to, rules) else { continue };
                    let through = cost + step;
                    if best[index(to)].is_none_or(|known| through < known) {
                        best[index(to)] = Some(through);
                        changed = true;
                    }
                }
            }
        }
        best[index(query.goal)]
    }
}

#[derive(Clone, Copy, Debug)]
struct Rules {
    corners: CornerRule,
    unknown: UnknownPolicy,
    penalty: u32,
}

impl Rules {
    fn layers(&self) -> LayerConfig {
        LayerConfig {
            unknown: self.unknown,
            unknown_penalty: self.penalty,
            ..LayerConfig::default()
        }
    }
}

fn any_raw() -> impl Strategy<Value = Raw> {
    (1i32..14, 1i32..11, 1u32..6).prop_flat_map(|(width, height, density)| {
        let state = prop_oneof![
            8 => Just(CellState::Free),
            density => Just(CellState::Occupied),
            1 => Just(CellState::Unknown)
        ];
        prop::collection::vec(state, (width * height) as usize).prop_map(move |states| Raw {
            width,
            height,
            states,
        })
    })
}

fn any_rules() -> impl Strategy<Value = Rules> {
    let corners = prop_oneof![Just(CornerRule::Forbid), Just(CornerRule::Allow)];
    let unknown = prop_oneof![
        Just(UnknownPolicy::Blocked),
        Just(UnknownPolicy::Free),
        Just(UnknownPolicy::Penalised)
    ];
    (corners, unknown, 1u32..5).prop_map(|(corners, unknown, penalty)| Rules {
        corners,
        unknown,
        penalty,
    })
}

/// Counts what the search says it did.
#[derive(Default)]
struct Counter {
    expanded: u64,
    generated: u64,
}

impl Observer for Counter {
    fn expanded(&mut self, _: Side, _: Cell, _: f64) {
        self.expanded += 1;
    }
    fn generated(&mut self, _: Side, _: Cell, _: f64) {
        self.generated += 1;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, ..ProptestConfig::default() })]

    #[test]
    fn astar_finds_the_optimum(raw in any_raw(), rules in any_rules(),
                               ends in (0i32..14, 0i32..11, 0i32..14, 0i32..11)) {
        let start = Cell::new(ends.0 % raw.width, ends.1 % raw.height);
        let goal = Cell::new(ends.2 % raw.width, ends.3 % raw.height);
        let query = Query::new(start, goal);
        let map = SearchMap::new(&raw.grid(), rules.layers()).unwrap();
        let planner = AStar::new(AStarConfig { corners: rules.corners, ..AStarConfig::default() });
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        let mut counter = Counter::default();
        let result = planner.plan_into(&map, &query, &mut workspace, Some(&mut counter), &mut plan);
        let optimum = raw.optimum(&query, &rules);
        match result {
            Ok(()) => {
                prop_assert_eq!(Some(plan.cost), optimum);
                prop_assert_eq!((plan.cells[0], *plan.cells.last().unwrap()), (start, goal));
                let mut walked = Cost::default();
                for pair in plan.cells.windows(2) {
                    let step = raw.step(pair[0], pair[1], &rules);
                    prop_assert!(step.is_some(), "illegal step {} to {}", pair[0], pair[1]);
                    walked = walked + step.unwrap();
                }
                prop_assert_eq!(walked, plan.cost);
                prop_assert_eq!(plan.statistics.expanded, counter.expanded);
                prop_assert_eq!(plan.statistics.generated, counter.generated + 1);
            }
            Err(PlanError::NoPath { statistics }) => {
                prop_assert_eq!(optimum, None);
                prop_assert_eq!(statistics.expanded, counter.expanded);
            }
            Err(PlanError::Blocked { cell, nearest, .. }) => {
                prop_assert!(!raw.is_free(cell.x, cell.y, rules.unknown));
                prop_assert!(nearest.is_none_or(|c| raw.is_free(c.x, c.y, rules.unknown)));
            }
            Err(other) => prop_assert!(false, "{}", other),
        }
        // A second query on the same workspace gives the same, without an observer.
        let mut again = Plan::default();
        let second = planner.plan_into(&map, &query, &mut workspace, None, &mut again);
        prop_assert_eq!(second.is_ok(), optimum.is_some());
        prop_assert_eq!(again, plan);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn jps_finds_the_optimum(raw in any_raw(), free_unknown: bool,
                             ends in (0i32..14, 0i32..11, 0i32..14, 0i32..11)) {
        let unknown = if free_unknown { UnknownPolicy::Free } else { UnknownPolicy::Blocked };
        let rules = Rules { corners: CornerRule::Forbid, unknown, penalty: 1 };
        let start = Cell::new(ends.0 % raw.width, ends.1 % raw.height);
        let goal = Cell::new(ends.2 % raw.width, ends.3 % raw.height);
        let query = Query::new(start, goal);
        let map = SearchMap::new(&raw.grid(), rules.layers()).unwrap();
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        for _ in 0..2 {
            match Jps.plan_into(&map, &query, &mut workspace, None, &mut plan) {
                Ok(()) => {
                    prop_assert_eq!(Some(plan.cost), raw.optimum(&query, &rules), "{}", raw.drawing());
                    prop_assert_eq!((plan.cells[0], *plan.cells.last().unwrap()), (start, goal));
                    let steps = plan.cells.windows(2).map(|pair| raw.step(pair[0], pair[1], &rules));
                    let walked = steps.collect::<Option<Vec<Cost>>>().map(|steps| {
                        steps.into_iter().fold(Cost::default(), |sum, step| sum + step)
                    });
                    prop_assert_eq!(walked, Some(plan.cost), "illegal step\n{}", raw.drawing());
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

#[test]
fn jps_refuses_penalised_cells() {
    let grid = OccupancyGrid::from_ascii(&[".?."]);
    let config = LayerConfig { unknown: UnknownPolicy::Penalised, ..LayerConfig::default() };
    let map = SearchMap::new(&grid, config).unwrap();
    let query = Query::new(Cell::new(0, 0), Cell::new(2, 0));
    let error = Jps
        .plan_into(&map, &query, &mut Workspace::default(), None, &mut Plan::default())
        .unwrap_err();
    assert_eq!(error, PlanError::NeedsUniformCost { planner: "jps" });
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
        "goal (2, 0) is inside an obstacle; nearest free cell is (1, 0)"
    );
    assert_eq!(ask(Cell::new(-1, 0), free), "start (-1, 0) is outside the map of 3 x 1 cells");
}
