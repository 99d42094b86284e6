//! Unsolved queries, with the reasons.

use super::Compared;
use super::contest::ContestEntry;
use keyway_sim::report::PlanOutcome;
use serde::Serialize;
use std::path::Path;

/// Maximum number of unsolved queries listed below the table.
const LINES: usize = 5;

/// Planners that found no path for a query, all for the same reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unsolved {
    planners: Vec<&'static str>,
    outcome: PlanOutcome,
    reason: String,
}

/// Returns all planners without a path for a query, in the order of the table.
pub(super) fn unsolved(entries: &[ContestEntry], query: usize) -> Vec<Unsolved> {
    let mut all: Vec<Unsolved> = Vec::new();
    for entry in entries {
        let answer = &entry.answers[query];
        let Some(reason) = &answer.reason else { continue };
        match all.iter_mut().find(|one| one.reason == *reason) {
            // Each smoother has its own entry, too.
            Some(one) if one.planners.contains(&entry.planner) => {}
            Some(one) => one.planners.push(entry.planner),
            None => all.push(Unsolved {
                planners: vec![entry.planner],
                outcome: answer.outcome,
                reason: reason.clone(),
            }),
        }
    }
    all
}

/// Text below the table; `None` if all queries are solved. `file` is the file of the queries;
/// `elsewhere` names the place of the complete list, for a text that has only some of them.
pub fn unsolved_note(maps: &[Compared], file: Option<&Path>, elsewhere: &str) -> Option<String> {
    let of_map = |map: &Compared| -> Vec<String> {
        (0..map.queries.len()).flat_map(|query| lines(map, query, file)).collect()
    };
    let mut all: Vec<String> = maps.iter().flat_map(of_map).collect();
    let more = all.len().saturating_sub(LINES);
    all.truncate(LINES);
    if more > 0 {
        all.push(format!("and {more} more; {elsewhere}"));
    }
    (!all.is_empty()).then(|| format!("\nNot solved:\n  {}", all.join("\n  ")))
}

fn lines(map: &Compared, query: usize, file: Option<&Path>) -> impl Iterator<Item = String> {
    let line = map.queries[query].line.zip(file);
    let line = line.map(|(line, file)| format!(" (line {line} of {})", file.display()));
    let left_out = if map.counts[query] { "" } else { ", not compared" };
    let place = format!("{}, query {}{}{left_out}", map.name, query + 1, line.unwrap_or_default());
    let line = move |one: Unsolved| format!("{place}: {}: {}", one.planners.join(", "), one.reason);
    unsolved(&map.contest.entries, query).into_iter().map(line)
}
