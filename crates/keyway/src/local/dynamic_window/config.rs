//! Parameters of a dynamic window: as published, and derived from a robot.

use super::{Admissible, DistanceAt, Prediction, Window};
use crate::ConfigError;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Parameters of the dynamic window: candidates, their rollouts, and the rules that refuse them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct WindowConfig {
    /// Prediction horizon of a candidate \[s\].
    pub horizon_s: f64,
    /// Time at which a candidate is compared with the guide point \[s\]: by its heading, or its
    /// distance. At most the horizon, and with the prediction `arcs` at least a cycle.
    pub judged_s: f64,
    /// Time over which a candidate is compared with moving obstacles \[s\]; at least the horizon.
    pub movers_s: f64,
    /// Time between two predicted poses \[s\].
    pub prediction_step_s: f64,
    /// Prediction of a candidate: `euler` or `arcs`.
    pub prediction: Prediction,
    /// Spacing of the candidates' speeds \[m/s\].
    pub v_step_mps: f64,
    /// Spacing of the candidates' turn rates \[rad/s\].
    pub omega_step_radps: f64,
    /// True if a robot that can drive backwards does so to follow its guide. Otherwise only
    /// recoveries back up.
    pub backwards: bool,
    /// Admissible candidates among those that touch nothing: `stopping-distance` or `rollout`.
    pub admissible: Admissible,
    /// Point of a trajectory at which the distance is measured within which a velocity must be
    /// able to stop: the nearest of all (`trajectory`), or the `end`.
    pub stopping_distance_at: DistanceAt,
    /// Point of a trajectory for the distance in the evaluation: `trajectory` or `end`.
    pub distance_at: DistanceAt,
    /// Larger distances count as this one \[m\].
    pub distance_cap_m: f64,
    /// Distance that the footprint keeps from everything, once it is that far away \[m\].
    pub safety_margin_m: f64,
}

impl WindowConfig {
    /// As published by \[You2021\], tables 2 and 3: for maps with cells of 1 m.
    pub const PAPER: Self = Self {
        horizon_s: 3.0,
        judged_s: 3.0,
        movers_s: 3.0,
        prediction_step_s: 0.1,
        prediction: Prediction::Euler,
        v_step_mps: 0.01,
        omega_step_radps: PI / 180.0,
        backwards: true,
        admissible: Admissible::StoppingDistance,
        stopping_distance_at: DistanceAt::Trajectory,
        distance_at: DistanceAt::Trajectory,
        distance_cap_m: 5.0,
        safety_margin_m: 0.0,
    };

    /// The same with both distances at the end of the trajectory \[S1\].
    pub const AT_THE_END: Self =
        Self { stopping_distance_at: DistanceAt::End, distance_at: DistanceAt::End, ..Self::PAPER };

    /// Derived from the robot, one rule for all maps:
    ///
    /// - `horizon_s`: a cycle and the time to stop, or
    ///   [`Limits::brakes_within_s`](crate::robot::Limits::brakes_within_s) if that is more, for
    ///   robots that stop within a cycle;
    /// - `judged_s`: a cycle and half the time to stop. In this time the robot drives its
    ///   stopping distance at full speed. Compared at the end of the horizon, twice as far ahead,
    ///   a trajectory that passes the guide point faces away from it, and the robot creeps up to
    ///   each guide point;
    /// - `movers_s`: three times the horizon. Moving obstacles do not stop where the robot would;
    /// - `prediction_step_s`: a cycle, but at most an inscribed radius of driving, and at least a
    ///   tenth of a cycle;
    /// - steps: a tenth of the width of the widest window in speed, a twentieth in turn rate;
    /// - `backwards`: no, as sensors face ahead; the recoveries back up over ground that the
    ///   robot has covered;
    /// - `admissible`: every rollout without contact, as the braking motion is part of it;
    /// - `distance_cap_m`: the stopping distance
    ///   ([`Limits::stop_m`](crate::robot::Limits::stop_m));
    /// - `safety_margin_m`: [`Robot::safety_margin_or_default_m`].
    pub fn for_robot(robot: &Robot) -> Self {
        let limits = &robot.limits;
        let cycle_s = robot.cycle_s;
        let widest = Window::widest(limits, cycle_s);
        let radius_s = robot.footprint.inscribed_radius_m() / limits.v_max_mps;
        let horizon_s = cycle_s + limits.stop_s().max(limits.brakes_within_s(cycle_s));
        let step_s = if radius_s > 0.0 { radius_s.clamp(0.1 * cycle_s, cycle_s) } else { cycle_s };
        Self {
            horizon_s,
            judged_s: cycle_s + 0.5 * limits.stop_s(),
            movers_s: 3.0 * horizon_s,
            // Limits the number of poses if the brakes are weak for the cycle.
            prediction_step_s: step_s.max(1e-3 * horizon_s),
            prediction: Prediction::Arcs,
            v_step_mps: widest.v / 10.0,
            omega_step_radps: widest.omega / 20.0,
            backwards: false,
            admissible: Admissible::Rollout,
            stopping_distance_at: DistanceAt::Trajectory,
            distance_at: DistanceAt::Trajectory,
            distance_cap_m: limits.stop_m(),
            safety_margin_m: robot.safety_margin_or_default_m(),
        }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let positive = [
            ("horizon_s", self.horizon_s),
            ("judged_s", self.judged_s),
            ("movers_s", self.movers_s),
            ("prediction_step_s", self.prediction_step_s),
            ("v_step_mps", self.v_step_mps),
            ("omega_step_radps", self.omega_step_radps),
            ("distance_cap_m", self.distance_cap_m),
        ];
        let mut positive = positive.into_iter();
        positive.try_for_each(|(field, value)| ConfigError::unless_positive(field, value))?;
        ConfigError::unless_not_negative("safety_margin_m", self.safety_margin_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derived_parameters_by_hand() {
        let config = WindowConfig::for_robot(&Robot::small());
        assert!((config.horizon_s - 1.1).abs() < 1e-12);
        assert!((config.judged_s - 0.6).abs() < 1e-12);
        assert!((config.movers_s - 3.3).abs() < 1e-12);
        assert!((config.distance_cap_m - 0.25).abs() < 1e-12);
        assert!((config.v_step_mps - 0.01).abs() < 1e-12);
        assert!((config.omega_step_radps - 0.03).abs() < 1e-12);
        assert!((config.safety_margin_m - 0.005).abs() < 1e-12);
        for name in Robot::NAMES {
            let robot = Robot::by_name(name).unwrap();
            assert_eq!(WindowConfig::for_robot(&robot).validate(), Ok(()), "{name}");
        }
        assert_eq!(WindowConfig::PAPER.validate(), Ok(()));
        let tiny = crate::robot::Footprint::circle(1e-300).unwrap();
        let tiny = WindowConfig::for_robot(&Robot { footprint: tiny, ..Robot::small() });
        assert_eq!(tiny.prediction_step_s, 0.1 * Robot::small().cycle_s);
    }

    #[test]
    fn a_bad_value_is_named() {
        let config = WindowConfig { horizon_s: f64::NAN, ..WindowConfig::PAPER };
        assert_eq!(config.validate().unwrap_err().path, "horizon_s");
        let config = WindowConfig { safety_margin_m: -1.0, ..WindowConfig::PAPER };
        assert_eq!(config.validate().unwrap_err().path, "safety_margin_m");
    }
}
