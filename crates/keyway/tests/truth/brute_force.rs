//! Every planner against relaxing all edges.

use crate::planners::{ask, checked_cost, optimal};
use crate::support::{Raw, Rules, any_raw, any_rules, query_on};
use keyway::map::{Cell, CellState, UnknownPolicy};
use keyway::plan::{
    AStar4Config, AStarConfig, BidirectionalAStarConfig, Closed, Correction, Density,
    DensityAStarConfig, EstimateWeight, GreedyConfig, Heuristic, HstaConfig, PathCost, Plan,
    PlannerConfig, RatioAStarConfig, SearchEnd, Weight,
};
use keyway::search::{CornerRule, Observer, Query, Side, Workspace};
use proptest::prelude::*;

const HEURISTICS: [Heuristic; 4] =
    [Heuristic::Octile, Heuristic::Euclidean, Heuristic::Manhattan, Heuristic::Mean];

/// Planners whose paths need not be shortest ones.
fn inexact(corners: CornerRule) -> Vec<PlannerConfig> {
    let greedy = |heuristic| PlannerConfig::Greedy(GreedyConfig { corners, heuristic });
    let astar = |heuristic, g| PlannerConfig::AStar(AStarConfig { corners, heuristic, g });
    let too_large = [Heuristic::Manhattan, Heuristic::Mean];
    let mut planners = HEURISTICS.map(greedy).to_vec();
    planners.extend(HEURISTICS.map(|heuristic| astar(heuristic, PathCost::StraightLine)));
    planners.extend(too_large.map(|heuristic| astar(heuristic, PathCost::Accumulated)));
    planners.extend(density(corners));
    planners.extend(ratio(corners));
    let bidirectional = |heuristic| BidirectionalAStarConfig { corners, heuristic };
    planners.extend(HEURISTICS.map(bidirectional).map(PlannerConfig::BidirectionalAStar));
    // A distance to obstacles may leave no path.
    let free = HstaConfig { l1_constraint: 0.0, corners, ..HstaConfig::PAPER };
    let unweighted = HstaConfig { weight: Weight::One, ..free.clone() };
    let uncorrected = HstaConfig { correction: Correction::None, ..free.clone() };
    planners.extend([free, unweighted, uncorrected].map(PlannerConfig::Hsta));
    planners
}

fn density(corners: CornerRule) -> Vec<PlannerConfig> {
    let scopes = [Density::Box, Density::Remaining, Density::Map, Density::None];
    let costs = [PathCost::Accumulated, PathCost::StraightLine];
    let usual = || DensityAStarConfig { corners, ..DensityAStarConfig::PAPER };
    let with_scopes = scopes.map(|density| DensityAStarConfig { density, ..usual() });
    let with_costs = costs.map(|g| DensityAStarConfig { g, ..usual() });
    let with_heuristics = HEURISTICS.map(|heuristic| DensityAStarConfig { heuristic, ..usual() });
    let reopening = DensityAStarConfig { closed: Closed::Reopen, ..usual() };
    let unweighted = DensityAStarConfig { weight: EstimateWeight::One, ..usual() };
    let configs = with_scopes.into_iter().chain(with_costs).chain(with_heuristics);
    configs.chain([reopening, unweighted]).map(PlannerConfig::DensityAStar).collect()
}

fn ratio(corners: CornerRule) -> Vec<PlannerConfig> {
    let usual = || RatioAStarConfig { corners, ..RatioAStarConfig::PAPER };
    let with_x = [0.5, 1.0, 1.1, 4.0, 1e300].map(|x| RatioAStarConfig { x, ..usual() });
    let to_the_end = RatioAStarConfig { end: SearchEnd::GoalExpanded, ..usual() };
    with_x.into_iter().chain([to_the_end]).map(PlannerConfig::RatioAStar).collect()
}

/// True if cells may be expanded more than once.
fn reopens(planner: &PlannerConfig) -> bool {
    matches!(planner, PlannerConfig::DensityAStar(config) if config.closed == Closed::Reopen)
}

/// Records the search events.
#[derive(Default)]
struct Log {
    expanded: Vec<(Side, Cell)>,
    generated: u64,
}

impl Observer for Log {
    fn expanded(&mut self, side: Side, at: Cell, _: f64) {
        self.expanded.push((side, at));
    }
    fn generated(&mut self, _: Side, _: Cell, _: Cell, _: f64) {
        self.generated += 1;
    }
}

/// The number of nodes that a search begins with; `None` for planners that do not go from cell to
/// cell.
fn roots(planner: &PlannerConfig) -> Option<u64> {
    match planner.name() {
        "jps" | "prepared" | "rrt" => None,
        "bidirectional-optimal" | "bidirectional-astar" | "bidirectional-24" | "hsta" => Some(2),
        _ => Some(1),
    }
}

