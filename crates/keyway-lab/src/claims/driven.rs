//! Runs of a stack on a robot, with their metrics.

use super::clutter_speeds::Part;
use keyway::ConfigError;
use keyway::local::LocalConfig;
use keyway::map::{Cell, OccupancyGrid};
use keyway::navigate::{NavigateError, Navigator, Stack};
use keyway::plan::PlannerConfig;
use keyway::robot::{Limits, Robot};
use keyway_sim::episode::{
    Episode, EpisodeError, EpisodeObserver, EpisodeOutcome, RandomObstacles, RobotReport, RunError,
    RunOptions, watch_episode,
};
use keyway_sim::metrics::count_run_heading_jumps;
use keyway_sim::metrics::statistics::Sample;
use keyway_sim::report::{Clock, RunPart};
use keyway_sim::sim::Run;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Setup of a run.
#[derive(Debug)]
pub struct Driving {
    /// Name of the stack.
    pub stack: &'static str,
    /// The robot, which also determines the parameters of the stack.
    pub vehicle: Vehicle,
    /// A planner in place of the stack's own.
    pub planner: Option<PlannerConfig>,
    /// A local planner in place of the stack's own.
    pub local: Option<LocalConfig>,
    /// Real obstacles that are not on the map.
    pub unknown: Option<RandomObstacles>,
    /// False for a robot that follows its first route to the end and ignores what it senses.
    pub is_watching: bool,
    /// Part of a run over which its mean speed is taken.
    pub part: Part,
}

/// A robot and the parameters of its stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vehicle {
    /// The point robot of \[You2021\], table 2, with the stack as published, for maps with cells of
    /// 1 m.
    Paper,
    /// The same with another acceleration and deceleration \[m/s²\].
    PaperWith([f64; 2]),
    /// The bundled robot `small`, with parameters for it; for maps of real rooms.
    Small,
}

/// A run on one map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunFigures {
    /// Outcome of the run.
    pub outcome: EpisodeOutcome,
    /// Simulated time \[s\].
    pub time_s: f64,
    /// Distance driven \[m\].
    pub length_m: f64,
    /// Distance over time \[m/s\]; for a part of a run, the mean speed of that part. `None` if
    /// no time passed.
    pub mean_speed_mps: Option<f64>,
    /// Standard deviation of the speeds of all cycles \[m/s\]; `None` for a single cycle.
    pub speed_deviation_mps: Option<f64>,
    /// Sum of the absolute changes of the speed from cycle to cycle, per metre \[1/s\]; `None`
    /// if nothing was driven.
    pub speed_variation_per_s: Option<f64>,
    /// Changes of the turning direction per metre \[1/m\]; `None` if nothing was driven.
    pub oscillation_per_m: Option<f64>,
    /// Smallest distance to any real obstacle \[m\]; `None` without obstacles.
    pub min_clearance_m: Option<f64>,
    /// Points at which the heading jumps: changes of more than 5 degrees within 1 cm.
    pub non_smooth_turns: usize,
    /// Mean wall-clock time of a control cycle \[s\]; `None` without a clock.
    pub cycle_s: Option<f64>,
    /// Wall-clock time of the first route and of all control cycles \[s\]; `None` without a
    /// clock.
    pub total_search_s: Option<f64>,
}

/// Observer that stores the run.
#[derive(Default)]
pub(super) struct Keeper(pub(super) Option<Run>);

impl EpisodeObserver for Keeper {
    fn ended(&mut self, run: &Run, _navigator: &Navigator) {
        self.0 = Some(run.clone());
    }
}

impl Vehicle {
    fn robot(self) -> Robot {
        match self {
            Self::Paper => Robot::paper(),
            Self::PaperWith([acceleration_mps2, deceleration_mps2]) => {
                let paper = Robot::paper();
                let limits = Limits { acceleration_mps2, deceleration_mps2, ..paper.limits };
                Robot { limits, ..paper }
            }
            Self::Small => Robot::small(),
        }
    }

