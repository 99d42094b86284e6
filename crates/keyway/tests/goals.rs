//! Goals that cannot be reached, and several goals, for every planner, against brute force:
//! relaxation of all steps on a plain array until nothing changes.
#![allow(clippy::unwrap_used)]

use keyway::geometry::Pose;
use keyway::map::{
    Cell, CellState, Connectivity, GridFrame, LayerConfig, OccupancyGrid, SearchMap,
};
use keyway::plan::{
    GlobalPlanner, GoalPlan, HstaConfig, Jps, NearestFirst, Plan, PlanError, PlannerConfig,
};
use keyway::search::{Cost, IfUnreachable, Observer, Query, SearchStatistics, Workspace};
use proptest::prelude::*;
use std::cell::RefCell;

/// Free cells of a map as a plain array.
#[derive(Clone, Debug)]
struct Raw {
    width: i32,
    height: i32,
    free: Vec<bool>,
}

impl Raw {
    fn is_free(&self, x: i32, y: i32) -> bool {
        let inside = x >= 0 && y >= 0 && x < self.width && y < self.height;
        inside && self.free[(y * self.width + x) as usize]
    }

    fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let width = self.width;
        (0..self.width * self.height).map(move |i| Cell::new(i % width, i / width))
    }

    fn map(&self) -> SearchMap {
        let (width, height) = (self.width as u64, self.height as u64);
        let frame = GridFrame::new(width, height, 1.0, Pose::default()).unwrap();
        let state =
            |c: Cell| if self.is_free(c.x, c.y) { CellState::Free } else { CellState::Occupied };
        SearchMap::new(&OccupancyGrid::from_fn(frame, state), LayerConfig::default()).unwrap()
    }

    /// Costs of the shortest paths to all cells, row by row. Corners are cut only if paths have
    /// the connectivity of such steps.
    fn costs(&self, start: Cell, connectivity: Connectivity) -> Vec<Option<Cost>> {
        let index = |c: Cell| (c.y * self.width + c.x) as usize;
        let mut best = vec![None; self.free.len()];
        if !self.is_free(start.x, start.y) {
            return best;
        }
        best[index(start)] = Some(Cost::default());
        let mut changed = true;
        while std::mem::take(&mut changed) {
            for from in self.cells() {
                let Some(cost) = best[index(from)] else { continue };
                for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
                    let to = Cell::new(from.x + dx, from.y + dy);
                    let beside = [(to.x, from.y), (from.x, to.y)];
                    let may_pass = connectivity == Connectivity::Eight
                        || beside.iter().all(|&(x, y)| self.is_free(x, y));
                    if !may_pass || !self.is_free(to.x, to.y) {
                        continue;
                    }
                    let through = cost + Cost::octile(dx.unsigned_abs(), dy.unsigned_abs());
                    if best[index(to)].is_none_or(|known| through < known) {
                        best[index(to)] = Some(through);
                        changed = true;
                    }
                }
            }
        }
        best
    }
}

fn any_raw() -> impl Strategy<Value = Raw> {
    (1i32..16, 1i32..12, 0.05..0.6f64).prop_flat_map(|(width, height, blocked)| {
        let free =
            prop::collection::vec(prop::bool::weighted(1.0 - blocked), (width * height) as usize);
        free.prop_map(move |free| Raw { width, height, free })
    })
}

/// All planners; without a distance to obstacles, which could hide an existing path.
fn planners() -> impl Iterator<Item = PlannerConfig> {
    PlannerConfig::NAMES.into_iter().map(|name| match PlannerConfig::by_name(name).unwrap() {
        PlannerConfig::Hsta(config) => {
            PlannerConfig::Hsta(HstaConfig { l1_constraint: 0.0, ..config })
        }
        config => config,
    })
}

/// Records the goals that were planned to.
#[derive(Debug)]
struct Recorded {
    planner: Box<dyn GlobalPlanner + Send + Sync>,
    goals: RefCell<Vec<Cell>>,
}

impl GlobalPlanner for Recorded {
    fn name(&self) -> &'static str {
        self.planner.name()
    }

    fn connectivity(&self) -> Connectivity {
        self.planner.connectivity()
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        self.goals.borrow_mut().push(query.goal);
        self.planner.search_into(map, query, workspace, seen, plan)
    }
}

