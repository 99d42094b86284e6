//! Rules that end a run.

use crate::sim::{Arrival, ReachedBy, RunRules};
use keyway::ConfigError;
use serde::{Deserialize, Serialize};

/// Rules that end a run, and the time that it is scored against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct EpisodeRules {
    /// Goal tolerance \[m\]; `None`: `controller.goal_tolerance_m` of the stack.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal_tolerance_m: Option<f64>,
    /// Arrival rule: `Standing` requires the robot to stop at the goal, with the goal's heading;
    /// `Passing` does not.
    #[serde(skip_serializing_if = "is_standing")]
    pub arrival: Arrival,
    /// Pose that decides about reaching the goal.
    #[serde(skip_serializing_if = "is_truth")]
    pub reached_by: ReachedBy,
    /// Limit of the simulated time \[s\]; `None`: 60 s plus four times the route's duration at top
    /// speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_limit_s: Option<f64>,
    /// Time without progress along the remaining path after which the robot is stuck \[s\]. See
    /// [`RunRules::stuck_window_s`].
    #[serde(skip_serializing_if = "is_usual_window")]
    pub stuck_window_s: f64,
    /// Decrease of the remaining path that counts as progress \[m\]; `None`: the progress that the
    /// controller expects in that time
    /// ([`WayProgress::step_m`](keyway::navigate::WayProgress::step_m)). No file sets it.
    #[serde(skip)]
    pub stuck_progress_m: Option<f64>,
    /// Reference for the duration of a run, such as the best known time \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_time_s: Option<f64>,
}

impl EpisodeRules {
    /// The rules of a run of which nothing is said.
    pub const USUAL: Self = Self {
        goal_tolerance_m: None,
        arrival: Arrival::Standing,
        reached_by: ReachedBy::Truth,
        time_limit_s: None,
        stuck_window_s: RunRules::USUAL.stuck_window_s,
        stuck_progress_m: None,
        reference_time_s: None,
    };

    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let fields = [
            ("goal_tolerance_m", self.goal_tolerance_m),
            ("time_limit_s", self.time_limit_s),
            ("stuck_window_s", Some(self.stuck_window_s)),
            ("reference_time_s", self.reference_time_s),
        ];
        let mut given = fields.into_iter().filter_map(|(field, value)| Some((field, value?)));
        given.try_for_each(|(field, value)| ConfigError::unless_positive(field, value))
    }
}

impl Default for EpisodeRules {
    fn default() -> Self {
        Self::USUAL
    }
}

fn is_standing(arrival: &Arrival) -> bool {
    *arrival == EpisodeRules::USUAL.arrival
}

fn is_truth(reached_by: &ReachedBy) -> bool {
    *reached_by == EpisodeRules::USUAL.reached_by
}

fn is_usual_window(stuck_window_s: &f64) -> bool {
    *stuck_window_s == EpisodeRules::USUAL.stuck_window_s
}
