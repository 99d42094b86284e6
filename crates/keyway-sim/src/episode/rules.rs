//! Rules that end a run.

use crate::sim::{Arrival, ReachedBy, RunRules};

/// Rules that end a run.
#[derive(Clone, Debug, PartialEq)]
pub struct EpisodeRules {
    /// Goal tolerance \[m\]; `None`: `controller.goal_tolerance_m` of the stack.
    pub goal_tolerance_m: Option<f64>,
    /// Arrival rule: `Standing` requires the robot to stop at the goal, with the goal's heading;
    /// `Passing` does not.
    pub arrival: Arrival,
    /// Pose that decides about reaching the goal.
    pub reached_by: ReachedBy,
    /// Limit of the simulated time \[s\]; `None`: 60 s plus four times the route's duration at top
    /// speed.
    pub time_limit_s: Option<f64>,
    /// See [`RunRules::stuck_window_s`] \[s\].
    pub stuck_window_s: f64,
    /// See [`RunRules::stuck_progress_m`] \[m\]; `None`: the progress that the controller expects
    /// in that time ([`WayProgress::step_m`](keyway::navigate::WayProgress::step_m)).
    pub stuck_progress_m: Option<f64>,
}

impl Default for EpisodeRules {
    fn default() -> Self {
        let RunRules { stuck_window_s, .. } = RunRules::default();
        Self {
            goal_tolerance_m: None,
            arrival: Arrival::Standing,
            reached_by: ReachedBy::Truth,
            time_limit_s: None,
            stuck_window_s,
            stuck_progress_m: None,
        }
    }
}
