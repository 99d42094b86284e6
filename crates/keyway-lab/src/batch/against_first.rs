//! Comparison of each stack with the first one, with significance tests.

use super::independent::independent;
use super::record::Record;
use super::row::Row;
use crate::significance::{Differences, holm_of, p_value};
use crate::table::{comment, latex_table};
use crate::table::{number, rows, with_range};
use keyway_sim::metrics::statistics::McNemarTest;
use serde::Serialize;
use std::collections::HashMap;

/// Paired comparison of a stack with the first one: the same scene with the same seed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AgainstFirst {
    first: String,
    stack: String,
    only_reached_by_this: u64,
    only_reached_by_first: u64,
    /// `None` for a single run: no test can tell anything from it.
    reached_p: Option<f64>,
    reached_p_holm: Option<f64>,
    /// Runs in which both reached the goal.
    pairs: usize,
    median_time_difference_s: Option<f64>,
    ci_low_time_difference_s: Option<f64>,
    ci_high_time_difference_s: Option<f64>,
    rank_biserial: Option<f64>,
    time_p: Option<f64>,
    time_p_holm: Option<f64>,
}

/// Times closer than this are equal \[s\]: they are sums of cycles, with rounding errors.
const SAME_S: f64 = 1e-6;

/// Compares all other stacks with the first one.
pub fn against_first(records: &[Record], stacks: &[String]) -> Vec<AgainstFirst> {
    let Some((first, others)) = stacks.split_first() else { return Vec::new() };
    let runs = independent(records);
    let mut all: Vec<AgainstFirst> =
        others.iter().map(|other| compared(&runs, first, other)).collect();
    let reached = holm_of(all.iter().map(|one| one.reached_p));
    let time = holm_of(all.iter().map(|one| one.time_p));
    for (one, (reached_p, time_p)) in all.iter_mut().zip(reached.into_iter().zip(time)) {
        (one.reached_p_holm, one.time_p_holm) = (reached_p, time_p);
    }
    all
}

fn compared<'a>(runs: &[&'a Row], first: &str, other: &str) -> AgainstFirst {
    let of = |stack: &str| -> Vec<&'a Row> {
        runs.iter().copied().filter(|run| run.stack == stack).collect()
    };
    let firsts: HashMap<(&str, u64), &Row> =
        of(first).into_iter().map(|run| ((run.scene.as_str(), run.seed), run)).collect();
    let with_first = |run: &'a Row| Some((run, *firsts.get(&(run.scene.as_str(), run.seed))?));
    let pairs: Vec<(&Row, &Row)> = of(other).into_iter().filter_map(with_first).collect();
    let runs = pairs.len();
    let reached = McNemarTest::of_pairs(
        pairs.iter().map(|(this, first)| [this, first].map(|run| run.has_reached())),
    );
    let both = pairs.iter().filter(|(this, first)| this.has_reached() && first.has_reached());
    let differences = both.filter_map(|(this, first)| Some(this.time_s? - first.time_s?));
    let differences = Differences::of(differences, SAME_S);
    let [ci_low_time_difference_s, ci_high_time_difference_s] = differences.median_ends();
    let Differences { pairs, test: time } = differences;
    AgainstFirst {
        first: first.to_owned(),
        stack: other.to_owned(),
        only_reached_by_this: reached.only_first,
        only_reached_by_first: reached.only_second,
        reached_p: (runs > 1).then_some(reached.p_value),
        reached_p_holm: None,
        pairs,
        median_time_difference_s: time.map(|time| time.median_difference),
        ci_low_time_difference_s,
        ci_high_time_difference_s,
        rank_biserial: time.map(|time| time.rank_biserial),
        time_p: time.filter(|_| pairs > 1).map(|time| time.p_value),
        time_p_holm: None,
    }
}

const HEADER: [&str; 6] = ["stack", "reached alone", "p", "pairs", "time against the first", "p"];

/// Column names with units, for papers: there, the text below the table is a comment and not
/// printed.
const WITH_UNITS: [&str; 6] =
    ["stack", "reached alone", "p (reached)", "pairs", "time against the first s", "p (time)"];

/// Cells of a comparison.
fn cells(one: &AgainstFirst) -> Vec<String> {
    let ends = [one.ci_low_time_difference_s, one.ci_high_time_difference_s];
    vec![
        one.stack.clone(),
        format!("{} : {}", one.only_reached_by_this, one.only_reached_by_first),
        p_value(one.reached_p_holm),
        one.pairs.to_string(),
        with_range(one.median_time_difference_s, ends, |seconds| number(seconds, 2)),
        p_value(one.time_p_holm),
    ]
}

/// Table for the terminal; `None` for a single stack.
pub fn against_first_table(all: &[AgainstFirst]) -> Option<String> {
    let first = &all.first()?.first;
    let table = rows(&HEADER, all.iter().map(cells).collect(), 1);
    Some(format!("Against {first}:\n\n{table}\n\n{ABOUT}"))
}

/// Table as Markdown.
pub fn against_first_markdown(all: &[AgainstFirst]) -> String {
    let Some(one) = all.first() else { return String::new() };
    let table = super::summary::markdown_table(&HEADER, all.iter().map(cells));
    format!("\nAgainst {}:\n\n{table}\n{ABOUT}\n", one.first)
}

/// Table as LaTeX; `None` for a single stack.
pub fn against_first_latex(all: &[AgainstFirst]) -> Option<String> {
    let first = &all.first()?.first;
    let lines: Vec<Vec<String>> = all.iter().map(cells).collect();
    let about = comment(&format!("Against {first}.\n{ABOUT}"));
    Some(about + &latex_table(&WITH_UNITS, &lines, 1))
}

const ABOUT: &str = "reached alone: runs in which only this stack : only the first one reached the goal; time: Hodges-Lehmann median of the\n\
                     differences [s] and its 95 % interval, if both did; p: McNemar's exact test, Wilcoxon's signed-rank test, both corrected\n\
                     for all stacks (Holm). The runs of a scene with different seeds count as independent.";
