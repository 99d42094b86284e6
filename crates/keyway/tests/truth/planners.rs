//! The planners under test, and their queries.

use crate::support::{Raw, Rules};
use keyway::map::SearchMap;
use keyway::plan::{
    AStarConfig, BidirectionalOptimalConfig, DijkstraConfig, Heuristic, Plan, PlanError,
    PlannerConfig,
};
use keyway::search::{CornerRule, Cost, Query, Workspace};

/// Every planner that promises shortest paths under a corner rule: those registered by name, and
/// further parameter sets that do.
pub(crate) fn optimal(corners: CornerRule) -> Vec<PlannerConfig> {
    let named = PlannerConfig::NAMES.iter().filter_map(|name| PlannerConfig::by_name(name));
    let euclidean = AStarConfig { heuristic: Heuristic::Euclidean, ..AStarConfig::default() };
    let planners = named.filter(PlannerConfig::is_optimal);
    let planners = planners.chain([PlannerConfig::AStar(euclidean)]);
    planners.filter_map(|planner| with_corners(planner, corners)).collect()
}

/// The planner under a corner rule, if it has it.
fn with_corners(planner: PlannerConfig, corners: CornerRule) -> Option<PlannerConfig> {
    match planner {
        PlannerConfig::AStar(config) => {
            Some(PlannerConfig::AStar(AStarConfig { corners, ..config }))
        }
        PlannerConfig::Dijkstra(_) => Some(PlannerConfig::Dijkstra(DijkstraConfig { corners })),
        PlannerConfig::BidirectionalOptimal(_) => {
            Some(PlannerConfig::BidirectionalOptimal(BidirectionalOptimalConfig { corners }))
        }
        other => (corners == CornerRule::Forbid).then_some(other),
    }
}

/// Runs a planner; `None` if it does not support this map.
pub(crate) fn ask(
    planner: &PlannerConfig,
    map: &SearchMap,
    query: &Query,
    workspace: &mut Workspace,
) -> Option<Result<Plan, PlanError>> {
    let mut plan = Plan::default();
    let result = planner
        .build(map)
        .and_then(|planner| planner.plan_into(map, query, workspace, None, &mut plan));
    match result {
        Err(PlanError::NeedsUniformCost { .. }) => None,
        result => Some(result.map(|()| plan)),
    }
}

/// The cost of a planner's path, which is checked step by step; `None` if there is no path.
pub(crate) fn checked_cost(
    planner: &PlannerConfig,
    raw: &Raw,
    rules: &Rules,
    query: &Query,
    answer: Result<Plan, PlanError>,
) -> Option<Cost> {
    match answer {
        Ok(plan) => {
            let walked = raw.walk(&plan.cells, query, rules);
            assert_eq!(walked, plan.cost.steps(), "{planner:?}\n{}", raw.drawing());
            walked
        }
        Err(PlanError::NoPath { .. }) => None,
        Err(PlanError::Blocked { cell, nearest, .. }) => {
            assert!(!raw.is_free(cell.x, cell.y, rules.unknown), "{cell}\n{}", raw.drawing());
            assert!(nearest.is_none_or(|c| raw.is_free(c.x, c.y, rules.unknown)));
            None
        }
        Err(error) => panic!("{planner:?}: {error}\n{}", raw.drawing()),
    }
}
