//! Wins and losses of the first stack against each other one, run by run and measure by measure.

use super::record::Record;
use super::row::Row;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Comparison of the first stack with another one by a measure, over the runs of the same scene
/// and seed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Wins {
    /// Name of the first stack.
    pub first: String,
    /// Name of the other stack.
    pub stack: String,
    /// The measure.
    pub measure: RunMeasure,
    /// Number of runs in which the first stack is better.
    pub better: usize,
    /// Number of runs in which both are equal, up to [`RunMeasure::SAME_SHARE`].
    pub equal: usize,
    /// Number of runs in which the first stack is worse.
    pub worse: usize,
    /// Runs in which the first stack is better.
    pub better_in: Vec<ComparedRun>,
    /// Runs in which the first stack is worse.
    pub worse_in: Vec<ComparedRun>,
}

/// A run of the first stack, and that of another one in the same scene with the same seed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparedRun {
    /// Name of the scene.
    pub scene: String,
    /// Seed of the runs.
    pub seed: u64,
    /// Value of the first stack.
    pub of_first: f64,
    /// Value of the other stack.
    pub of_stack: f64,
}

/// A measure by which runs are compared, named after the field of a row. None is a wall-clock
/// time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RunMeasure {
    /// 1 if the run reached the goal, otherwise 0. It is compared for all runs, the other measures
    /// for those in which both stacks reached the goal.
    Reached,
    /// Simulated time \[s\].
    TimeS,
    /// Length of the driven path \[m\].
    LengthM,
    /// Least clearance from any obstacle \[m\]; more is better.
    MinClearanceM,
    /// Smoothness of the path \[m²\]; less is better.
    #[serde(rename = "path_smoothness_m2")]
    PathSmoothnessM2,
    /// Smoothness of the velocity \[m/s²\]; less is better.
    #[serde(rename = "velocity_smoothness_mps2")]
    VelocitySmoothnessMps2,
}

/// Result of a comparison, for the first stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Verdict {
    Better,
    Equal,
    Worse,
}

/// A line of `wins.csv`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct WinsLine<'a> {
    first: &'a str,
    pub(super) stack: &'a str,
    pub(super) measure: RunMeasure,
    pub(super) scene: &'a str,
    pub(super) seed: u64,
    of_first: f64,
    pub(super) of_stack: f64,
    pub(super) first_is: Verdict,
}

impl RunMeasure {
    /// All measures, in the order of tables.
    pub const ALL: [Self; 6] = [
        Self::Reached,
        Self::TimeS,
        Self::LengthM,
        Self::MinClearanceM,
        Self::PathSmoothnessM2,
        Self::VelocitySmoothnessMps2,
    ];

    /// Values that differ by less than this share of the larger one are equal.
    pub const SAME_SHARE: f64 = 0.01;

    /// Name of its column.
    pub(super) const fn short_name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::TimeS => "time",
            Self::LengthM => "length",
            Self::MinClearanceM => "clearance",
            Self::PathSmoothnessM2 => "path",
            Self::VelocitySmoothnessMps2 => "speed",
        }
    }

    /// Number of decimals in which its values are shown.
    pub(super) const fn decimals(self) -> usize {
        match self {
            Self::Reached => 0,
            Self::TimeS | Self::LengthM => 1,
            Self::MinClearanceM => 2,
            Self::VelocitySmoothnessMps2 => 3,
            Self::PathSmoothnessM2 => 4,
        }
    }

    pub(super) const fn is_more_better(self) -> bool {
        matches!(self, Self::Reached | Self::MinClearanceM)
    }

    /// Returns the value of a run; `None` if it has none.
    pub(super) fn of(self, run: &Row) -> Option<f64> {
        let has_reached = run.has_reached();
        let value = match self {
            Self::Reached => return Some(f64::from(u8::from(has_reached))),
            Self::TimeS => run.time_s,
            Self::LengthM => run.length_m,
            Self::MinClearanceM => run.min_clearance_m,
            Self::PathSmoothnessM2 => run.path_smoothness_m2,
            Self::VelocitySmoothnessMps2 => run.velocity_smoothness_mps2,
        };
        value.filter(|_| has_reached)
    }

    /// Compares a value of the first stack with one of another stack.
    pub(super) fn verdict(self, first: f64, other: f64) -> Verdict {
        if (first - other).abs() <= Self::SAME_SHARE * first.abs().max(other.abs()) {
            return Verdict::Equal;
        }
        if (first > other) == self.is_more_better() { Verdict::Better } else { Verdict::Worse }
    }
}

/// Runs by scene and seed.
type ByScene<'a> = HashMap<(&'a str, u64), &'a Row>;

fn runs_of<'a>(records: &'a [Record], stack: &str) -> impl Iterator<Item = &'a Row> {
    records.iter().map(|record| &record.run).filter(move |run| run.stack == stack)
}

/// Compares the first stack with all other ones: stack by stack, then measure by measure, then
/// run by run.
fn lines<'a>(records: &'a [Record], stacks: &'a [String]) -> Vec<WinsLine<'a>> {
    let Some((first, others)) = stacks.split_first() else { return Vec::new() };
    let firsts: ByScene<'_> =
        runs_of(records, first).map(|run| ((run.scene.as_str(), run.seed), run)).collect();
    let compared = |stack: &'a String, measure: RunMeasure| {
        let line = |run: &'a Row| {
            let with = firsts.get(&(run.scene.as_str(), run.seed))?;
            let (of_first, of_stack) = (measure.of(with)?, measure.of(run)?);
            let first_is = measure.verdict(of_first, of_stack);
            let (scene, seed) = (run.scene.as_str(), run.seed);
            Some(WinsLine { first, stack, measure, scene, seed, of_first, of_stack, first_is })
        };
        runs_of(records, stack).filter_map(line).collect::<Vec<_>>()
    };
    let all = others.iter().flat_map(|stack| RunMeasure::ALL.map(|measure| (stack, measure)));
    all.flat_map(|(stack, measure)| compared(stack, measure)).collect()
}

