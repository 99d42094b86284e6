//! Report of an episode: `keyway.navigate/4`.

use crate::report::{Inputs, PlanPart, RunPart, SmoothedPart};
use keyway::geometry::Point;
use keyway::navigate::Misfit;
use serde::{Deserialize, Serialize};

/// `keyway.navigate/4`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EpisodeReport {
    /// Name and version of this form.
    pub schema: &'static str,
    /// Outcome of the episode.
    pub outcome: EpisodeOutcome,
    /// Reason why the goal was not reached, for people.
    pub reason: Option<String>,
    /// The first route as planned, or the reason why there is none.
    pub plan: PlanPart,
    /// The first route, smoothed; `None` without a route, here and below.
    pub smoothed: Option<SmoothedPart>,
    /// The points that the guide hands out along the first route \[m\].
    pub key_points_m: Option<Vec<Point>>,
    /// Place on the first route where the footprint does not fit; `None` where it fits, or without
    /// a route.
    pub misfit: Option<Misfit>,
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

impl EpisodeReport {
    /// Name and version of this form.
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
