//! Planners whose two sides take turns, against brute force on small maps: steps in 16 directions,
//! and distances kept from obstacles.
#![allow(clippy::unwrap_used)]

mod support;

use keyway::geometry::Pose;
use keyway::map::{
    Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, PublishedConstraints, SearchMap,
    UnknownPolicy,
};
use keyway::plan::{
    Bidirectional24, Bidirectional24Config, GlobalPlanner, Heuristic, Hsta, HstaConfig, IfNoPath,
    Miss, OpenKeys, Plan, PlanError, PlannerConfig, WeightAt,
};
use keyway::search::{CornerRule, Query, Workspace};
use proptest::prelude::*;
use std::f64::consts::FRAC_1_SQRT_2;
use support::{Raw, Rules, any_raw, any_rules, query_on};

/// The length of a step in the 5 x 5 neighbourhood, if every cell on its line is free: tested at
/// 64 points of it, none of which lies between two cells. Diagonals are walked cell by cell.
fn long_step(raw: &Raw, from: Cell, to: Cell, rules: &Rules) -> Option<f64> {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    if (dx, dy) == (0, 0) || dx.abs().max(dy.abs()) > 2 {
        return None;
    }
    let is_walked = if dx.abs() == dy.abs() {
        let unit = |cell: Cell| Cell::new(cell.x + dx.signum(), cell.y + dy.signum());
        let first = unit(from);
        raw.step(from, first, rules).is_some()
            && (first == to || raw.step(first, to, rules).is_some())
    } else {
        (0..64).all(|i| {
            let t = (f64::from(i) + 0.4) / 64.0;
            let at = |from: i32, d: i32| (f64::from(from) + t * f64::from(d)).round() as i32;
            raw.is_free(at(from.x, dx), at(from.y, dy), rules.unknown)
        }) && raw.is_free(to.x, to.y, rules.unknown)
    };
    is_walked.then(|| f64::from(dx * dx + dy * dy).sqrt())
}

/// The length of the shortest path in such steps, by relaxing all of them until nothing changes.
fn shortest_24(raw: &Raw, query: &Query, rules: &Rules) -> f64 {
    let mut best = vec![f64::INFINITY; raw.states.len()];
    best[raw.index(query.start)] = 0.0;
    let mut changed = true;
    while std::mem::take(&mut changed) {
        for from in raw.cells() {
            for (dx, dy) in (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy))) {
                let to = Cell::new(from.x + dx, from.y + dy);
                let Some(length) = long_step(raw, from, to, rules) else { continue };
                let through = best[raw.index(from)] + length;
                if through < best[raw.index(to)] - 1e-9 {
                    best[raw.index(to)] = through;
                    changed = true;
                }
            }
        }
    }
    best[raw.index(query.goal)]
}

/// The L1 distance to the nearest obstacle, by testing all of them.
fn distance(raw: &Raw, rules: &Rules, cell: Cell) -> u32 {
    let is_obstacle = |other: &Cell| match raw.state(*other) {
        Some(CellState::Occupied) => true,
        Some(CellState::Unknown) => rules.unknown == UnknownPolicy::Blocked,
        _ => false,
    };
    let obstacles = raw.cells().filter(is_obstacle);
    obstacles.map(|o| o.x.abs_diff(cell.x) + o.y.abs_diff(cell.y)).min().unwrap_or(u32::MAX)
}

/// True if steps over allowed cells lead from the start to the goal.
fn is_connected(raw: &Raw, query: &Query, rules: &Rules, allows: impl Fn(Cell) -> bool) -> bool {
    let mut reached = vec![false; raw.states.len()];
    let mut waiting = vec![query.start];
    while let Some(from) = waiting.pop() {
        if allows(from) && !std::mem::replace(&mut reached[raw.index(from)], true) {
            waiting.extend(raw.steps(from, rules).into_iter().map(|(to, _)| to));
        }
    }
    reached[raw.index(query.goal)]
}

fn plan(planner: &impl GlobalPlanner, map: &SearchMap, query: &Query) -> Result<Plan, PlanError> {
    let mut plan = Plan::default();
    let mut workspace = Workspace::default();
    planner.plan_into(map, query, &mut workspace, None, &mut plan).map(|()| plan)
}

