//! Rules that end a run without contact.

use super::Control;
use keyway::ConfigError;
use keyway::navigate::{WayLeft, WayProgress};
use serde::{Deserialize, Serialize};

/// Rules that end a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RunRules {
    /// Distance of the robot's centre from the goal within which the goal is reached \[m\].
    pub goal_tolerance_m: f64,
    /// Additional condition for reaching the goal.
    pub arrival: Arrival,
    /// Pose that decides about reaching the goal.
    pub reached_by: ReachedBy,
    /// Simulated time after which a run is terminated \[s\].
    pub time_limit_s: f64,
    /// Time without progress after which the robot is stuck \[s\]. Progress is a remaining path
    /// that is [`Self::stuck_progress_m`] shorter (after a longer new route, shorter than that
    /// route), or a turn towards it by 0.1 rad ([`Control::turn_left_rad`]).
    pub stuck_window_s: f64,
    /// Decrease of the remaining path that counts as progress \[m\].
    pub stuck_progress_m: f64,
}

/// Condition for a robot near its goal to have reached it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Arrival {
    /// Immediately, at any speed.
    #[default]
    Passing,
    /// After the robot has stopped and its controller has reported arrival.
    Standing,
}

/// Pose that decides about reaching the goal. Contact is always tested with the true pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ReachedBy {
    /// The true pose.
    #[default]
    Truth,
    /// The pose that was last reported to the robot, which is its best knowledge.
    Belief,
}

impl ReachedBy {
    /// Names of the variants in files.
    pub const NAMES: [&'static str; 2] = ["truth", "belief"];

    /// Returns the variant of a name.
    pub fn by_name(name: &str) -> Option<Self> {
        [Self::Truth, Self::Belief]
            .into_iter()
            .zip(Self::NAMES)
            .find(|it| it.1 == name)
            .map(|it| it.0)
    }
}

impl Default for RunRules {
    fn default() -> Self {
        Self::USUAL
    }
}

impl RunRules {
    /// The rules of a run of which nothing is said.
    pub const USUAL: Self = Self {
        goal_tolerance_m: 0.15,
        arrival: Arrival::Passing,
        reached_by: ReachedBy::Truth,
        time_limit_s: 300.0,
        stuck_window_s: 20.0,
        stuck_progress_m: 0.05,
    };

    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field.
    pub fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_not_negative("goal_tolerance_m", self.goal_tolerance_m)?;
        ConfigError::unless_positive("time_limit_s", self.time_limit_s)?;
        ConfigError::unless_positive("stuck_window_s", self.stuck_window_s)?;
        ConfigError::unless_positive("stuck_progress_m", self.stuck_progress_m)
    }
}

/// Number of cycles until at least `duration_s` has passed. Cycles are counted, so times never
/// drift. 0.14 s is seven cycles of 0.02 s, although the quotient is rounded to more than 7.
pub(super) fn cycles_within(duration_s: f64, cycle_s: f64) -> u64 {
    (duration_s / cycle_s * (1.0 - 1e-9)).ceil() as u64
}

/// Detects robots without progress.
pub(super) struct StuckWatch {
    step_m: f64,
    window_cycles: u64,
    progress: WayProgress,
    /// Cycle of the last progress.
    since_cycle: u64,
    route: Option<u32>,
}

impl StuckWatch {
    pub(super) fn new(rules: &RunRules, cycle_s: f64) -> Self {
        Self {
            step_m: rules.stuck_progress_m,
            window_cycles: cycles_within(rules.stuck_window_s, cycle_s),
            progress: WayProgress::NEW,
            since_cycle: 0,
            route: None,
        }
    }

    /// True if a robot with this decision is stuck.
    pub(super) fn is_stuck(&mut self, control: &Control, cycle: u64) -> bool {
        let &Control { remaining_m, turn_left_rad, route, .. } = control;
        if remaining_m.is_finite() {
            if self.route.replace(route).is_some_and(|before| before != route) {
                self.progress.begin_another_way(remaining_m);
            }
            let left = WayLeft { way_m: remaining_m, turn_rad: turn_left_rad };
            if self.progress.has_progressed(left, self.step_m) {
                self.since_cycle = cycle;
            }
        }
        cycle - self.since_cycle >= self.window_cycles
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_in_cycles() {
        assert_eq!(cycles_within(0.14, 0.02), 7);
        assert_eq!(cycles_within(0.15, 0.05), 3);
        assert_eq!(cycles_within(0.141, 0.02), 8);
    }
}