fn octile(a: Cell, b: Cell) -> Cost {
    Cost::octile(a.x.abs_diff(b.x), a.y.abs_diff(b.y))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    #[test]
    fn the_nearest_reachable_cell(raw in any_raw(), ends in (0i32..16, 0i32..12, 0i32..16, 0i32..12)) {
        let start = Cell::new(ends.0 % raw.width, ends.1 % raw.height);
        let goal = Cell::new(ends.2 % raw.width, ends.3 % raw.height);
        let distance_sq = |c: Cell| (c.x - goal.x).pow(2) + (c.y - goal.y).pow(2);
        let asked = Query::new(start, goal);
        let query = Query { if_unreachable: IfUnreachable::NearestReachable, ..asked };
        let (map, mut workspace, mut plan) = (raw.map(), Workspace::default(), Plan::default());
        for config in planners() {
            let planner = config.build(&map).unwrap();
            let costs = raw.costs(start, planner.connectivity());
            let reachable = raw.cells().zip(&costs).filter_map(|(cell, cost)| Some((cell, (*cost)?)));
            let expected = reachable.min_by_key(|&(c, _)| (distance_sq(c), c.y, c.x));
            let result = planner.plan_into(&map, &query, &mut workspace, None, &mut plan);
            prop_assert_eq!(plan.reached(), expected.map(|(cell, _)| cell), "{}", config.name());
            match expected {
                Some((_, cost)) => {
                    prop_assert_eq!(result, Ok(()));
                    prop_assert_eq!(plan.cells[0], start);
                    prop_assert!(!config.is_optimal() || plan.cost.steps() == Some(cost), "{}", config.name());
                }
                None => prop_assert!(matches!(result, Err(PlanError::Blocked { .. })), "{:?}", result),
            }
            // The goal is replaced only on request.
            let strict = planner.plan_into(&map, &asked, &mut workspace, None, &mut plan);
            let is_reachable = costs[(goal.y * raw.width + goal.x) as usize].is_some();
            prop_assert_eq!(strict.is_ok(), is_reachable, "{}", config.name());
            if let Err(PlanError::NoPath { statistics }) = strict {
                prop_assert_eq!(statistics, SearchStatistics::default(), "{}", config.name());
            }
        }
    }

    #[test]
    fn several_goals_come_nearest_first(raw in any_raw(), start in (0i32..16, 0i32..12),
                                        goals in prop::collection::vec((-1i32..17, -1i32..13), 0..7)) {
        let start = Cell::new(start.0 % raw.width, start.1 % raw.height);
        let goals: Vec<Cell> = goals.into_iter().map(|(x, y)| Cell::new(x, y)).collect();
        let costs = raw.costs(start, Connectivity::Four);
        let cost = |goal: Cell| {
            let inside = goal.x >= 0 && goal.y >= 0 && goal.x < raw.width && goal.y < raw.height;
            inside.then(|| costs[(goal.y * raw.width + goal.x) as usize]).flatten()
        };
        let mut order: Vec<usize> = (0..goals.len()).collect();
        order.sort_by_key(|&i| (cost(goals[i]).is_none(), cost(goals[i]), i));
        let (map, mut workspace) = (raw.map(), Workspace::default());
        for config in planners().filter(PlannerConfig::is_optimal) {
            let planner = Recorded { planner: config.build(&map).unwrap(), goals: RefCell::default() };
            let query = Query::new(start, start);
            let mut found = NearestFirst::new(&planner, &map, &query, &goals, &mut workspace);
            for &expected in &order {
                let GoalPlan { index, goal, result, .. } = found.next().unwrap();
                prop_assert_eq!((index, goal), (expected, goals[expected]), "{}", config.name());
                prop_assert_eq!(result.ok().and_then(|plan| plan.cost.steps()), cost(goal));
                // Only this goal, and the reachable goals that might have come before it, were
                // searched for.
                let Some(reached) = cost(goal) else { continue };
                let may_be_nearer = |&i: &usize| {
                    cost(goals[i]).is_some() && (octile(start, goals[i]), i) <= (reached, index)
                };
                let mut needed: Vec<Cell> = (0..goals.len()).filter(may_be_nearer).map(|i| goals[i]).collect();
                let mut searched = planner.goals.borrow().clone();
                needed.sort_unstable();
                searched.sort_unstable();
                prop_assert_eq!(searched, needed);
            }
            prop_assert_eq!(found.next(), None);
        }
    }
}

#[test]
fn a_goal_outside_the_map_is_not_replaced() {
    let raw = Raw { width: 2, height: 1, free: vec![true; 2] };
    let query = Query {
        if_unreachable: IfUnreachable::NearestReachable,
        ..Query::new(Cell::new(0, 0), Cell::new(5, 0))
    };
    let result =
        Jps.plan_into(&raw.map(), &query, &mut Workspace::default(), None, &mut Plan::default());
    assert!(matches!(result, Err(PlanError::OutsideMap { .. })), "{result:?}");
}

#[test]
fn a_budget_holds_for_each_goal() {
    let raw = Raw { width: 30, height: 1, free: vec![true; 30] };
    let (map, mut workspace) = (raw.map(), Workspace::default());
    let goals = [Cell::new(29, 0), Cell::new(3, 0)];
    let query = Query { budget: Some(10), ..Query::new(Cell::new(0, 0), Cell::new(0, 0)) };
    let planner = PlannerConfig::by_name("astar").unwrap().build(&map).unwrap();
    let found: Vec<GoalPlan> =
        NearestFirst::new(&*planner, &map, &query, &goals, &mut workspace).collect();
    assert_eq!(found.iter().map(|goal| goal.index).collect::<Vec<_>>(), [1, 0]);
    assert!(matches!(found[1].result, Err(PlanError::BudgetExhausted { budget: 10, .. })));
}
