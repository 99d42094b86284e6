//! The run of an episode, and what is wrong when it cannot be made.

use crate::commands::{THROUGH_UNKNOWN, end_flag, remedy, why};
use crate::error::{CliError, Kind};
use crate::measure::wall_clock;
use keyway::episode::{Episode, EpisodeError, EpisodeObserver, EpisodeReport, watch_episode};
use keyway::map::{BitGrid, BlockedBy, Hindrance};
use keyway::navigate::{Controller, NavigateError};
use keyway::plan::PlanError;
use keyway::route::Route;
use keyway::sim::Run;

/// What came of an episode.
pub(crate) struct Driven {
    pub(crate) report: EpisodeReport,
    /// `None` when there was no route to drive.
    pub(crate) drive: Option<Drive>,
}

/// What the robot knew.
pub(crate) struct Drive {
    /// The route at the start.
    pub(crate) route: Route,
    /// What it had sensed at the end.
    pub(crate) sensed: BitGrid,
}

/// Keeps what pictures show and reports do not, and what helps where there is no route.
#[derive(Default)]
struct Watcher {
    route: Option<Route>,
    sensed: Option<BitGrid>,
    why: Option<String>,
}

impl EpisodeObserver for Watcher {
    fn no_route(&mut self, error: &NavigateError) {
        if let NavigateError::Plan(error) = error {
            self.why = Some(why(error));
        }
    }

    fn started(&mut self, controller: &Controller) {
        self.route = Some(controller.route().clone());
    }

    fn ended(&mut self, _run: &Run, controller: &Controller) {
        self.sensed = Some(controller.sensed().clone());
    }
}

pub(crate) fn drive(episode: &Episode) -> Result<Driven, CliError> {
    let mut watcher = Watcher::default();
    let report = watch_episode(episode, Some(&wall_clock()), &mut watcher);
    let mut report = report.map_err(|error| bad_input(&error))?;
    let Watcher { route, sensed, why } = watcher;
    if why.is_some() {
        report.plan.why.clone_from(&why);
        report.reason = why;
    }
    let drive = route.zip(sensed).map(|(route, sensed)| Drive { route, sensed });
    Ok(Driven { report, drive })
}

fn bad_input(error: &EpisodeError) -> CliError {
    match error {
        EpisodeError::Navigate(error) => no_start(error),
        EpisodeError::World(error) => CliError::new(Kind::Input, error).field("--obstacle"),
        EpisodeError::Config(error) => {
            CliError::new(Kind::Config, error).field(error.path.as_str())
        }
        _ => CliError::new(Kind::Input, error),
    }
}

fn no_start(error: &NavigateError) -> CliError {
    let named = |field: &str| Some(field.to_owned());
    let (kind, field) = match error {
        NavigateError::Config(error) => (Kind::Config, named(&error.path)),
        NavigateError::WayPoint { .. } => (Kind::Position, named("--via")),
        NavigateError::NoRoom { end, .. }
        | NavigateError::Plan(
            PlanError::Blocked { end, .. }
            | PlanError::OutsideMap { end, .. }
            | PlanError::Constrained { end, .. },
        ) => (Kind::Position, named(end_flag(*end))),
        _ => (Kind::Config, None),
    };
    CliError { kind, message: error.to_string() + &help(error), field }
}

/// What helps; discs without clearance around the ends, which would, are not for robots.
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