/// Comparison of the first stack with all other ones.
pub(super) struct Contest<'a> {
    /// Comparisons of single runs.
    pub(super) lines: Vec<WinsLine<'a>>,
    /// Totals, stack by stack, then measure by measure.
    pub(super) wins: Vec<Wins>,
}

impl<'a> Contest<'a> {
    /// Compares the first of `stacks` with the others, in their order; stacks without a run in
    /// common with it are left out.
    pub(super) fn of(records: &'a [Record], stacks: &'a [String]) -> Self {
        let lines = lines(records, stacks);
        let of = |(first, stack, measure): (&String, &String, RunMeasure)| {
            let own = lines.iter().filter(|line| line.stack == stack && line.measure == measure);
            Wins::of(first, stack, measure, &own.collect::<Vec<_>>())
        };
        let Some((first, others)) = stacks.split_first() else {
            return Self { lines, wins: Vec::new() };
        };
        let meets = |stack: &&String| lines.iter().any(|line| line.stack == *stack);
        let others = others.iter().filter(meets);
        let pairs = others.flat_map(|stack| RunMeasure::ALL.map(|it| (first, stack, it)));
        let wins = pairs.map(of).collect();
        Self { lines, wins }
    }
}

impl Wins {
    fn of(first: &str, stack: &str, measure: RunMeasure, lines: &[&WinsLine<'_>]) -> Self {
        let of = |verdict: Verdict| -> Vec<ComparedRun> {
            let own = lines.iter().filter(|line| line.first_is == verdict);
            own.map(|line| ComparedRun::of(line)).collect()
        };
        let (better_in, worse_in) = (of(Verdict::Better), of(Verdict::Worse));
        let (better, worse) = (better_in.len(), worse_in.len());
        Self {
            first: first.to_owned(),
            stack: stack.to_owned(),
            measure,
            better,
            equal: lines.len() - better - worse,
            worse,
            better_in,
            worse_in,
        }
    }
}

impl ComparedRun {
    fn of(line: &WinsLine<'_>) -> Self {
        let &WinsLine { scene, seed, of_first, of_stack, .. } = line;
        Self { scene: scene.to_owned(), seed, of_first, of_stack }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::batch::RunTimes;
    use crate::batch::row::tests::reached;
    use keyway_sim::episode::EpisodeOutcome;

    /// A run of a stack with this time, or one that did not reach its goal.
    pub(in crate::batch) fn record(scene: &str, stack: &str, time_s: Option<f64>) -> Record {
        let outcome = time_s.map_or(EpisodeOutcome::Stuck, |_| EpisodeOutcome::Reached);
        let (scene, stack, robot) = (scene.to_owned(), stack.to_owned(), None);
        let run = Row { scene, stack, robot, outcome, time_s, ..reached(0) };
        let measured = RunTimes { wall_s: 1.0, mean_cycle_us: Some(50.0) };
        Record { run, robots: Vec::new(), measured }
    }

    /// Four scenes with two stacks: the first one is faster, slower, stuck, and as fast.
    pub(in crate::batch) fn records() -> Vec<Record> {
        let times = [
            ("fast", Some(10.0), Some(20.0)),
            ("slow", Some(10.2), Some(10.0)),
            ("stuck", None, Some(5.0)),
            ("same", Some(10.09), Some(10.0)),
        ];
        let both = times.map(|(scene, first, other)| {
            [record(scene, "mine", first), record(scene, "theirs", other)]
        });
        both.into_iter().flatten().collect()
    }

    pub(in crate::batch) fn stacks() -> [String; 2] {
        ["mine".to_owned(), "theirs".to_owned()]
    }

    #[test]
    fn wins_by_hand() {
        let (records, stacks) = (records(), stacks());
        let Contest { lines, wins } = Contest::of(&records, &stacks);
        let counts = |measure: RunMeasure| {
            let of = wins.iter().find(|one| one.measure == measure).unwrap();
            (of.better, of.equal, of.worse)
        };
        assert_eq!(counts(RunMeasure::Reached), (0, 3, 1));
        assert_eq!(counts(RunMeasure::TimeS), (1, 1, 1));
        assert_eq!(counts(RunMeasure::LengthM), (0, 3, 0));
        // The rows have no such value.
        assert_eq!(counts(RunMeasure::VelocitySmoothnessMps2), (0, 0, 0));
        let time = &wins[1];
        assert_eq!((time.stack.as_str(), time.worse_in[0].scene.as_str()), ("theirs", "slow"));
        assert_eq!((time.worse_in[0].of_first, time.worse_in[0].of_stack), (10.2, 10.0));
        assert_eq!(lines.len(), 4 + 3 * 3);
        assert!(Contest::of(&records, &stacks[..1]).wins.is_empty());
    }

    #[test]
    fn more_room_is_better_and_more_of_anything_else_is_worse() {
        for measure in RunMeasure::ALL {
            let is_more_better = matches!(measure, RunMeasure::Reached | RunMeasure::MinClearanceM);
            let expected = if is_more_better { Verdict::Better } else { Verdict::Worse };
            assert_eq!(measure.verdict(1.0, 0.5), expected, "{measure:?}");
        }
        assert_eq!(RunMeasure::TimeS.verdict(100.0, 101.0), Verdict::Equal);
        assert_eq!(RunMeasure::TimeS.verdict(100.0, 101.1), Verdict::Better);
        assert_eq!(RunMeasure::MinClearanceM.verdict(0.0, 0.0), Verdict::Equal);
    }
}
