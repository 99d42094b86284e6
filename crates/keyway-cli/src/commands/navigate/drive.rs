//! Runs an episode, and converts the errors of one that cannot be run.

use super::watch::{Moment, Wanted, Watcher};
use crate::commands::{THROUGH_UNKNOWN, end_flag, remedy};
use crate::error::{CliError, Kind};
use keyway::geometry::Disc;
use keyway::map::{BitGrid, BlockedBy, Hindrance};
use keyway::navigate::NavigateError;
use keyway::plan::PlanError;
use keyway::route::Route;
use keyway_lab::measure::wall_clock;
use keyway_sim::episode::{Episode, RobotReport, RunError, RunOptions, watch_episode};
use keyway_sim::sim::MovingObstacle;

/// Result of an episode.
pub(crate) struct Driven {
    pub(crate) report: RobotReport,
    /// Moving obstacles, as they moved in the run.
    pub(crate) movers: Vec<MovingObstacle>,
    /// `None` if there was no route.
    pub(crate) drive: Option<Drive>,
}

/// The robot's knowledge in a run, and the other requested data.
pub(crate) struct Drive {
    /// The route at the start.
    pub(crate) route: Route,
    /// Cells sensed by the end.
    pub(crate) sensed: BitGrid,
    /// A line of JSON for every cycle.
    pub(crate) explanations: String,
    /// The moment of the candidate picture; `None` if the run ended before it.
    pub(crate) fan: Option<Moment>,
    /// Obstacles that the robot detoured around.
    pub(crate) walked: Vec<Disc>,
    /// Moments of an animation.
    pub(crate) moments: Vec<Moment>,
    /// An MCAP file.
    pub(crate) recording: Option<Vec<u8>>,
}

pub(crate) fn drive(episode: &Episode, wanted: Wanted) -> Result<Driven, CliError> {
    let mut watcher = Watcher::new(wanted);
    let clock = wall_clock();
    let options = RunOptions { clock: Some(&clock), ..RunOptions::default() };
    let report = watch_episode(episode, options, std::slice::from_mut(&mut watcher));
    let mut report = report.map_err(|error| bad_input(&error.why))?.first();
    let recording = watcher.recorded().map_err(|error| CliError::new(Kind::Input, error))?;
    let Watcher { route, sensed, why, explanations, fan, film, walked, .. } = watcher;
    if why.is_some() {
        report.plan.why.clone_from(&why);
        report.reason = why;
    }
    let moments = film.moments;
    let drive = route.zip(sensed).map(|(route, sensed)| Drive {
        route,
        sensed,
        explanations,
        fan,
        walked,
        moments,
        recording,
    });
    let run = report.run.as_ref();
    let movers = run.map_or_else(|| episode.movers.clone(), |run| run.movers(&episode.movers));
    Ok(Driven { report, movers, drive })
}

pub(super) fn bad_input(error: &RunError) -> CliError {
    match error {
        RunError::Navigate(error) => no_start(error),
        RunError::World(error) => CliError::new(Kind::Input, error).field("--obstacle"),
        RunError::Config(error) => CliError::new(Kind::Config, error).field(error.path.as_str()),
        _ => CliError::new(Kind::Input, error),
    }
}

fn no_start(error: &NavigateError) -> CliError {
    let named = |field: &str| Some(field.to_owned());
    let (kind, field) = match error {
        NavigateError::Config(error) => (Kind::Config, named(&error.path)),
        NavigateError::WayPoint { .. } => (Kind::Position, named("--via")),
        NavigateError::StartTouches { .. } => (Kind::Position, named("--start")),
        NavigateError::GoalHeading { .. } => (Kind::Position, named("--goal")),
        NavigateError::NoRoom { end, .. }
        | NavigateError::NotFinite { end, .. }
        | NavigateError::Plan(
            PlanError::Blocked { end, .. }
            | PlanError::OutsideMap { end, .. }
            | PlanError::Constrained { end, .. },
        ) => (Kind::Position, named(end_flag(*end))),
        _ => (Kind::Config, None),
    };
    CliError { kind, message: error.to_string() + &help(error), field }
}

/// Remedy for a failed start. Freeing discs around start and goal would help, but is not offered
/// for robots.
fn help(error: &NavigateError) -> String {
    match error {
        NavigateError::NoRoom { why: Hindrance::Unknown { .. }, .. } => {
            format!("; {THROUGH_UNKNOWN}")
        }
        NavigateError::Plan(PlanError::Blocked {
            by: BlockedBy::Expansion { .. } | BlockedBy::Constraint { .. },
            ..
        }) => String::new(),
        NavigateError::Plan(error) => remedy(error),
        _ => String::new(),
    }
}
