//! Rows of the table, from the answers.

use super::contest::{Answer, ContestEntry, Found};
use super::figures::Summaries;
use crate::measure::{mean, quantile};
use keyway::search::CornerRule;
use keyway_sim::metrics::statistics::{Confidence, Rate};
use keyway_sim::report::PlanOutcome;
use serde::Serialize;

/// Name in place of a map's in the rows over all maps.
pub(super) const ALL_MAPS: &str = "all maps";
/// Lengths that differ by less are equal \[m\].
pub(super) const SAME_M: f64 = 1e-6;

/// One row of `keyway.compare/1`; docs/reference/json.md explains its fields.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CompareRow {
    pub(super) map: String,
    pub(super) planner: &'static str,
    pub(super) smoother: &'static str,
    pub(super) corners: CornerRule,
    pub(super) queries: usize,
    pub(super) solved: usize,
    pub(super) ci_low_solved: Option<f64>,
    pub(super) ci_high_solved: Option<f64>,
    pub(super) missed: usize,
    pub(super) without_path: usize,
    pub(super) compared: usize,
    #[serde(flatten)]
    pub(super) figures: Summaries,
    pub(super) shortfalls: usize,
    pub(super) median_plan_us: Option<f64>,
    pub(super) mean_plan_cpu_us: Option<f64>,
    pub(super) median_smooth_us: Option<f64>,
    pub(super) mean_smooth_cpu_us: Option<f64>,
    pub(super) preparation_ms: Option<f64>,
}

impl CompareRow {
    /// True for a row over all maps.
    pub(super) fn is_pooled(&self) -> bool {
        self.map == ALL_MAPS
    }
}

/// Returns true for each query that is compared: solved by every planner that solved any query.
pub(super) fn compared(entries: &[ContestEntry]) -> Vec<bool> {
    let queries = entries.first().map_or(0, |entry| entry.answers.len());
    let solved = |entry: &ContestEntry, query: usize| entry.answers[query].found.is_some();
    let has_solved = |entry: &&ContestEntry| (0..queries).any(|query| solved(entry, query));
    let able: Vec<&ContestEntry> = entries.iter().filter(has_solved).collect();
    let by_all = |query| !able.is_empty() && able.iter().all(|entry| solved(entry, query));
    (0..queries).map(by_all).collect()
}

/// Returns the compared query whose paths differ most in length; the first one of equals.
pub(super) fn most_different(entries: &[ContestEntry], compared: &[bool]) -> Option<usize> {
    let spread_m = |query: usize| {
        let found = entries.iter().filter_map(|entry| entry.answers[query].found.as_ref());
        let lengths = found.map(|found| found.metrics.length_m);
        let (least_m, most_m) = lengths
            .fold((f64::INFINITY, 0.0), |(least_m, most_m), length_m| {
                (length_m.min(least_m), length_m.max(most_m))
            });
        // Smaller differences are rounding errors of equal lengths.
        Some(most_m - least_m).filter(|&spread_m| spread_m > SAME_M).unwrap_or(0.0)
    };
    let counting = (0..compared.len()).filter(|&query| compared[query]);
    counting.rev().max_by(|&a, &b| spread_m(a).total_cmp(&spread_m(b)))
}