/// The observed events agree with the statistics. No cell is expanded twice, except the one at
/// which the sides of HSTA* meet.
pub(crate) fn check_observer(planner: &PlannerConfig, raw: &Raw, rules: &Rules, query: &Query) {
    let Some(roots) = roots(planner) else { return };
    let map = raw.search_map(rules);
    let (mut workspace, mut plan, mut log) =
        (Workspace::default(), Plan::default(), Log::default());
    let built = planner.build(&map).unwrap();
    let result = built.plan_into(&map, query, &mut workspace, Some(&mut log), &mut plan);
    if result.is_err() {
        // Start or goal is not free, or they are not connected: reported without a search.
        assert_eq!((log.expanded.len(), log.generated), (0, 0), "{planner:?}");
        return;
    }
    let statistics = plan.statistics;
    assert_eq!(statistics.expanded(), log.expanded.len() as u64, "{planner:?}");
    assert_eq!(statistics.generated(), log.generated + roots, "{planner:?}");
    let first = |side| log.expanded.iter().find(|(s, _)| *s == side).map(|(_, at)| *at);
    assert!(first(Side::Forward).is_none_or(|at| at == query.start));
    assert!(first(Side::Backward).is_none_or(|at| at == query.goal));
    let mut cells: Vec<(i32, i32)> = log.expanded.iter().map(|(_, at)| (at.y, at.x)).collect();
    cells.sort_unstable();
    cells.dedup();
    let meets_expanding = matches!(planner, PlannerConfig::Hsta(_)) && !cells.is_empty();
    let twice = log.expanded.len() - cells.len();
    let is_as_expected = twice == usize::from(meets_expanding) || reopens(planner);
    assert!(is_as_expected, "{planner:?} expands twice\n{}", raw.drawing());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, ..ProptestConfig::default() })]

    #[test]
    fn optimal_planners_find_the_optimum(raw in any_raw(), rules in any_rules(), ends: (u32, u32, u32, u32)) {
        let query = query_on(&raw, ends);
        let (map, mut workspace) = (raw.search_map(&rules), Workspace::default());
        let optimum = raw.optimum(&query, &rules);
        for planner in optimal(rules.corners) {
            let Some(answer) = ask(&planner, &map, &query, &mut workspace) else { continue };
            let cost = checked_cost(&planner, &raw, &rules, &query, answer.clone());
            prop_assert_eq!(cost, optimum, "{:?}\n{}", planner, raw.drawing());
            // A second query on the same memory.
            prop_assert_eq!(ask(&planner, &map, &query, &mut workspace), Some(answer));
            check_observer(&planner, &raw, &rules, &query);
        }
    }

    #[test]
    fn the_others_find_a_path_iff_there_is_one(raw in any_raw(), rules in any_rules(), ends: (u32, u32, u32, u32)) {
        let query = query_on(&raw, ends);
        let (map, mut workspace) = (raw.search_map(&rules), Workspace::default());
        let optimum = raw.optimum(&query, &rules);
        for planner in inexact(rules.corners) {
            prop_assert!(!planner.is_optimal());
            let answer = ask(&planner, &map, &query, &mut workspace).unwrap();
            let cost = checked_cost(&planner, &raw, &rules, &query, answer);
            prop_assert_eq!(cost.is_some(), optimum.is_some(), "{:?}\n{}", planner, raw.drawing());
            prop_assert!(cost >= optimum, "{:?}\n{}", planner, raw.drawing());
            check_observer(&planner, &raw, &rules, &query);
        }
    }

    #[test]
    fn astar4_finds_the_optimum_without_diagonal_steps(raw in any_raw(), rules in any_rules(), ends: (u32, u32, u32, u32)) {
        let rules = Rules { diagonals: false, ..rules };
        let query = query_on(&raw, ends);
        let (map, mut workspace) = (raw.search_map(&rules), Workspace::default());
        let optimum = raw.optimum(&query, &rules);
        for heuristic in HEURISTICS {
            let planner = PlannerConfig::AStar4(AStar4Config { heuristic });
            let answer = ask(&planner, &map, &query, &mut workspace).unwrap();
            let cost = checked_cost(&planner, &raw, &rules, &query, answer);
            prop_assert_eq!(cost, optimum, "{:?}\n{}", planner, raw.drawing());
            check_observer(&planner, &raw, &rules, &query);
        }
    }
}

/// With penalised unknown cells, a path costs differently in the two directions: the start's own
/// penalty is never paid, the goal's always.
#[test]
fn penalties_have_a_direction() {
    let raw = Raw {
        width: 3,
        height: 1,
        states: vec![CellState::Unknown, CellState::Free, CellState::Free],
    };
    let rules = Rules { unknown: UnknownPolicy::Penalised, penalty: 4, ..Rules::default() };
    let map = raw.search_map(&rules);
    let (left, right) = (Cell::new(0, 0), Cell::new(2, 0));
    for planner in optimal(CornerRule::Forbid) {
        let straight = |query| {
            let answer = ask(&planner, &map, &query, &mut Workspace::default())?;
            Some(answer.unwrap().cost.steps().unwrap().straight)
        };
        let there = straight(Query::new(left, right));
        let back = straight(Query::new(right, left));
        assert!(matches!((there, back), (Some(2), Some(5)) | (None, None)), "{planner:?}");
    }
}

#[test]
fn both_sides_of_a_bidirectional_search_work() {
    let raw = Raw::from_fn(20, 20, |_, _| true);
    let query = Query::new(Cell::new(0, 0), Cell::new(19, 10));
    let (mut log, mut plan) = (Log::default(), Plan::default());
    let (map, mut workspace) = (raw.search_map(&Rules::default()), Workspace::default());
    let planner = PlannerConfig::by_name("bidirectional-optimal").unwrap().build(&map).unwrap();
    planner.plan_into(&map, &query, &mut workspace, Some(&mut log), &mut plan).unwrap();
    let count = |side| log.expanded.iter().filter(|(s, _)| *s == side).count();
    let (forward, backward) = (count(Side::Forward), count(Side::Backward));
    assert!(forward * 3 >= backward && backward * 3 >= forward, "{:?}", log.expanded);
    assert_eq!(log.expanded[0], (Side::Forward, query.start));
}