fn any_reading() -> impl Strategy<Value = (WeightAt, OpenKeys)> {
    let weight_at = prop_oneof![Just(WeightAt::Node), Just(WeightAt::Current)];
    (weight_at, prop_oneof![Just(OpenKeys::Kept), Just(OpenKeys::Renewed)])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn paths_of_24_neighbours(raw in any_raw(), rules in any_rules(), ends: (u32, u32, u32, u32)) {
        let unknown = match rules.unknown {
            UnknownPolicy::Penalised => UnknownPolicy::Free,
            unknown => unknown,
        };
        let rules = Rules { unknown, ..rules };
        let (query, map) = (query_on(&raw, ends), raw.search_map(&rules));
        let free = |cell: Cell| raw.is_free(cell.x, cell.y, rules.unknown);
        if !free(query.start) || !free(query.goal) {
            return Ok(());
        }
        let shortest = shortest_24(&raw, &query, &rules);
        for heuristic in [Heuristic::Octile, Heuristic::Euclidean, Heuristic::Manhattan, Heuristic::Mean] {
            let config = Bidirectional24Config { corners: rules.corners, heuristic };
            match plan(&Bidirectional24::new(config), &map, &query) {
                Ok(plan) => {
                    let ends = (plan.cells[0], plan.reached().unwrap());
                    prop_assert_eq!(ends, (query.start, query.goal));
                    let steps = plan.cells.windows(2).map(|pair| long_step(&raw, pair[0], pair[1], &rules));
                    let walked = steps.sum::<Option<f64>>();
                    prop_assert!(walked.is_some(), "{:?}\n{}", plan.cells, raw.drawing());
                    prop_assert!((plan.cost.cells() - walked.unwrap()).abs() < 1e-9);
                    prop_assert!(plan.cost.cells() > shortest - 1e-6, "{}", raw.drawing());
                    prop_assert!(plan.cells.contains(&plan.meeting.unwrap()));
                }
                Err(PlanError::NoPath { .. }) => prop_assert!(shortest.is_infinite(), "{}", raw.drawing()),
                Err(error) => prop_assert!(false, "{}\n{}", error, raw.drawing()),
            }
        }
    }

    #[test]
    fn every_node_keeps_the_constraint(raw in any_raw(), rules in any_rules(), ends: (u32, u32, u32, u32),
                                       constraint in 0u32..6, free_ends in 0i32..4,
                                       (weight_at, keys) in any_reading()) {
        let (query, map) = (query_on(&raw, ends), raw.search_map(&rules));
        if !is_connected(&raw, &query, &rules, |cell| raw.is_free(cell.x, cell.y, rules.unknown)) {
            return Ok(());
        }
        let is_exempt = |cell: Cell| free_ends > 0 && [query.start, query.goal].iter().any(|end| {
            (end.x - cell.x).pow(2) + (end.y - cell.y).pow(2) <= free_ends * free_ends
        });
        let allows = |cell: Cell, l: u32| is_exempt(cell) || distance(&raw, &rules, cell) >= l;
        let has_path = |l: u32| is_connected(&raw, &query, &rules, |cell| allows(cell, l));
        let config = HstaConfig {
            l1_constraint: f64::from(constraint),
            free_ends_m: f64::from(free_ends),
            corners: rules.corners,
            weight_at,
            keys,
            ..HstaConfig::PAPER
        };
        let check = |plan: &Plan, l: u32| {
            assert!(plan.cells.iter().all(|&cell| allows(cell, l)), "{l}\n{}", raw.drawing());
            assert_eq!(raw.walk(&plan.cells, &query, &rules), plan.cost.steps());
            assert!(plan.cost.steps() >= raw.optimum(&query, &rules));
            let mut cells = plan.cells.clone();
            cells.sort_unstable();
            cells.dedup();
            assert_eq!(cells.len(), plan.cells.len(), "no cell is visited twice");
        };
        let stays = query.start == query.goal;
        match plan(&Hsta::new(config.clone()).unwrap(), &map, &query) {
            Ok(_) if stays => {}
            Ok(plan) => check(&plan, constraint),
            Err(PlanError::Constrained { cell, distance: reported, .. }) => {
                prop_assert!(!allows(cell, constraint));
                prop_assert_eq!(reported, f64::from(distance(&raw, &rules, cell)));
            }
            Err(PlanError::Missed { miss, .. }) => {
                prop_assert_eq!(miss, Miss::Constraint { constraint: f64::from(constraint) });
                prop_assert!(!has_path(constraint), "{}", raw.drawing());
            }
            Err(error) => prop_assert!(false, "{}", error),
        }
        // Relaxed, there is always a path, with the largest constraint that has one.
        let relaxing = Hsta::new(HstaConfig { if_no_path: IfNoPath::Relax, ..config }).unwrap();
        let plan = plan(&relaxing, &map, &query).unwrap();
        if !stays {
            let largest = (0..=constraint).rev().find(|&l| has_path(l)).unwrap();
            check(&plan, largest);
            let kept = relaxing.distance_kept(&map, &plan.cells);
            if largest < constraint && largest > 1 {
                prop_assert_eq!(kept, Some(f64::from(largest)), "{}", raw.drawing());
            }
        }
    }
}

