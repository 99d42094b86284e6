//! Comparison of each row of a map with the first one, with significance tests.

use super::Compared;
use super::contest::ContestEntry;
use super::row::SAME_M;
use crate::significance::{Differences, holm_of, p_value};
use crate::table::{comment, latex_table, number, rows, with_range};
use keyway_sim::metrics::statistics::McNemarTest;
use serde::Serialize;

/// Paired comparison of a row with the first one of its map, query by query.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AgainstFirst {
    map: String,
    first_planner: &'static str,
    first_smoother: &'static str,
    planner: &'static str,
    smoother: &'static str,
    only_solved_by_this: u64,
    only_solved_by_first: u64,
    solved_p: Option<f64>,
    solved_p_holm: Option<f64>,
    pairs: usize,
    equal: Option<usize>,
    median_length_difference_m: Option<f64>,
    ci_low_length_difference_m: Option<f64>,
    ci_high_length_difference_m: Option<f64>,
    rank_biserial: Option<f64>,
    length_p: Option<f64>,
    length_p_holm: Option<f64>,
}

/// Compares all other rows of a map with the first one.
pub(super) fn against_first(map: &Compared) -> Vec<AgainstFirst> {
    let Some((first, others)) = map.contest.entries.split_first() else { return Vec::new() };
    let mut all: Vec<AgainstFirst> =
        others.iter().map(|other| compare(map, first, other)).collect();
    let corrected = holm_of(all.iter().map(|one| one.length_p));
    for (one, p) in all.iter_mut().zip(corrected) {
        one.length_p_holm = p;
    }
    // A planner solves the same queries with every smoother: one test for each planner.
    let is_new = |i: usize| others[..i].iter().all(|one| one.planner != others[i].planner);
    let tested: Vec<usize> = (0..others.len()).filter(|&i| is_new(i)).collect();
    let solved = holm_of(tested.iter().map(|&i| all[i].solved_p));
    let planners: Vec<_> = tested.iter().map(|&i| all[i].planner).zip(solved).collect();
    for one in &mut all {
        let own = planners.iter().find(|(planner, _)| *planner == one.planner);
        one.solved_p_holm = own.and_then(|(_, p)| *p);
    }
    all
}

fn compare(map: &Compared, first: &ContestEntry, other: &ContestEntry) -> AgainstFirst {
    let runs = other.answers.len();
    let queries = || other.answers.iter().zip(&first.answers);
    let solved = McNemarTest::of_pairs(
        queries().map(|(this, first)| [this.found.is_some(), first.found.is_some()]),
    );
    let differences = queries().zip(&map.counts).filter(|(_, counts)| **counts);
    let differences = differences.filter_map(|((this, first), _)| {
        Some(this.found.as_ref()?.metrics.length_m - first.found.as_ref()?.metrics.length_m)
    });
    let differences = Differences::of(differences, SAME_M);
    let [ci_low_length_difference_m, ci_high_length_difference_m] = differences.median_ends();
    let Differences { pairs, test: length } = differences;
    AgainstFirst {
        map: map.name.clone(),
        first_planner: first.planner,
        first_smoother: first.smoother,
        planner: other.planner,
        smoother: other.smoother,
        only_solved_by_this: solved.only_first,
        only_solved_by_first: solved.only_second,
        solved_p: (other.planner != first.planner && runs > 1).then_some(solved.p_value),
        solved_p_holm: None,
        pairs,
        equal: length.map(|length| length.zeros),
        median_length_difference_m: length.map(|length| length.median_difference),
        ci_low_length_difference_m,
        ci_high_length_difference_m,
        rank_biserial: length.map(|length| length.rank_biserial),
        length_p: length.filter(|_| pairs > 1).map(|length| length.p_value),
        length_p_holm: None,
    }
}

/// Text below the table of a map; `None` for a single row. `all` are the comparisons of all maps.
pub fn against_first_note(map: &Compared, all: &[AgainstFirst]) -> Option<String> {
    let own = || all.iter().filter(|one| one.map == map.name);
    let AgainstFirst { first_planner, first_smoother, .. } = own().next()?;
    let title = format!("Against {first_planner}, {first_smoother}:");
    let header =
        ["planner", "smoother", "pairs", "equal", "difference m", "effect", "p", "p of\nsolved"];
    let lines = own().map(cells).collect();
    Some(format!("{title}\n\n{}", rows(&header, lines, 2)))
}

/// Returns the comparisons of all maps as LaTeX.
pub fn against_first_latex(all: &[AgainstFirst]) -> String {
    let header = [
        "map",
        "planner",
        "smoother",
        "pairs",
        "equal",
        "difference m",
        "effect",
        "p (length)",
        "p (solved)",
    ];
    let line = |one: &AgainstFirst| [vec![one.map.clone()], cells(one)].concat();
    let about = all.first().map_or_else(String::new, |one| {
        let AgainstFirst { first_planner, first_smoother, .. } = one;
        comment(&format!("Against {first_planner}, {first_smoother}. {ABOUT}"))
    });
    about + &latex_table(&header, &all.iter().map(line).collect::<Vec<_>>(), 3)
}

const ABOUT: &str = "difference: of the lengths, its Hodges-Lehmann median and in brackets its 95 % confidence\n\
                     interval; effect: rank-biserial correlation; p: Wilcoxon's signed-rank test of lengths and\n\
                     McNemar's exact test of solved queries, both corrected by Holm's method.";

fn cells(one: &AgainstFirst) -> Vec<String> {
    // Drops the sign of a zero.
    let metres: fn(Option<f64>) -> String =
        |value| number(value.map(|m| (m * 1e3).round() / 1e3 + 0.0), 3);
    let ends = [one.ci_low_length_difference_m, one.ci_high_length_difference_m];
    vec![
        one.planner.to_owned(),
        one.smoother.to_owned(),
        one.pairs.to_string(),
        one.equal.map_or_else(|| "-".to_owned(), |equal| equal.to_string()),
        with_range(one.median_length_difference_m, ends, metres),
        number(one.rank_biserial, 2),
        p_value(one.length_p_holm),
        p_value(one.solved_p_holm),
    ]
}
