//! Rules that end the run of a scene.

use crate::episode::EpisodeRules;
use crate::sim::{Arrival, ReachedBy};
use keyway::ConfigError;
use serde::{Deserialize, Serialize};

/// Rules that end a run, and reference values for its metrics.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SceneRules {
    /// Goal tolerance \[m\]; `None`: `controller.goal_tolerance_m` of the stack.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal_tolerance_m: Option<f64>,
    /// Arrival rule, standing or passing the goal; `None`: standing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arrival: Option<Arrival>,
    /// Pose that decides about reaching the goal; `None`: the true one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reached_by: Option<ReachedBy>,
    /// Limit of the simulated time \[s\]; `None`: 60 s plus four times the route's duration at
    /// top speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_limit_s: Option<f64>,
    /// Time without progress along the remaining path after which the robot is stuck \[s\];
    /// `None`: 20 s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stuck_window_s: Option<f64>,
    /// Reference for the duration of a run, such as the best known time \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_time_s: Option<f64>,
}

impl SceneRules {
    pub(super) fn are_usual(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the rules of the run that the scene describes.
    pub(super) fn of_episode(&self) -> EpisodeRules {
        let usual = EpisodeRules::default();
        EpisodeRules {
            goal_tolerance_m: self.goal_tolerance_m,
            arrival: self.arrival.unwrap_or(usual.arrival),
            reached_by: self.reached_by.unwrap_or(usual.reached_by),
            time_limit_s: self.time_limit_s,
            stuck_window_s: self.stuck_window_s.unwrap_or(usual.stuck_window_s),
            ..usual
        }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let fields = [
            ("goal_tolerance_m", self.goal_tolerance_m),
            ("time_limit_s", self.time_limit_s),
            ("stuck_window_s", self.stuck_window_s),
            ("reference_time_s", self.reference_time_s),
        ];
        let mut given = fields.into_iter().filter_map(|(field, value)| Some((field, value?)));
        given.try_for_each(|(field, value)| ConfigError::unless_positive(field, value))
    }
}
