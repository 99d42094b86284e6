//! Table of a route.

use super::path_facts::{lowered, not_kept, smoothed_facts};
use super::smoothing_targets::SmoothingTargets;
use crate::table::{facts, number, quantity, rows};
use keyway::search::SideStatistics;
use keyway_sim::report::{GoalPart, PlanPart, ReachedGoal, RouteReport};

/// Table of a route for the terminal.
pub fn route_table(report: &RouteReport, targets: SmoothingTargets) -> String {
    let PlanPart { outcome, planner, search, .. } = &report.plan;
    let plan = &report.plan;
    let both = |count: fn(&SideStatistics) -> u64| match search.backward {
        SideStatistics { expanded: 0, generated: 0 } => count(&search.forward).to_string(),
        backward => {
            let (from_start, from_goal) = (count(&search.forward), count(&backward));
            format!("{} ({from_start} + {from_goal})", from_start + from_goal)
        }
    };
    let mut rows = vec![
        ("outcome", outcome.text().to_owned()),
        ("planner", (*planner).to_owned()),
        ("length", quantity(plan.length_m, 3, "m")),
        ("cost", quantity(plan.cost_cells, 3, "cells")),
        ("expanded", both(|side| side.expanded)),
        ("generated", both(|side| side.generated)),
        ("time", quantity(plan.time_s.map(|time| time * 1e3), 3, "ms")),
        ("turns", plan.turns.map_or_else(|| "-".to_owned(), |turns| turns.to_string())),
        ("turning angle", quantity(plan.turning_angle_deg, 1, "deg")),
        ("clearance", quantity(plan.min_clearance_m, 3, "m")),
    ];
    if let Some(excess) = plan.excess {
        rows.push(("excess", format!("{:.3} %", excess * 100.0)));
    }
    if let Some(cell) = plan.meeting {
        rows.push(("sides met in", cell.to_string()));
    }
    if let Some(stop) = plan.stopped {
        rows.push(("stopped because", stop.to_string()));
    }
    if let Some(why) = &plan.why {
        rows.push(("why", why.clone()));
    }
    rows.extend(lowered(plan));
    if let Some(smoothed) = &report.smoothed {
        rows.extend(smoothed_facts(smoothed, targets));
    } else {
        rows.extend(not_kept("the requested clearance", plan.kept_clearance_m));
    }
    if let Some(ReachedGoal { cell, gap_m, .. }) = report.goal.filter(|goal| goal.gap_m > 0.0) {
        rows.push(("goal not reached", format!("{gap_m:.3} m short of it, in cell {cell}")));
    }
    let goals = report.goals.as_deref().map(goals_table);
    [Some(facts(rows)), goals].into_iter().flatten().collect::<Vec<_>>().join("\n\n")
}

/// Returns a row for each goal, the nearest first.
fn goals_table(goals: &[GoalPart]) -> String {
    let row = |part: &GoalPart| {
        vec![
            format!("{:.3}, {:.3}", part.goal.x, part.goal.y),
            part.outcome.text().to_owned(),
            number(part.length_m, 3),
            number(part.cost_cells, 3),
            part.expanded.to_string(),
        ]
    };
    let header = ["goal [m]", "outcome", "length m", "cost cells", "expanded"];
    rows(&header, goals.iter().map(row).collect(), 2)
}
