//! Planners that lowered a constraint, and the lowered values.

use super::Compared;
use super::contest::ContestEntry;
use keyway::plan::{PlanNote, Relaxed};

/// Text below the table; `None` if every constraint was kept.
pub fn lowered_note(maps: &[Compared]) -> Option<String> {
    let lines: Vec<String> = maps.iter().flat_map(of_map).collect();
    let title = "\nConstraints lowered until a path existed:";
    (!lines.is_empty()).then(|| format!("{title}\n  {}", lines.join("\n  ")))
}

fn of_map(map: &Compared) -> Vec<String> {
    let mut lines = Vec::new();
    let mut planners: Vec<&str> = Vec::new();
    for entry in &map.contest.entries {
        // Each smoother has its own entry, too.
        if !planners.contains(&entry.planner) {
            planners.push(entry.planner);
            lines.extend(line(&map.name, entry));
        }
    }
    lines
}

fn relaxed(note: PlanNote) -> Option<Relaxed> {
    match note {
        PlanNote::Relaxed(relaxed) => Some(relaxed),
        _ => None,
    }
}

fn line(map: &str, entry: &ContestEntry) -> Option<String> {
    let notes = entry.answers.iter().filter_map(|answer| answer.note);
    let lowered: Vec<Relaxed> = notes.filter_map(relaxed).collect();
    let Relaxed { asked_m, .. } = *lowered.first()?;
    let least_m = lowered.iter().map(|one| one.used_m).fold(f64::INFINITY, f64::min);
    let (count, all, planner) = (lowered.len(), entry.answers.len(), entry.planner);
    Some(format!(
        "{map}: {planner} in {count} of {all} queries, from {asked_m:.3} m to at least {least_m:.3} m"
    ))
}