/// The same map with 4 x 4 cells for each: L = 2 of the larger cells is 8 of the smaller ones.
#[test]
fn the_constraint_keeps_more_on_a_finer_grid() {
    // One obstacle cell in the middle of 9 x 9 m, and L = 2 between the centres of cells.
    let nearest = |cell_m: f64| {
        let side = (9.0 / cell_m).round() as i32;
        let frame = GridFrame::new(side as u64, side as u64, cell_m, Pose::default()).unwrap();
        let middle = Cell::new(side / 2, side / 2);
        let state = |cell| if cell == middle { CellState::Occupied } else { CellState::Free };
        let grid = OccupancyGrid::from_fn(frame, state);
        let with = |l1_constraint| LayerConfig {
            published: PublishedConstraints { l1_constraint, ..PublishedConstraints::NONE },
            ..LayerConfig::default()
        };
        let plain = SearchMap::new(&grid, with(0.0)).unwrap();
        let constrained = SearchMap::new(&grid, with(2.0)).unwrap();
        let hsta = PlannerConfig::Hsta(HstaConfig::PAPER).build(&plain).unwrap();
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        // The first cell straight ahead and the first one diagonally, and the nearest of all [m].
        let clearance_m =
            |cell| plain.clearance().of_point(plain.frame().world_from_cell(cell), f64::INFINITY);
        let first = [(1, 0), (1, 1)].map(|(dx, dy)| {
            let cells = (1..side / 2).map(|i| Cell::new(middle.x + i * dx, middle.y + i * dy));
            let allowed = cells.into_iter().find(|&cell| constrained.is_free(cell)).unwrap();
            let mut is_allowed = |cell| {
                let query = Query::new(cell, Cell::new(side - 1, side - 1));
                hsta.plan_into(&plain, &query, &mut workspace, None, &mut plan).is_ok()
            };
            let before = Cell::new(allowed.x - dx, allowed.y - dy);
            assert_eq!((is_allowed(before), is_allowed(allowed)), (false, true), "{allowed}");
            clearance_m(allowed)
        });
        let free = frame.cells().filter(|&cell| constrained.is_free(cell));
        [first[0], first[1], free.map(clearance_m).fold(f64::INFINITY, f64::min)]
    };
    // Straight ahead L less half a cell, past a corner (L less a cell) / sqrt(2), which is the
    // least.
    for (cell_m, straight_m, corner_m) in
        [(1.0, 1.5, FRAC_1_SQRT_2), (0.2, 1.9, 1.2728), (0.05, 1.975, 1.3789)]
    {
        let kept = nearest(cell_m);
        for (kept_m, expected_m) in kept.into_iter().zip([straight_m, corner_m, corner_m]) {
            assert!((kept_m - expected_m).abs() < 5e-4, "cells of {cell_m} m: {kept:?}");
        }
    }
}

#[test]
fn a_finer_grid_keeps_the_same_distance_between_centres() {
    let is_free = |x: i32, y: i32| !(x == 5 && y >= 5);
    let coarse = Raw::from_fn(11, 9, is_free);
    let (from, to) = (Cell::new(1, 7), Cell::new(9, 7));
    let hsta = Hsta::default();
    let kept = |map: &SearchMap, query: &Query| {
        let path = plan(&hsta, map, query).unwrap().cells;
        hsta.distance_kept(map, &path).unwrap()
    };
    let map = coarse.search_map(&Rules::default());
    assert!(kept(&map, &Query::new(from, to)) >= 2.0);
    let frame = GridFrame::new(44, 36, 0.25, Pose::default()).unwrap();
    let state = |cell: Cell| coarse.state(Cell::new(cell.x / 4, cell.y / 4)).unwrap();
    let grid = OccupancyGrid::from_fn(frame, state);
    let fine = SearchMap::new(&grid, Rules::default().layers()).unwrap();
    let times_4 = |cell: Cell| Cell::new(cell.x * 4 + 2, cell.y * 4 + 2);
    let finer = kept(&fine, &Query::new(times_4(from), times_4(to)));
    assert!((2.0..3.0).contains(&finer), "{finer}");
}

#[test]
fn corners_are_cut_only_without_a_constraint() {
    let raw = Raw::from_fn(2, 2, |x, y| x != y);
    let rules = Rules { corners: CornerRule::Allow, ..Rules::default() };
    let query = Query::new(Cell::new(0, 1), Cell::new(1, 0));
    let ask = |l1_constraint| {
        let config = HstaConfig { l1_constraint, corners: rules.corners, ..HstaConfig::PAPER };
        plan(&Hsta::new(config).unwrap(), &raw.search_map(&rules), &query)
    };
    assert_eq!(ask(1.0).unwrap().cells, [query.start, query.goal]);
    assert!(matches!(ask(2.0), Err(PlanError::Constrained { .. })));
}
