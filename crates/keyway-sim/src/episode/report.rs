//! Reports of an episode: `keyway.team/1`, and of each robot: `keyway.navigate/4`.

use crate::report::{Inputs, PlanPart, RunPart, SmoothedPart};
use keyway::geometry::Point;
use keyway::navigate::Misfit;
use serde::{Deserialize, Serialize};

/// `keyway.navigate/4`: the run of a robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotReport {
    /// Name and version of this format.
    pub schema: &'static str,
    /// Outcome of the episode.
    pub outcome: EpisodeOutcome,
    /// Reason why the goal was not reached, for human readers.
    pub reason: Option<String>,
    /// The first route as planned, or the reason why there is none.
    pub plan: PlanPart,
    /// The first route, smoothed; `None` without a route, here and below.
    pub smoothed: Option<SmoothedPart>,
    /// The points to which the guide directs the robot along the first route \[m\].
    pub key_points_m: Option<Vec<Point>>,
    /// Position on the first route where the footprint does not fit; `None` if it fits, or
    /// without a route.
    pub misfit: Option<Misfit>,
    /// Contradictions that the navigator noticed during the run
    /// ([`Navigator::doubts`](keyway::navigate::Navigator::doubts)), one message of each kind,
    /// the last one, for human readers; `None` without a run.
    pub noticed: Option<Vec<String>>,
    /// Metrics of the run.
    pub run: Option<RunPart>,
    /// The start, the end of every cycle, and the contact if there was one:
    /// `[t_s, x_m, y_m, yaw_rad, v_mps, omega_radps]` each.
    pub trajectory: Option<Vec<[f64; 6]>>,
    /// All inputs of the result.
    pub inputs: Inputs,
}

/// Outcome of an episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EpisodeOutcome {
    /// The goal was reached.
    Reached,
    /// The footprint touched something.
    Collided,
    /// The time limit passed.
    Timeout,
    /// The robot made no progress.
    Stuck,
    /// There was no route at the start.
    NoPath,
}

impl RobotReport {
    /// Name and version of this format.
    pub const SCHEMA: &'static str = "keyway.navigate/4";
}

impl EpisodeOutcome {
    /// Name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::Collided => "collided",
            Self::Timeout => "timeout",
            Self::Stuck => "stuck",
            Self::NoPath => "no_path",
        }
    }
}

/// `keyway.team/1`: the runs of all robots in one world.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EpisodeReport {
    /// Name and version of this format.
    pub schema: &'static str,
    /// Outcome of each robot's run, in the order of the robots.
    pub outcomes: Vec<EpisodeOutcome>,
    /// Time at which the last robot reached its goal \[s\]; `None` unless all did.
    pub makespan_s: Option<f64>,
    /// Smallest distance between two footprints while the run of at least one of the two robots
    /// continues \[m\]; `None` for a single robot, or without any route.
    pub min_robot_clearance_m: Option<f64>,
    /// Report of each robot, as if it had driven alone; one or more.
    pub robots: Vec<RobotReport>,
}

impl EpisodeReport {
    /// Name and version of this format.
    pub const SCHEMA: &'static str = "keyway.team/1";

    /// Returns the report of the first robot.
    ///
    /// # Panics
    /// Panics without robots; an episode always has at least one.
    pub fn first(mut self) -> RobotReport {
        self.robots.swap_remove(0)
    }

    pub(super) fn of(robots: Vec<RobotReport>, min_robot_clearance_m: Option<f64>) -> Self {
        let outcomes: Vec<EpisodeOutcome> = robots.iter().map(|robot| robot.outcome).collect();
        let have_reached = outcomes.iter().all(|&outcome| outcome == EpisodeOutcome::Reached);
        let ends_s = robots.iter().filter_map(|robot| Some(robot.run.as_ref()?.time_s));
        let makespan_s = ends_s.reduce(f64::max).filter(|_| have_reached);
        Self { schema: Self::SCHEMA, outcomes, makespan_s, min_robot_clearance_m, robots }
    }
}
