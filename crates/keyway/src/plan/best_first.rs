//! The loop under every one-sided planner.

use super::{Plan, PlanError, Stop, path_cost};
use crate::map::SearchMap;
use crate::search::{
    Frontier, Moves, Neighbours, Observer, Query, Rule, SearchStatistics, Side, Successors,
    Uniform, UnknownCost, Workspace, cells,
};

/// A best-first search under a rule, from the query's start to its goal, into a plan.
pub(super) fn plan(
    map: &SearchMap,
    query: &Query,
    moves: Moves,
    rule: &impl Rule,
    workspace: &mut Workspace,
    seen: Option<&mut dyn Observer>,
    plan: &mut Plan,
) -> Result<(), PlanError> {
    let frontier = &mut workspace.forward;
    let uniform = Neighbours::new(map, moves, Uniform);
    let stop = match (UnknownCost::of(map), seen) {
        (None, None) => run(map, query, &uniform, rule, frontier, &mut ()),
        (None, Some(mut seen)) => run(map, query, &uniform, rule, frontier, &mut seen),
        (Some(cost), None) => {
            run(map, query, &Neighbours::new(map, moves, cost), rule, frontier, &mut ())
        }
        (Some(cost), Some(mut seen)) => {
            run(map, query, &Neighbours::new(map, moves, cost), rule, frontier, &mut seen)
        }
    }?;
    frontier.path_into(map, map.index(query.goal), &mut plan.cells);
    plan.cost = path_cost(map, &plan.cells);
    plan.statistics = SearchStatistics::one_sided(frontier.statistics());
    plan.stop = Some(stop);
    Ok(())
}

/// Expands nodes until the goal is reached as the rule asks for.
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

/// An error when the query's budget is used up.
pub(super) fn check_budget(query: &Query, statistics: SearchStatistics) -> Result<(), PlanError> {
    match query.budget {
        Some(budget) if statistics.expanded() >= budget => {
            Err(PlanError::BudgetExhausted { budget, statistics })
        }
        _ => Ok(()),
    }
}
