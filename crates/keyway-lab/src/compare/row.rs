//! Rows of the table, from the answers.

use super::contest::{Answer, Entry, Found};
use crate::measure::{Spread, mean, quantile};
use keyway::search::CornerRule;
use keyway_sim::metrics::PathMetrics;
use keyway_sim::metrics::statistics::{Confidence, Rate, Sample};
use keyway_sim::report::PlanOutcome;
use serde::Serialize;

/// Lengths that differ by less are equal \[m\].
pub(super) const SAME_M: f64 = 1e-6;
/// Seed of the resamples for the intervals.
const SEED: u64 = 0;

/// One row of `keyway.compare/1`, whose members docs/JSON.md explains.
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
    pub(super) mean_length_m: Option<f64>,
    pub(super) sd_length_m: Option<f64>,
    pub(super) ci_low_length_m: Option<f64>,
    pub(super) ci_high_length_m: Option<f64>,
    pub(super) p5_length_m: Option<f64>,
    pub(super) p95_length_m: Option<f64>,
    pub(super) mean_excess: Option<f64>,
    pub(super) sd_excess: Option<f64>,
    pub(super) ci_low_excess: Option<f64>,
    pub(super) ci_high_excess: Option<f64>,
    pub(super) p5_excess: Option<f64>,
    pub(super) p95_excess: Option<f64>,
    pub(super) max_excess: Option<f64>,
    pub(super) mean_turns: Option<f64>,
    pub(super) sd_turns: Option<f64>,
    pub(super) ci_low_turns: Option<f64>,
    pub(super) ci_high_turns: Option<f64>,
    pub(super) p5_turns: Option<f64>,
    pub(super) p95_turns: Option<f64>,
    pub(super) mean_turning_angle_deg: Option<f64>,
    pub(super) sd_turning_angle_deg: Option<f64>,
    pub(super) ci_low_turning_angle_deg: Option<f64>,
    pub(super) ci_high_turning_angle_deg: Option<f64>,
    pub(super) p5_turning_angle_deg: Option<f64>,
    pub(super) p95_turning_angle_deg: Option<f64>,
    pub(super) mean_non_smooth_turns: Option<f64>,
    pub(super) sd_non_smooth_turns: Option<f64>,
    pub(super) ci_low_non_smooth_turns: Option<f64>,
    pub(super) ci_high_non_smooth_turns: Option<f64>,
    pub(super) p5_non_smooth_turns: Option<f64>,
    pub(super) p95_non_smooth_turns: Option<f64>,
    pub(super) mean_clearance_m: Option<f64>,
    pub(super) sd_clearance_m: Option<f64>,
    pub(super) ci_low_clearance_m: Option<f64>,
    pub(super) ci_high_clearance_m: Option<f64>,
    pub(super) p5_clearance_m: Option<f64>,
    pub(super) p95_clearance_m: Option<f64>,
    pub(super) min_clearance_m: Option<f64>,
    pub(super) shortfalls: usize,
    pub(super) median_plan_us: Option<f64>,
    pub(super) mean_plan_cpu_us: Option<f64>,
    pub(super) median_smooth_us: Option<f64>,
    pub(super) mean_smooth_cpu_us: Option<f64>,
    pub(super) preparation_ms: Option<f64>,
}

/// Summary of the values of a column.
#[derive(Clone, Copy, Debug, Default)]
struct Figures {
    mean: Option<f64>,
    /// Standard deviation.
    sd: Option<f64>,
    /// 95 % confidence interval of the true mean.
    ci_low: Option<f64>,
    ci_high: Option<f64>,
    p5: Option<f64>,
    p95: Option<f64>,
}

impl Figures {
    fn of(values: Vec<f64>) -> Self {
        let Ok(sample) = Sample::new(values) else { return Self::default() };
        let Spread { mean, p5, p95 } = Spread::of(&sample);
        let interval = sample.mean_interval(Confidence::USUAL, SEED);
        let [ci_low, ci_high] = [interval.map(|ends| ends.low), interval.map(|ends| ends.high)];
        Self { mean, sd: sample.standard_deviation(), ci_low, ci_high, p5, p95 }
    }
}

