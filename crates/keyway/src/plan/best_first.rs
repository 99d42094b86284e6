//! The search loop of every one-sided planner.

use super::{Plan, PlanError, Stop, path_cost};
use crate::map::SearchMap;
use crate::search::{
    Frontier, Moves, Neighbours, Observer, Query, Rule, SearchStatistics, Side, Sides, Successors,
    Workspace, cells,
};

/// Evaluates an expression with `$cost` bound to the step costs of a map and `$seen` to the
/// observer, if any. Each combination gets its own copy of the search, so that the inner loop does
/// no dispatch.
macro_rules! with_costs {
    ($map:expr, $observer:expr, $cost:ident, $seen:ident => $body:expr) => {
        match ($crate::search::UnknownCost::of($map), $observer) {
            (None, None) => {
                let ($cost, $seen) = ($crate::search::Uniform, &mut ());
                $body
            }
            (None, Some(mut observer)) => {
                let ($cost, $seen) = ($crate::search::Uniform, &mut observer);
                $body
            }
            (Some($cost), None) => {
                let $seen = &mut ();
                $body
            }
            (Some($cost), Some(mut observer)) => {
                let $seen = &mut observer;
                $body
            }
        }
    };
}

pub(super) use with_costs;

/// Runs a best-first search under a rule from the query's start to its goal and writes the plan.
pub(super) fn plan(
    map: &SearchMap,
    query: &Query,
    moves: Moves,
    rule: &impl Rule,
    workspace: &mut Workspace,
    seen: Option<&mut dyn Observer>,
    plan: &mut Plan,
) -> Result<(), PlanError> {
    let frontier = &mut workspace.part::<Sides>().forward;
    let stop = with_costs!(map, seen, cost, seen => {
        run(map, query, &Neighbours::new(map, moves, cost), rule, frontier, seen)
    })?;
    frontier.path_into(map, map.index(query.goal), &mut plan.cells);
    plan.cost = path_cost(map, &plan.cells);
    plan.statistics = SearchStatistics::one_sided(frontier.statistics());
    plan.stop = Some(stop);
    Ok(())
}

/// Expands nodes until the goal is reached as the rule requires.
fn run<R: Rule>(
    map: &SearchMap,
    query: &Query,
    successors: &impl Successors,
    rule: &R,
    frontier: &mut Frontier,
    seen: &mut impl Observer,
) -> Result<Stop, PlanError> {
    let (start, goal) = (map.index(query.start), map.index(query.goal));
    frontier.start(map, start, rule.key(start, 0));
    if R::ENDS_AT_GENERATION && start == goal {
        return Ok(Stop::GoalGenerated);
    }
    loop {
        let statistics = SearchStatistics::one_sided(frontier.statistics());
        check_budget(query, statistics)?;
        let Some(node) = frontier.take_best() else {
            return Err(PlanError::NoPath { statistics });
        };
        if seen.is_watching() {
            seen.expanded(Side::Forward, map.cell(node.at), cells(node.g));
        }
        if node.at == goal {
            return Ok(Stop::GoalExpanded);
        }
        frontier.expand(map, node, successors, rule, seen);
        if R::ENDS_AT_GENERATION && frontier.value(goal).is_some() {
            return Ok(Stop::GoalGenerated);
        }
    }
}

/// Returns an error if the query's budget is used up.
pub(super) fn check_budget(query: &Query, statistics: SearchStatistics) -> Result<(), PlanError> {
    match query.budget {
        Some(budget) if statistics.expanded() >= budget => {
            Err(PlanError::BudgetExhausted { budget, statistics })
        }
        _ => Ok(()),
    }
}
