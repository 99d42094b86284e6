//! Aggregation of answers to a row of the table.

use super::mistakes::Got;
use crate::measure::{Spread, Times, mean, quantile};
use serde::Serialize;
use std::time::Duration;

/// Tolerance of published lengths, which have few digits \[cells\].
const TOLERANCE_CELLS: f64 = 0.01;

/// One row of `keyway.bench.grid/1`, whose members docs/reference/json.md explains.
#[derive(Clone, Debug, Serialize)]
pub struct GridRow {
    pub(crate) map: String,
    pub(crate) planner: &'static str,
    pub(crate) queries: usize,
    pub(crate) solved: usize,
    pub(crate) mismatches: usize,
    pub(crate) illegal_paths: usize,
    /// Queries for which the planner reports that it missed an existing path.
    pub(crate) missed: usize,
    pub(crate) mean_us: Option<f64>,
    pub(crate) median_us: Option<f64>,
    pub(crate) p99_us: Option<f64>,
    pub(crate) mean_cpu_us: Option<f64>,
    pub(crate) p5_cpu_us: Option<f64>,
    pub(crate) p95_cpu_us: Option<f64>,
    pub(crate) mean_expanded: Option<f64>,
    pub(crate) p5_expanded: Option<f64>,
    pub(crate) p95_expanded: Option<f64>,
    pub(crate) mean_generated: Option<f64>,
    pub(crate) mean_excess: Option<f64>,
    pub(crate) p5_excess: Option<f64>,
    pub(crate) p95_excess: Option<f64>,
    pub(crate) preprocessing_ms: f64,
    pub(crate) memory_bytes: usize,
}

/// Answer of a planner to one query.
pub struct GridAnswer {
    pub(super) times: Times,
    pub(super) expanded: u64,
    pub(super) generated: u64,
    pub(super) path: PathFound,
    /// Published length of the best path \[cells\]; `None` if no path exists.
    pub(super) optimum: Option<f64>,
    /// Lower bound of this planner's path lengths \[cells\]: the optimum, unless the planner has
    /// other moves than those for which it was published.
    pub(super) least: f64,
}

/// A path, with the result of its check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PathFound {
    None,
    Missed,
    Illegal,
    Legal { length_cells: f64 },
}

impl GridAnswer {
    /// True if the answer contradicts the published one. An illegal path is counted separately,
    /// but still claims that a path exists; so does a planner that reports that it missed one.
    fn is_mismatch(&self, is_optimal: bool) -> bool {
        match (self.path, self.optimum) {
            (PathFound::None, None) | (PathFound::Illegal | PathFound::Missed, Some(_)) => false,
            (PathFound::None, Some(_)) | (_, None) => true,
            (PathFound::Legal { length_cells }, Some(optimum)) => {
                let is_longer = length_cells > optimum + TOLERANCE_CELLS;
                length_cells < self.least - TOLERANCE_CELLS || (is_optimal && is_longer)
            }
        }
    }

    /// Returns the error of the answer, compared with the published length; `None` if it is
    /// right.
    pub(super) fn mistake(&self, is_optimal: bool) -> Option<(Option<f64>, Got)> {
        let got = match self.path {
            PathFound::Illegal => Got::IllegalPath,
            _ if !self.is_mismatch(is_optimal) => return None,
            PathFound::None => Got::NoPath,
            PathFound::Missed => Got::Missed,
            PathFound::Legal { .. } => Got::Path,
        };
        Some((self.optimum, got))
    }

    /// Length of a legal path.
    pub(super) const fn length_cells(&self) -> Option<f64> {
        match self.path {
            PathFound::Legal { length_cells } => Some(length_cells),
            _ => None,
        }
    }

    /// Relative excess of the path's length over the best one.
    fn excess(&self) -> Option<f64> {
        match (self.path, self.optimum) {
            (PathFound::Legal { length_cells }, Some(optimum)) if optimum > 0.0 => {
                Some(length_cells / optimum - 1.0)
            }
            _ => None,
        }
    }
}