/// For each query, whether it is compared: solved by every planner that solved any query.
pub(super) fn compared(entries: &[Entry]) -> Vec<bool> {
    let queries = entries.first().map_or(0, |entry| entry.answers.len());
    let solved = |entry: &Entry, query: usize| entry.answers[query].found.is_some();
    let has_solved = |entry: &&Entry| (0..queries).any(|query| solved(entry, query));
    let able: Vec<&Entry> = entries.iter().filter(has_solved).collect();
    let by_all = |query| !able.is_empty() && able.iter().all(|entry| solved(entry, query));
    (0..queries).map(by_all).collect()
}

/// Returns the compared query whose paths differ most in length (ties: the first).
pub(super) fn most_different(entries: &[Entry], compared: &[bool]) -> Option<usize> {
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

/// Counts over all queries, and means over the compared ones.
pub(super) fn row(map: &str, entry: &Entry, compared: &[bool]) -> CompareRow {
    // If a planner solved nothing, the others were compared without it.
    let is_found =
        |(answer, is_compared): &(&Answer, &bool)| **is_compared && answer.found.is_some();
    let compared = entry.answers.iter().zip(compared).filter(is_found);
    let answers: Vec<&Answer> = compared.map(|(answer, _)| answer).collect();
    let found: Vec<&Found> = answers.iter().filter_map(|answer| answer.found.as_ref()).collect();
    let of_found = |value: &dyn Fn(&Found) -> Option<f64>| -> Vec<f64> {
        found.iter().filter_map(|found| value(found)).collect()
    };
    let metric =
        |value: fn(&PathMetrics) -> f64| Figures::of(of_found(&|f| Some(value(&f.metrics))));
    let length_m = metric(|metrics| metrics.length_m);
    let turns = metric(|metrics| metrics.turns as f64);
    let turning_angle_deg = metric(|metrics| metrics.turning_angle_deg);
    let non_smooth_turns = metric(|metrics| metrics.non_smooth_turns as f64);
    let excesses = of_found(&Found::excess);
    let max_excess = excesses.iter().copied().max_by(f64::total_cmp);
    let excess = Figures::of(excesses);
    let clearances = of_found(&|found| found.metrics.min_clearance_m);
    let min_clearance_m = clearances.iter().copied().min_by(f64::total_cmp);
    let clearance_m = Figures::of(clearances);
    let plan_us = answers.iter().filter_map(|answer| Some(answer.plan?.wall_us())).collect();
    let plan_cpu_us: Option<Vec<f64>> = answers.iter().map(|a| a.plan?.cpu_us()).collect();
    let smooth_cpu_us: Option<Vec<f64>> = found.iter().map(|f| f.smooth?.cpu_us()).collect();
    let count = |is: fn(&Answer) -> bool| entry.answers.iter().filter(|one| is(one)).count();
    let (solved, missed) =
        (count(|one| one.found.is_some()), count(|one| one.outcome == PlanOutcome::Missed));
    let solved_share = Rate::of(entry.answers.iter().map(|one| one.found.is_some()));
    let solved_share = solved_share.interval(Confidence::USUAL);
    CompareRow {
        map: map.to_owned(),
        planner: entry.planner,
        smoother: entry.smoother,
        corners: entry.corners,
        queries: entry.answers.len(),
        solved,
        ci_low_solved: solved_share.map(|interval| interval.low),
        ci_high_solved: solved_share.map(|interval| interval.high),
        missed,
        without_path: entry.answers.len() - solved - missed,
        compared: found.len(),
        mean_length_m: length_m.mean,
        sd_length_m: length_m.sd,
        ci_low_length_m: length_m.ci_low,
        ci_high_length_m: length_m.ci_high,
        p5_length_m: length_m.p5,
        p95_length_m: length_m.p95,
        mean_excess: excess.mean,
        sd_excess: excess.sd,
        ci_low_excess: excess.ci_low,
        ci_high_excess: excess.ci_high,
        p5_excess: excess.p5,
        p95_excess: excess.p95,
        max_excess,
        mean_turns: turns.mean,
        sd_turns: turns.sd,
        ci_low_turns: turns.ci_low,
        ci_high_turns: turns.ci_high,
        p5_turns: turns.p5,
        p95_turns: turns.p95,
        mean_turning_angle_deg: turning_angle_deg.mean,
        sd_turning_angle_deg: turning_angle_deg.sd,
        ci_low_turning_angle_deg: turning_angle_deg.ci_low,
        ci_high_turning_angle_deg: turning_angle_deg.ci_high,
        p5_turning_angle_deg: turning_angle_deg.p5,
        p95_turning_angle_deg: turning_angle_deg.p95,
        mean_non_smooth_turns: non_smooth_turns.mean,
        sd_non_smooth_turns: non_smooth_turns.sd,
        ci_low_non_smooth_turns: non_smooth_turns.ci_low,
        ci_high_non_smooth_turns: non_smooth_turns.ci_high,
        p5_non_smooth_turns: non_smooth_turns.p5,
        p95_non_smooth_turns: non_smooth_turns.p95,
        mean_clearance_m: clearance_m.mean,
        sd_clearance_m: clearance_m.sd,
        ci_low_clearance_m: clearance_m.ci_low,
        ci_high_clearance_m: clearance_m.ci_high,
        p5_clearance_m: clearance_m.p5,
        p95_clearance_m: clearance_m.p95,
        min_clearance_m,
        shortfalls: found.iter().filter(|found| found.done.shortfall_m.is_some()).count(),
        median_plan_us: quantile(plan_us, 0.5),
        mean_plan_cpu_us: plan_cpu_us.and_then(|all| mean(&all)),
        median_smooth_us: quantile(of_found(&|found| Some(found.smooth?.wall_us())), 0.5),
        mean_smooth_cpu_us: smooth_cpu_us.and_then(|all| mean(&all)),
        preparation_ms: entry.preparation.map(|times| times.wall_us() / 1e3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Times;
    use keyway::smooth::Smoothed;
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
        let done = Smoothed { shortfall_m: Some(0.1), ..Smoothed::default() };
        let found = Found { smooth: Some(micros(7)), done, metrics, shortest_m: Some(10.0) };
        let plan = Some(micros(turns as u64));
        Answer { outcome: PlanOutcome::Found, reason: None, plan, note: None, found: Some(found) }
    }

    fn without(outcome: PlanOutcome) -> Answer {
        Answer { outcome, reason: None, plan: Some(micros(100)), note: None, found: None }
    }

    fn entry(answers: Vec<Answer>) -> Entry {
        let corners = CornerRule::Forbid;
        Entry { planner: "p", smoother: "s", corners, preparation: Some(micros(2000)), answers }
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
        let row_of = |i: usize| row("m", &entries[i], &compared);
        let row = row_of(0);
        assert_eq!((row.queries, row.solved, row.missed), (4, 3, 0));
        assert_eq!((row.without_path, row.compared, row.shortfalls), (1, 2, 2));
        assert_eq!((row.mean_length_m, row.mean_turns), (Some(10.5), Some(4.0)));
        // 10 and 11: 5 and 95 % of the way between them.
        let near = |value: Option<f64>, expected: f64| (value.unwrap() - expected).abs() < 1e-12;
        assert!(near(row.p5_length_m, 10.05) && near(row.p95_length_m, 10.95), "{row:?}");
        assert!((row.sd_length_m.unwrap() - 0.5f64.sqrt()).abs() < 1e-12, "{row:?}");
        // From two values nothing else can be drawn; from equal ones there is nothing else at all.
        assert_eq!((row.ci_low_length_m, row.ci_high_length_m), (Some(10.0), Some(11.0)));
        assert_eq!(
            (row.sd_turning_angle_deg, row.ci_high_turning_angle_deg),
            (Some(0.0), Some(45.0))
        );
        // Wilson's interval of 3 of 4.
        let ends = [row.ci_low_solved, row.ci_high_solved].map(|end| (end.unwrap() * 1e4).round());
        assert_eq!(ends, [3006.0, 9544.0]);
        assert!(near(row.p5_turns, 2.2) && near(row.p95_turns, 5.8), "{row:?}");
        assert!(near(row.p5_clearance_m, 0.2625) && near(row.p95_clearance_m, 0.4875), "{row:?}");
        assert!((row.mean_excess.unwrap() - 0.05).abs() < 1e-12);
        assert!(near(row.p5_excess, 0.005) && near(row.p95_excess, 0.095), "{row:?}");
        assert!((row.max_excess.unwrap() - 0.1).abs() < 1e-12);
        assert_eq!((row.mean_clearance_m, row.min_clearance_m), (Some(0.375), Some(0.25)));
        assert_eq!((row.median_plan_us, row.mean_plan_cpu_us), (Some(4.0), None));
        assert_eq!((row.median_smooth_us, row.preparation_ms), (Some(7.0), Some(2.0)));
        let row = row_of(2);
        assert_eq!((row.solved, row.missed, row.compared), (0, 4, 0));
        assert_eq!(
            (row.mean_length_m, row.min_clearance_m, row.median_plan_us),
            (None, None, None)
        );
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