/// Counts over all queries, and means over the compared ones, of one planner and smoother on one
/// map or on several: the answers on each, and whether each query is compared.
pub(super) fn row(map: &str, parts: &[(&ContestEntry, &[bool])]) -> CompareRow {
    let entry = parts[0].0;
    let all = || parts.iter().flat_map(|(entry, _)| &entry.answers);
    // If a planner solved nothing, the others were compared without it.
    let is_found =
        |(answer, is_compared): &(&Answer, &bool)| **is_compared && answer.found.is_some();
    let compared = parts.iter().flat_map(|(entry, compared)| entry.answers.iter().zip(*compared));
    let answers: Vec<&Answer> = compared.filter(is_found).map(|(answer, _)| answer).collect();
    let found: Vec<&Found> = answers.iter().filter_map(|answer| answer.found.as_ref()).collect();
    let smooth_us = found.iter().filter_map(|found| Some(found.smooth?.wall_us())).collect();
    let plan_us = answers.iter().filter_map(|answer| Some(answer.plan?.wall_us())).collect();
    let plan_cpu_us: Option<Vec<f64>> = answers.iter().map(|a| a.plan?.cpu_us()).collect();
    let smooth_cpu_us: Option<Vec<f64>> = found.iter().map(|f| f.smooth?.cpu_us()).collect();
    let count = |is: fn(&Answer) -> bool| all().filter(|one| is(one)).count();
    let (solved, missed) =
        (count(|one| one.found.is_some()), count(|one| one.outcome == PlanOutcome::Missed));
    let solved_share = Rate::of(all().map(|one| one.found.is_some()));
    let solved_share = solved_share.interval(Confidence::USUAL);
    CompareRow {
        map: map.to_owned(),
        planner: entry.planner,
        smoother: entry.smoother,
        corners: entry.corners,
        queries: all().count(),
        solved,
        ci_low_solved: solved_share.map(|interval| interval.low),
        ci_high_solved: solved_share.map(|interval| interval.high),
        missed,
        without_path: all().count() - solved - missed,
        compared: found.len(),
        figures: Summaries::of(&found),
        shortfalls: found.iter().filter(|found| found.done.kept_clearance_m.is_some()).count(),
        median_plan_us: quantile(plan_us, 0.5),
        mean_plan_cpu_us: plan_cpu_us.and_then(|all| mean(&all)),
        median_smooth_us: quantile(smooth_us, 0.5),
        mean_smooth_cpu_us: smooth_cpu_us.and_then(|all| mean(&all)),
        // Each map has a preparation of its own.
        preparation_ms: entry
            .preparation
            .filter(|_| parts.len() == 1)
            .map(|times| times.wall_us() / 1e3),
    }
}

#[cfg(test)]
mod tests {
    use super::super::figures::{
        CLEARANCE_M, EXCESS, Figure, LENGTH_M, Summary, TURNING_ANGLE_DEG, TURNS,
    };
    use super::*;
    use crate::measure::Times;
    use keyway::smooth::Smoothed;
    use keyway_sim::metrics::PathMetrics;
    use std::time::Duration;

    fn micros(wall: u64) -> Times {
        Times { wall: Duration::from_micros(wall), cpu: None }
    }

    fn found(length_m: f64, turns: usize, clearance_m: f64) -> Answer {
        let metrics = PathMetrics {
            length_m,
            points: 2,
            redundant_points: 0,
            turns,
            turning_angle_deg: 45.0,
            non_smooth_turns: 1,
            min_clearance_m: Some(clearance_m),
        };
        let done = Smoothed { kept_clearance_m: Some(0.1), ..Smoothed::default() };
        let found = Found {
            smooth: Some(micros(7)),
            done,
            metrics,
            shortest_m: Some(10.0),
            expanded: 3,
            generated: 5,
        };
        let plan = Some(micros(turns as u64));
        Answer { outcome: PlanOutcome::Found, reason: None, plan, note: None, found: Some(found) }
    }

    fn without(outcome: PlanOutcome) -> Answer {
        Answer { outcome, reason: None, plan: Some(micros(100)), note: None, found: None }
    }

    fn entry(answers: Vec<Answer>) -> ContestEntry {
        let corners = CornerRule::Forbid;
        ContestEntry {
            planner: "p",
            smoother: "s",
            corners,
            preparation: Some(micros(2000)),
            answers,
        }
    }