/// Counts and means; values that are not part of answers are arguments.
pub(super) fn row(
    map: String,
    planner: &'static str,
    is_optimal: bool,
    answers: &[GridAnswer],
    (preprocessing, memory_bytes): (Duration, usize),
) -> GridRow {
    let walls: Vec<f64> = answers.iter().map(|answer| answer.times.wall_us()).collect();
    let cpus: Option<Vec<f64>> = answers.iter().map(|answer| answer.times.cpu_us()).collect();
    let excesses: Vec<f64> = answers.iter().filter_map(GridAnswer::excess).collect();
    let count = |test: &dyn Fn(&GridAnswer) -> bool| answers.iter().filter(|a| test(a)).count();
    let of_all = |value: &dyn Fn(&GridAnswer) -> u64| {
        Spread::of_values(answers.iter().map(|answer| value(answer) as f64).collect())
    };
    let cpu_us = cpus.map(Spread::of_values).unwrap_or_default();
    let (expanded, excess) = (of_all(&|answer| answer.expanded), Spread::of_values(excesses));
    GridRow {
        map,
        planner,
        queries: answers.len(),
        solved: count(&|answer| !matches!(answer.path, PathFound::None | PathFound::Missed)),
        mismatches: count(&|answer| answer.is_mismatch(is_optimal)),
        illegal_paths: count(&|answer| answer.path == PathFound::Illegal),
        missed: count(&|answer| answer.path == PathFound::Missed),
        mean_us: mean(&walls),
        median_us: quantile(walls.clone(), 0.5),
        p99_us: quantile(walls, 0.99),
        mean_cpu_us: cpu_us.mean,
        p5_cpu_us: cpu_us.p5,
        p95_cpu_us: cpu_us.p95,
        mean_expanded: expanded.mean,
        p5_expanded: expanded.p5,
        p95_expanded: expanded.p95,
        mean_generated: of_all(&|answer| answer.generated).mean,
        mean_excess: excess.mean,
        p5_excess: excess.p5,
        p95_excess: excess.p95,
        preprocessing_ms: preprocessing.as_secs_f64() * 1e3,
        memory_bytes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(path: PathFound, optimum: Option<f64>) -> GridAnswer {
        let times = Times { wall: Duration::from_micros(5), cpu: None };
        let least = optimum.unwrap_or_default();
        GridAnswer { times, expanded: 3, generated: 4, path, optimum, least }
    }

    fn legal(length_cells: f64) -> PathFound {
        PathFound::Legal { length_cells }
    }

    #[test]
    fn mismatches() {
        for (path, optimum, optimal, suboptimal) in [
            (legal(5.004), Some(5.0), false, false),
            (legal(5.02), Some(5.0), true, false),
            (legal(4.98), Some(5.0), true, true),
            (legal(5.0), None, true, true),
            (PathFound::None, None, false, false),
            (PathFound::None, Some(0.0), true, true),
            (PathFound::Illegal, Some(5.0), false, false),
            (PathFound::Illegal, None, true, true),
            (PathFound::Missed, Some(5.0), false, false),
            (PathFound::Missed, None, true, true),
        ] {
            let answer = answer(path, optimum);
            assert_eq!(answer.is_mismatch(true), optimal, "{path:?} {optimum:?}");
            assert_eq!(answer.is_mismatch(false), suboptimal, "{path:?} {optimum:?}");
        }
    }

    #[test]
    fn mistakes_say_what_was_got() {
        for (path, optimum, mistake) in [
            (legal(5.02), Some(5.0), Some((Some(5.0), Got::Path))),
            (legal(5.0), Some(5.0), None),
            (legal(5.0), None, Some((None, Got::Path))),
            (PathFound::None, Some(5.0), Some((Some(5.0), Got::NoPath))),
            (PathFound::Missed, None, Some((None, Got::Missed))),
            (PathFound::Missed, Some(5.0), None),
            // No mismatch, but counted as an illegal path.
            (PathFound::Illegal, Some(5.0), Some((Some(5.0), Got::IllegalPath))),
        ] {
            assert_eq!(answer(path, optimum).mistake(true), mistake, "{path:?} {optimum:?}");
        }
    }

    #[test]
    fn any_angle_paths_may_be_shorter() {
        let answer = GridAnswer { least: 4.5, ..answer(legal(4.6), Some(5.0)) };
        assert!(!answer.is_mismatch(false));
        let impossible = GridAnswer { path: legal(4.4), ..answer };
        assert!(impossible.is_mismatch(false));
    }

    #[test]
    fn a_row_by_hand() {
        let slow = Times { wall: Duration::from_micros(8), cpu: None };
        let answers = [
            GridAnswer { times: slow, ..answer(legal(11.0), Some(10.0)) },
            answer(legal(10.0), Some(10.0)),
            answer(PathFound::None, None),
            answer(PathFound::Illegal, Some(3.0)),
        ];
        let row = row("m".to_owned(), "p", false, &answers, (Duration::from_millis(2), 7));
        assert_eq!((row.queries, row.solved, row.mismatches, row.illegal_paths), (4, 3, 0, 1));
        assert!((row.mean_excess.unwrap() - 0.05).abs() < 1e-12);
        // Excesses of 0 and 0.1: 5 and 95 % between them.
        assert!((row.p5_excess.unwrap() - 0.005).abs() < 1e-12, "{row:?}");
        assert!((row.p95_excess.unwrap() - 0.095).abs() < 1e-12, "{row:?}");
        // 5, 5, 5, 8 us: the quantile of 0.99 lies at position 2.97.
        assert_eq!((row.mean_us, row.median_us), (Some(5.75), Some(5.0)));
        assert!((row.p99_us.unwrap() - 7.91).abs() < 1e-9, "{row:?}");
        assert_eq!((row.mean_expanded, row.mean_generated), (Some(3.0), Some(4.0)));
        assert_eq!(
            (row.p5_expanded, row.p95_expanded, row.p5_cpu_us),
            (Some(3.0), Some(3.0), None)
        );
        assert_eq!((row.mean_cpu_us, row.preprocessing_ms, row.memory_bytes), (None, 2.0, 7));
    }
}