    fn stack(self, name: &str) -> Option<Stack> {
        match self {
            Self::Paper | Self::PaperWith(_) => Stack::published_by_name(name),
            Self::Small => Stack::by_name(name, &Robot::small()),
        }
    }
}

impl Driving {
    /// Drives once; `None` without a route, or if the robot does not fit at its start or goal.
    ///
    /// # Errors
    /// Returns [`EpisodeError`] if the stack does not exist, or a value of the random obstacles
    /// is invalid.
    pub(super) fn run(
        &self,
        grid: &OccupancyGrid,
        task: ([Cell; 2], u64),
        clock: Clock<'_>,
    ) -> Result<Option<RunFigures>, EpisodeError> {
        let mut run = Keeper::default();
        let Some((episode, report)) = self.watch(grid, task, clock, &mut run)? else {
            return Ok(None);
        };
        let both = report.run.as_ref().zip(run.0.as_ref());
        Ok(both.map(|(part, run)| {
            RunFigures::new(&report, part, run).of_part(self.part, run, &episode)
        }))
    }

    /// Drives once with an observer; `None` if the robot does not fit at its start or goal.
    pub(super) fn watch(
        &self,
        grid: &OccupancyGrid,
        (ends, seed): ([Cell; 2], u64),
        clock: Clock<'_>,
        watcher: &mut impl EpisodeObserver,
    ) -> Result<Option<(Episode, RobotReport)>, EpisodeError> {
        let stack = self.vehicle.stack(self.stack);
        let mut stack = stack.ok_or_else(|| ConfigError::new("stack", "is not a known one"))?;
        if let Some(planner) = &self.planner {
            stack.planner = planner.clone();
        }
        if let Some(local) = &self.local {
            stack.local = local.clone();
        }
        if !self.is_watching {
            stack.controller.watch_route = false;
            stack.controller.recoveries = Cow::Borrowed(&[]);
        }
        let [start, goal] = ends.map(|cell| grid.frame().world_from_cell(cell));
        let mut episode = Episode::new(grid.clone(), self.vehicle.robot(), start, goal);
        episode.robots[0].stack = stack;
        self.stack.clone_into(&mut episode.robots[0].stack_name);
        if let Some(unknown) = &self.unknown {
            unknown.put_into(&mut episode, seed)?;
        }
        let options = RunOptions { clock, ..RunOptions::default() };
        match watch_episode(&episode, options, std::slice::from_mut(watcher)) {
            Ok(report) => Ok(Some((episode, report.first()))),
            // Without clearance at the start or goal, there is no run.
            Err(EpisodeError {
                why:
                    RunError::Navigate(
                        NavigateError::NoRoom { .. } | NavigateError::StartTouches { .. },
                    ),
                ..
            }) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

impl RunFigures {
    fn new(report: &RobotReport, part: &RunPart, run: &Run) -> Self {
        let cycle_s = part.mean_cycle_us.map(|us| us * 1e-6);
        let route_s = report.plan.time_s.map(|plan_s| {
            plan_s + report.smoothed.as_ref().and_then(|smoothed| smoothed.time_s).unwrap_or(0.0)
        });
        let speeds = run.samples.iter().map(|sample| sample.velocity.v).collect();
        Self {
            outcome: report.outcome,
            time_s: part.time_s,
            length_m: part.length_m,
            mean_speed_mps: part.mean_speed_mps,
            speed_deviation_mps: Sample::new(speeds)
                .ok()
                .and_then(|speeds| speeds.standard_deviation()),
            speed_variation_per_s: (part.length_m > 0.0)
                .then(|| part.v_variation_mps / part.length_m),
            oscillation_per_m: part.omega_sign_changes_per_m,
            min_clearance_m: part.min_clearance_m,
            non_smooth_turns: count_run_heading_jumps(run),
            cycle_s,
            total_search_s: route_s
                .zip(cycle_s)
                .map(|(route_s, cycle_s)| route_s + cycle_s * part.cycles as f64),
        }
    }

    fn of_part(self, part: Part, run: &Run, episode: &Episode) -> Self {
        let mean_speed_mps = match part {
            Part::Whole => self.mean_speed_mps,
            Part::Sparse | Part::Dense => part.mean_speed_mps(run, episode),
        };
        Self { mean_speed_mps, ..self }
    }

    /// True if the robot touched something, or something touched it.
    pub fn touched(&self) -> bool {
        self.outcome == EpisodeOutcome::Collided
    }

    /// True if the robot reached its goal.
    pub fn reached(&self) -> bool {
        self.outcome == EpisodeOutcome::Reached
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway_sim::episode::RandomUnknown;
    use std::sync::atomic::{AtomicU32, Ordering};

    const FOLLOW: Driving = Driving {
        stack: "astar-follow",
        vehicle: Vehicle::Paper,
        planner: None,
        local: None,
        unknown: None,
        is_watching: true,
        part: Part::Whole,
    };

    fn drive(driving: &Driving, rows: &[&str], clock: Clock<'_>) -> Option<RunFigures> {
        let grid = OccupancyGrid::from_ascii(rows);
        driving.run(&grid, ([Cell::new(0, 0), Cell::new(5, 0)], 1), clock).unwrap()
    }

    #[test]
    fn a_run_and_its_measures() {
        let ticks = AtomicU32::new(0);
        let clock = || f64::from(ticks.fetch_add(1, Ordering::Relaxed));
        let driven = drive(&FOLLOW, &["......", "......"], Some(&clock)).unwrap();
        assert!(driven.reached() && (4.4..5.1).contains(&driven.length_m), "{driven:?}");
        let mean_mps = driven.length_m / driven.time_s;
        assert!((driven.mean_speed_mps.unwrap() - mean_mps).abs() < 1e-12, "{driven:?}");
        assert!(driven.speed_deviation_mps > Some(0.1), "it begins and ends at rest: {driven:?}");
        // The robot accelerates to 1 m/s or less, and brakes again.
        let variation_per_s = driven.speed_variation_per_s.unwrap();
        let top_mps = 0.5 * variation_per_s * driven.length_m;
        assert!((0.5..1.01).contains(&top_mps), "{top_mps} {driven:?}");
        assert_eq!((driven.min_clearance_m, driven.oscillation_per_m), (None, Some(0.0)));
        // Every decision takes one tick; so do the search and the smoothing.
        assert!(driven.cycle_s.is_some_and(|s| (s - 1.0).abs() < 1e-9), "{driven:?}");
        let cycles = (driven.time_s / 0.1).round();
        assert!((driven.total_search_s.unwrap() - cycles - 2.0).abs() < 1.5, "{driven:?}");
        let driven = drive(&FOLLOW, &["......", "......"], None).unwrap();
        assert_eq!((driven.cycle_s, driven.total_search_s), (None, None));
    }

    /// An unknown disc blocks the only route.
    #[test]
    fn an_unwatched_robot_touches_what_it_does_not_know() {
        let unknown = RandomObstacles {
            unknown: Some(RandomUnknown { count: 1, radius_m: [0.2; 2] }),
            moving: None,
            near_way_m: 0.0,
            free_ends_m: 0.5,
        };
        let grid = OccupancyGrid::from_ascii(&["...................."; 9]);
        let outcome = |is_watching| {
            let vehicle = Vehicle::Small;
            let driving =
                Driving { vehicle, unknown: Some(unknown.clone()), is_watching, ..FOLLOW };
            driving.run(&grid, ([Cell::new(1, 4), Cell::new(18, 4)], 1), None).unwrap().unwrap()
        };
        assert!(outcome(false).touched() && !outcome(false).reached());
        assert!(!outcome(true).touched() && outcome(true).reached());
    }

    #[test]
    fn runs_that_are_none() {
        assert_eq!(drive(&FOLLOW, &["..#...", "..#..."], None), None, "no route");
        let unknown = Driving { stack: "hay", ..FOLLOW };
        let grid = OccupancyGrid::from_ascii(&["......"]);
        assert!(unknown.run(&grid, ([Cell::new(0, 0), Cell::new(5, 0)], 1), None).is_err());
    }
}
