//! Report of a team: `keyway.team/1`.

use super::{EpisodeOutcome, EpisodeReport};
use serde::Serialize;

/// `keyway.team/1`: the runs of several robots in one world.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TeamReport {
    /// Name and version of this form.
    pub schema: &'static str,
    /// Outcome of each robot's run, in the order of the robots.
    pub outcomes: Vec<EpisodeOutcome>,
    /// Time at which the last robot reached its goal \[s\]; `None` unless all did.
    pub makespan_s: Option<f64>,
    /// Smallest distance between two footprints while at least one of the two robots was under way
    /// \[m\]; `None` for a single robot, or without any route.
    pub min_robot_clearance_m: Option<f64>,
    /// Report of each robot, as if it had driven alone.
    pub robots: Vec<EpisodeReport>,
}

impl TeamReport {
    /// Name and version of this form.
    pub const SCHEMA: &'static str = "keyway.team/1";

    pub(super) fn of(robots: Vec<EpisodeReport>, min_robot_clearance_m: Option<f64>) -> Self {
        let outcomes: Vec<EpisodeOutcome> = robots.iter().map(|robot| robot.outcome).collect();
        let have_reached = outcomes.iter().all(|&outcome| outcome == EpisodeOutcome::Reached);
        let ends_s = robots.iter().filter_map(|robot| Some(robot.run.as_ref()?.time_s));
        let makespan_s = ends_s.reduce(f64::max).filter(|_| have_reached);
        Self { schema: Self::SCHEMA, outcomes, makespan_s, min_robot_clearance_m, robots }
    }
}
