//! Every named planner, under both corner rules: legal paths, no shorter than the optimum, and a
//! path wherever one exists, unless the planner's method is documented to miss it.

use crate::any_angle::{self, length, sees};
use crate::planners::ask;
use crate::support::{Raw, Rules, any_raw, any_rules, query_on};
use keyway::map::formats::read_map;
use keyway::map::{Cell, CellState, LayerConfig, UnknownPolicy};
use keyway::plan::{Plan, PlanError, PlannerConfig};
use keyway::search::{CornerRule, Query, Workspace};
use proptest::prelude::*;
use std::path::Path;

/// All planners under a corner rule. Those without a choice forbid it.
fn all(corners: CornerRule) -> impl Iterator<Item = (PlannerConfig, CornerRule)> {
    PlannerConfig::NAMES.iter().map(move |name| {
        let config = PlannerConfig::by_name(name).unwrap();
        let mut json = serde_json::to_value(&config).unwrap();
        if json.get("corners").is_none() {
            return (config, CornerRule::Forbid);
        }
        json["corners"] = serde_json::to_value(corners).unwrap();
        (serde_json::from_value(json).unwrap(), corners)
    })
}

/// True if a planner's method may miss a path.
fn may_miss(planner: &PlannerConfig) -> bool {
    ["hsta", "rrt"].contains(&planner.name())
}

/// The length of a path that is legal.
fn walked(raw: &Raw, rules: &Rules, query: &Query, path: &[Cell]) -> Option<f64> {
    let has_right_ends = path.first() == Some(&query.start) && path.last() == Some(&query.goal);
    let is_legal = |leg: &[Cell]| leg[0] != leg[1] && sees(raw, rules, leg[0], leg[1]);
    let sum = || path.windows(2).map(|leg| length(leg[0], leg[1])).sum();
    (has_right_ends && path.windows(2).all(is_legal)).then(sum)
}

/// Checks an answer; the least length is that of the shortest path of the planner's kind.
fn check(
    planner: &PlannerConfig,
    raw: &Raw,
    rules: &Rules,
    query: &Query,
    answer: &Result<Plan, PlanError>,
) {
    let context = || format!("{planner:?} {rules:?} {query:?}\n{}", raw.drawing());
    let optimum = raw.optimum(query, rules);
    match answer {
        Ok(plan) => {
            let optimum = optimum.unwrap_or_else(|| panic!("no path exists: {}", context()));
            let length = walked(raw, rules, query, &plan.cells)
                .unwrap_or_else(|| panic!("illegal: {:?} {}", plan.cells, context()));
            assert!(plan.stop.is_some(), "{}", context());
            if let Some(steps) = plan.cost.steps() {
                assert!(steps >= optimum, "{}", context());
                assert_eq!(raw.walk(&plan.cells, query, rules), Some(steps), "{}", context());
            } else {
                assert!((plan.cost.cells() - length).abs() < 1e-6, "{}", context());
                let least = any_angle::optimum(raw, rules, query).unwrap();
                assert!(length > least - 1e-6, "{length} < {least}: {}", context());
            }
        }
        Err(PlanError::NoPath { .. }) => assert_eq!(optimum, None, "{}", context()),
        Err(PlanError::Blocked { cell, .. }) => {
            assert!(!raw.is_free(cell.x, cell.y, rules.unknown), "{}", context());
        }
        Err(PlanError::Missed { .. } | PlanError::Constrained { .. }) => {
            assert!(may_miss(planner) && optimum.is_some(), "{}", context());
        }
        Err(error) => panic!("{error}: {}", context()),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn paths_are_legal_and_no_shorter_than_the_best(
        raw in any_raw(), rules in any_rules(), ends: (u32, u32, u32, u32),
    ) {
        let query = query_on(&raw, ends);
        let (map, mut workspace) = (raw.search_map(&rules), Workspace::default());
        for (planner, corners) in all(rules.corners) {
            let rules = Rules { corners, diagonals: planner.name() != "astar4", ..rules };
            let Some(answer) = ask(&planner, &map, &query, &mut workspace) else {
                // Only if cells differ in cost.
                prop_assert_eq!(rules.unknown, UnknownPolicy::Penalised, "{:?}", planner);
                continue;
            };
            check(&planner, &raw, &rules, &query, &answer);
            // The same query again, on memory that another query has used.
            let back = Query::new(query.goal, query.start);
            _ = ask(&planner, &map, &back, &mut workspace);
            prop_assert_eq!(ask(&planner, &map, &query, &mut workspace), Some(answer));
        }
    }
}

/// A map as the planners of a robot see it.
fn real_map(file: &str) -> Raw {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../keyway-cli/scenes").join(file);
    let grid = read_map(&path, None).unwrap().grid;
    let (width, height) = (grid.frame().width() as i32, grid.frame().height() as i32);
    let states = grid.frame().cells().map(|cell| grid.state(cell).unwrap()).collect();
    Raw { width, height, states }
}

#[test]
fn real_maps() {
    for (file, unknown) in
        [("rooms.map", UnknownPolicy::Blocked), ("small_house.yaml", UnknownPolicy::Free)]
    {
        let raw = real_map(file);
        let rules = Rules { unknown, ..Rules::default() };
        let free: Vec<Cell> =
            raw.cells().filter(|&cell| raw.state(cell) == Some(CellState::Free)).collect();
        let map = keyway::map::SearchMap::new(
            &raw.grid(),
            LayerConfig { unknown, ..LayerConfig::default() },
        )
        .unwrap();
        let mut workspace = Workspace::default();
        let queries: Vec<Query> = (1..=8)
            .map(|i| Query::new(free[i * 7919 % free.len()], free[i * 104_729 % free.len()]))
            .collect();
        for (planner, corners) in [CornerRule::Forbid, CornerRule::Allow].into_iter().flat_map(all)
        {
            let rules = Rules { corners, diagonals: planner.name() != "astar4", ..rules };
            let built = planner.build(&map).unwrap();
            let exact = PlannerConfig::by_name("astar").unwrap();
            for query in &queries {
                let context = || format!("{planner:?} {query:?} on {file}");
                let mut plan = Plan::default();
                let result = built.plan_into(&map, query, &mut workspace, None, &mut plan);
                if let Err(error) = result {
                    let is_miss =
                        matches!(error, PlanError::Missed { .. } | PlanError::Constrained { .. });
                    let no_path = matches!(error, PlanError::NoPath { .. });
                    assert!(no_path || is_miss && may_miss(&planner), "{error}: {}", context());
                    continue;
                }
                let walked = walked(&raw, &rules, query, &plan.cells);
                let walked = walked.unwrap_or_else(|| panic!("illegal: {}", context()));
                assert!((plan.cost.cells() - walked).abs() < 1e-6, "{}", context());
                let optimum = ask(&exact, &map, query, &mut workspace).unwrap().unwrap();
                if rules.corners == CornerRule::Forbid && plan.cost.steps().is_some() {
                    assert!(plan.cost >= optimum.cost, "{}", context());
                }
                assert!(walked > length(query.start, query.goal) - 1e-6, "{}", context());
            }
        }
    }
}