    #[test]
    fn only_what_all_able_planners_solved_is_compared() {
        use PlanOutcome::{Missed, NoPath};
        let first = entry(vec![
            found(11.0, 2, 0.5),
            found(10.0, 6, 0.25),
            found(99.0, 9, 0.0),
            without(NoPath),
        ]);
        let second =
            entry(vec![found(12.0, 1, 0.5), found(13.0, 1, 0.5), without(Missed), without(NoPath)]);
        let unable = entry((0..4).map(|_| without(Missed)).collect());
        let entries = [first, second, unable];
        let compared = compared(&entries);
        assert_eq!(compared, [true, true, false, false]);
        let row_of = |i: usize| row("m", &[(&entries[i], &compared[..])]);
        let row = row_of(0);
        assert_eq!((row.queries, row.solved, row.missed), (4, 3, 0));
        assert_eq!((row.without_path, row.compared, row.shortfalls), (1, 2, 2));
        let of = |figure: &Figure| row.figures.get(figure);
        assert_eq!((of(&LENGTH_M).mean, of(&TURNS).mean), (Some(10.5), Some(4.0)));
        // 10 and 11: 5 and 95 % between them.
        let near = |value: Option<f64>, expected: f64| (value.unwrap() - expected).abs() < 1e-12;
        let between = |figure: &Figure, p5: f64, p95: f64| {
            let Summary { p5: low, p95: high, .. } = of(figure);
            assert!(near(low, p5) && near(high, p95), "{row:?}");
        };
        between(&LENGTH_M, 10.05, 10.95);
        assert!(near(of(&LENGTH_M).sd, 0.5f64.sqrt()), "{row:?}");
        // Resamples of two values have no other extremes; those of equal values are all equal.
        assert_eq!(of(&LENGTH_M).ci, Some([10.0, 11.0]));
        let angle = of(&TURNING_ANGLE_DEG);
        assert_eq!((angle.sd, angle.ci), (Some(0.0), Some([45.0, 45.0])));
        // Wilson's interval of 3 of 4.
        let ends = [row.ci_low_solved, row.ci_high_solved].map(|end| (end.unwrap() * 1e4).round());
        assert_eq!(ends, [3006.0, 9544.0]);
        between(&TURNS, 2.2, 5.8);
        between(&CLEARANCE_M, 0.2625, 0.4875);
        between(&EXCESS, 0.005, 0.095);
        assert!(near(of(&EXCESS).mean, 0.05) && near(of(&EXCESS).worst, 0.1), "{row:?}");
        let clearance = of(&CLEARANCE_M);
        assert_eq!((clearance.mean, clearance.worst), (Some(0.375), Some(0.25)));
        assert_eq!((row.median_plan_us, row.mean_plan_cpu_us), (Some(4.0), None));
        assert_eq!((row.median_smooth_us, row.preparation_ms), (Some(7.0), Some(2.0)));
        let row = row_of(2);
        assert_eq!((row.solved, row.missed, row.compared), (0, 4, 0));
        let none = (Summary::default(), Summary::default(), None);
        let of = |figure: &Figure| row.figures.get(figure);
        assert_eq!((of(&LENGTH_M), of(&CLEARANCE_M), row.median_plan_us), none);
    }

    #[test]
    fn a_row_over_all_maps_counts_every_query_once() {
        let first = entry(vec![found(10.0, 2, 0.5), without(PlanOutcome::NoPath)]);
        let second = entry(vec![found(13.0, 4, 0.1), found(16.0, 6, 0.3), found(99.0, 9, 0.0)]);
        let parts = [(&first, &[true, false][..]), (&second, &[true, true, false][..])];
        let row = row(ALL_MAPS, &parts);
        assert!(row.is_pooled());
        assert_eq!((row.queries, row.solved, row.compared, row.without_path), (5, 4, 3, 1));
        let length = row.figures.get(&LENGTH_M);
        assert_eq!((length.mean, row.figures.get(&CLEARANCE_M).worst), (Some(13.0), Some(0.1)));
        assert_eq!((row.median_plan_us, row.preparation_ms), (Some(4.0), None));
    }

    #[test]
    fn the_query_with_the_widest_spread_of_lengths() {
        let with = |lengths: [f64; 5]| entry(lengths.map(|m| found(m, 1, 0.5)).into());
        let first = with([90.0, 10.0 + 1e-9, 10.0, 20.0, 30.0]);
        let mut second = with([90.5, 10.0, 12.0, 22.0, 99.0]);
        second.answers[4] = without(PlanOutcome::Missed);
        let unable = entry((0..5).map(|_| without(PlanOutcome::Missed)).collect());
        let entries = [first, second, unable];
        let query = |compared: [bool; 5]| most_different(&entries, &compared);
        assert_eq!(query([true, true, true, true, false]), Some(2), "2 m, as the next one");
        assert_eq!(query([true, true, false, false, false]), Some(0), "0.5 m");
        assert_eq!(query([false, true, false, false, true]), Some(1), "no spread: the first");
        assert_eq!(query([false; 5]), None);
    }

    #[test]
    fn nothing_to_exceed() {
        let answer = found(0.0, 0, 1.0);
        let found = Found { shortest_m: Some(0.0), ..answer.found.unwrap() };
        assert_eq!(found.excess(), Some(0.0));
        assert_eq!(Found { shortest_m: None, ..found }.excess(), None);
    }
}
