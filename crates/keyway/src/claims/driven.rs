//! A stack as published, on the papers' robot -> a measured run.

use crate::episode::{Episode, EpisodeError, EpisodeObserver, EpisodeOutcome, EpisodeReport};
use crate::episode::{RandomObstacles, RandomUnknown, watch_episode};
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
    /// How many discs stand anywhere that are not on the map, each as wide as a cell.
    pub unknown: u32,
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

/// Radius of a disc that is as wide as a cell of the papers' maps \[m\].
const RADIUS_M: f64 = 0.5;
/// No disc stands nearer to the start or the goal than this \[m\].
const FREE_ENDS_M: f64 = 2.0;

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
        if self.unknown > 0 {
            let far_m = f64::from(grid.frame().width() + grid.frame().height());
            let random = RandomObstacles {
                // Anywhere on the map.
                near_way_m: far_m * grid.frame().resolution_m(),
                free_ends_m: FREE_ENDS_M,
                unknown: Some(RandomUnknown { count: self.unknown, radius_m: [RADIUS_M; 2] }),
                moving: None,
            };
            random.put_into(&mut episode, seed)?;
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
