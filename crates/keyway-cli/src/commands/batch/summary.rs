//! What the runs of a stack say together.

use super::record::{ContactWhile, Record, Row};
use crate::table::{number, percent, rows};
use keyway::episode::EpisodeOutcome;
use serde::Serialize;

/// The runs of a stack. Means are those of the runs that reached the goal; the score is that of all runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct StackSummary {
    pub(super) stack: String,
    pub(super) runs: usize,
    pub(super) reached: usize,
    pub(super) contacts_driving: usize,
    pub(super) contacts_standing: usize,
    pub(super) stuck: usize,
    pub(super) timeout: usize,
    pub(super) no_path: usize,
    pub(super) mean_time_s: Option<f64>,
    pub(super) mean_length_m: Option<f64>,
    pub(super) mean_speed_mps: Option<f64>,
    pub(super) mean_clearance_m: Option<f64>,
    pub(super) least_clearance_m: Option<f64>,
    pub(super) mean_score: Option<f64>,
}

/// Of each stack, in the order in which they first drive.
pub(super) fn summaries(records: &[Record]) -> Vec<StackSummary> {
    let mut names: Vec<&str> = Vec::new();
    for record in records {
        if !names.contains(&record.run.stack.as_str()) {
            names.push(&record.run.stack);
        }
    }
    let of = |name: &str| {
        let runs = records.iter().map(|record| &record.run).filter(|run| run.stack == name);
        summary(name, &runs.collect::<Vec<_>>())
    };
    names.into_iter().map(of).collect()
}

fn summary(stack: &str, runs: &[&Row]) -> StackSummary {
    let count = |is: &dyn Fn(&Row) -> bool| runs.iter().filter(|run| is(run)).count();
    let of = |outcome: EpisodeOutcome| count(&|run| run.outcome == outcome);
    let touched = |while_: ContactWhile| count(&|run| run.contact == Some(while_));
    let reached = |get: fn(&Row) -> Option<f64>| -> Vec<f64> {
        let reached = runs.iter().filter(|run| run.outcome == EpisodeOutcome::Reached);
        reached.filter_map(|run| get(run)).collect()
    };
    let clearances = reached(|run| run.min_clearance_m);
    StackSummary {
        stack: stack.to_owned(),
        runs: runs.len(),
        reached: of(EpisodeOutcome::Reached),
        contacts_driving: touched(ContactWhile::Driving),
        contacts_standing: touched(ContactWhile::Standing),
        stuck: of(EpisodeOutcome::Stuck),
        timeout: of(EpisodeOutcome::Timeout),
        no_path: of(EpisodeOutcome::NoPath),
        mean_time_s: mean(&reached(|run| run.time_s)),
        mean_length_m: mean(&reached(|run| run.length_m)),
        mean_speed_mps: mean(&reached(|run| run.mean_speed_mps)),
        mean_clearance_m: mean(&clearances),
        least_clearance_m: clearances.into_iter().reduce(f64::min),
        mean_score: mean(&runs.iter().filter_map(|run| run.score).collect::<Vec<_>>()),
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

const HEADER: [&str; 10] = [
    "stack",
    "runs",
    "reached",
    "contacts",
    "stuck",
    "time",
    "length",
    "speed",
    "clearance",
    "score",
];

/// The columns for people: contacts while driving and while standing, and the rest that did not end at the goal.
fn cells(summary: &StackSummary) -> Vec<String> {
    let share = summary.reached as f64 / summary.runs as f64;
    let others = summary.stuck + summary.timeout + summary.no_path;
    vec![
        summary.stack.clone(),
        summary.runs.to_string(),
        percent(Some(share), 1),
        format!("{} + {}", summary.contacts_driving, summary.contacts_standing),
        others.to_string(),
        number(summary.mean_time_s, 2),
        number(summary.mean_length_m, 2),
        number(summary.mean_speed_mps, 3),
        number(summary.mean_clearance_m, 3),
        number(summary.mean_score, 3),
    ]
}

/// For the terminal.
pub(super) fn table(stacks: &[StackSummary]) -> String {
    let table = rows(&HEADER, stacks.iter().map(cells).collect(), 1);
    format!("{table}\n\n{ABOUT}")
}

/// The same as Markdown.
pub(super) fn markdown(stacks: &[StackSummary]) -> String {
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let header = row(HEADER.map(str::to_owned).to_vec());
    let line = format!("|---|{}\n", "--:|".repeat(HEADER.len() - 1));
    let lines: String = stacks.iter().map(|summary| row(cells(summary))).collect();
    format!("{header}{line}{lines}\n{ABOUT}\n")
}

const ABOUT: &str = "contacts: while the robot drove + while it stood; stuck: also time limits, and where there was no path.\n\
                     time [s], length [m], speed [m/s] and clearance [m] are means of the runs that reached the goal.";
