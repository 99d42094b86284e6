//! A stack as published, on the papers' robot -> a measured run.

use crate::episode::{
    Episode, EpisodeError, EpisodeObserver, EpisodeOutcome, EpisodeReport, RandomObstacles,
    watch_episode,
};
use crate::map::{Cell, OccupancyGrid};
use crate::metrics::statistics::Sample;
use crate::navigate::{Controller, NavigateError, Stack};
use crate::report::{Clock, RunPart};
use crate::robot::Robot;
use crate::sim::Run;

/// A way to drive.
#[derive(Debug)]
pub struct Driving {
    /// The stack, as published ([`Stack::published_by_name`]).
    pub stack: &'static str,
    /// What is real and not on the map.
    pub unknown: Option<RandomObstacles>,
}

/// A run on one map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driven {
    /// How it ended.
    pub outcome: EpisodeOutcome,
    /// Simulated time \[s\].
    pub time_s: f64,
    /// Distance driven \[m\].
    pub length_m: f64,
    /// Distance over time \[m/s\]; `None` where no time passed.
    pub mean_speed_mps: Option<f64>,
    /// Standard deviation of the speeds of all cycles \[m/s\]; `None` for a single one.
    pub speed_deviation_mps: Option<f64>,
    /// Changes of the turning direction per metre \[1/m\]; `None` where nothing was driven.
    pub oscillation_per_m: Option<f64>,
    /// Smallest distance to any real obstacle \[m\]; `None` without obstacles.
    pub min_clearance_m: Option<f64>,
    /// Mean wall clock of a control cycle \[s\]; `None` without a clock.
    pub cycle_s: Option<f64>,
    /// Wall clock of the first route and of all control cycles \[s\]; `None` without a clock.
    pub total_search_s: Option<f64>,
}

/// Keeps the speeds of a run.
#[derive(Default)]
struct Speeds(Vec<f64>);

impl EpisodeObserver for Speeds {
    fn ended(&mut self, run: &Run, _controller: &Controller) {
        self.0 = run.samples.iter().map(|sample| sample.velocity.v).collect();
    }
}

impl Driving {
    /// Drives once; `None` without a route, or where the robot has no room at its start.
    ///
    /// # Errors
    /// When the stack does not exist, or what is random cannot be used.
    pub(super) fn run(
        &self,
        grid: &OccupancyGrid,
        ends: [Cell; 2],
        seed: u64,
        clock: Clock<'_>,
    ) -> Result<Option<Driven>, EpisodeError> {
        let stack = Stack::published_by_name(self.stack)
            .ok_or_else(|| crate::ConfigError::new("stack", "is not a published one"))?;
        let [start, goal] = ends.map(|cell| grid.frame().world_from_cell(cell));
        let mut episode = Episode::new(grid.clone(), Robot::paper(), start, goal);
        episode.stack = stack;
        self.stack.clone_into(&mut episode.stack_name);
        if let Some(unknown) = &self.unknown {
            unknown.put_into(&mut episode, seed)?;
        }
        let mut speeds = Speeds::default();
        match watch_episode(&episode, clock, &mut speeds) {
            Ok(report) => Ok(report.run.as_ref().map(|run| Driven::new(&report, run, speeds))),
            // Without room at an end there is no run.
            Err(EpisodeError::Navigate(
                NavigateError::NoRoom { .. } | NavigateError::StartTouches { .. },
            )) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

impl Driven {
    fn new(report: &EpisodeReport, run: &RunPart, speeds: Speeds) -> Self {
        let cycle_s = run.mean_cycle_us.map(|us| us * 1e-6);
        let route_s = report.plan.time_s.map(|plan_s| {
            plan_s + report.smoothed.as_ref().and_then(|smoothed| smoothed.time_s).unwrap_or(0.0)
        });
        Self {
            outcome: report.outcome,
            time_s: run.time_s,
            length_m: run.length_m,
            mean_speed_mps: run.mean_speed_mps,
            speed_deviation_mps: Sample::new(speeds.0)
                .ok()
                .and_then(|speeds| speeds.standard_deviation()),
            oscillation_per_m: run.omega_sign_changes_per_m,
            min_clearance_m: run.min_clearance_m,
            cycle_s,
            total_search_s: route_s
                .zip(cycle_s)
                .map(|(route_s, cycle_s)| route_s + cycle_s * run.cycles as f64),
        }
    }

    /// Whether the robot arrived.
    pub fn reached(&self) -> bool {
        self.outcome == EpisodeOutcome::Reached
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell as Counter;

    const FOLLOW: Driving = Driving { stack: "astar-follow", unknown: None };

    fn drive(driving: &Driving, rows: &[&str], clock: Clock<'_>) -> Option<Driven> {
        let grid = OccupancyGrid::from_ascii(rows);
        driving.run(&grid, [Cell::new(0, 0), Cell::new(5, 0)], 1, clock).unwrap()
    }

    #[test]
    fn a_run_and_its_measures() {
        let ticks = Counter::new(0.0);
        let clock = || {
            ticks.set(ticks.get() + 1.0);
            ticks.get()
        };
        let driven = drive(&FOLLOW, &["......", "......"], Some(&clock)).unwrap();
        assert!(driven.reached() && (4.4..5.1).contains(&driven.length_m), "{driven:?}");
        let mean_mps = driven.length_m / driven.time_s;
        assert!((driven.mean_speed_mps.unwrap() - mean_mps).abs() < 1e-12, "{driven:?}");
        assert!(driven.speed_deviation_mps > Some(0.1), "it begins and ends at rest: {driven:?}");
        assert_eq!((driven.min_clearance_m, driven.oscillation_per_m), (None, Some(0.0)));
        // Every decision takes a tick; so do the search, and the smoothing.
        assert!(driven.cycle_s.is_some_and(|s| (s - 1.0).abs() < 1e-9), "{driven:?}");
        let cycles = (driven.time_s / 0.1).round();
        assert!((driven.total_search_s.unwrap() - cycles - 2.0).abs() < 1.5, "{driven:?}");
        let driven = drive(&FOLLOW, &["......", "......"], None).unwrap();
        assert_eq!((driven.cycle_s, driven.total_search_s), (None, None));
    }

    #[test]
    fn runs_that_are_none() {
        assert_eq!(drive(&FOLLOW, &["..#...", "..#..."], None), None, "no route");
        let unknown = Driving { stack: "hay", unknown: None };
        let grid = OccupancyGrid::from_ascii(&["......"]);
        assert!(unknown.run(&grid, [Cell::new(0, 0), Cell::new(5, 0)], 1, None).is_err());
    }
}
