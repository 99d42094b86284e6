//! The classic dynamic window approach (DWA): selects the admissible velocity with the best
//! combination of heading towards the guide point, distance to obstacles, and speed.
//!
//! # Source
//! \[Fox1997\], in the form of \[You2021\]: equation (9), tables 2 and 3. Equations (4) to (8) and
//! (10), which it shares with its relatives, are those of [`WindowConfig`].
//!
//! | paper | here | unit | table 3 |
//! |---|---|---|---|
//! | alpha | `weights.heading` | | 0.08 |
//! | beta | `weights.distance` | | 0.2 |
//! | gamma | `weights.speed` | | 0.1 |
//!
//! # Two readings of dist
//! \[You2021\] means the nearest point of the trajectory: [`DwaConfig::PAPER`]. The sample program
//! behind it measures at the trajectory's end, and caps the term: [`DwaConfig::SAMPLE`].
//!
//! # Errors / cost
//! See [`WindowConfig`].

use super::dynamic_window::{DynamicWindow, Rollout, Term, TermValue, Weighing};
use super::parameters::{BoxedLocalPlanner, LocalParameters};
use super::terms::{distance, heading, speed};
use super::{
    Decision, DriveMemory, Explanation, LocalPlanner, NoCommand, Scene, Scratch, WindowConfig,
};
use crate::ConfigError;
use crate::geometry::Velocity;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Parameters of [`Dwa`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DwaConfig {
    /// Candidate velocities, and the rules that refuse them.
    pub window: WindowConfig,
    /// Weights of the evaluation (9).
    pub weights: Weights,
    /// In the evaluation (9) alone, larger distances count as this one \[m\].
    pub distance_term_cap_m: f64,
}

/// Weights of the terms of the evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Weights {
    /// alpha: alignment with the guide point at `window.judged_s`.
    pub heading: f64,
    /// beta: distance to obstacles.
    pub distance: f64,
    /// gamma: forward speed.
    pub speed: f64,
}

impl Weights {
    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field.
    pub fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_weight("heading", self.heading)?;
        ConfigError::unless_weight("distance", self.distance)?;
        ConfigError::unless_weight("speed", self.speed)
    }
}

impl DwaConfig {
    /// As published, tables 2 and 3: for maps with cells of 1 m.
    pub const PAPER: Self = Self {
        window: WindowConfig::PAPER,
        weights: Weights { heading: 0.08, distance: 0.2, speed: 0.1 },
        distance_term_cap_m: 5.0,
    };

    /// The MATLAB sample that much of this literature runs as the classic dynamic window
    /// approach: the distance is that of the trajectory's end, and in the evaluation at most 2 R1
    /// = 1 m. R1 = 0.5 m is the radius of its obstacles, which are points; here they are squares
    /// of that half width, so nothing is subtracted.
    ///
    /// It drops candidates whose braking distance exceeds the distance, which is (7). The cap
    /// does not apply there: it would limit the robot to 0.632 m/s.
    pub const SAMPLE: Self =
        Self { window: WindowConfig::AT_THE_END, distance_term_cap_m: 1.0, ..Self::PAPER };

    /// The evaluation (11) of \[You2021\] with the weights of its fused runs, and the fixed gamma
    /// of its table 3. Towards key points, key(v, omega) is the heading of the classic dynamic
    /// window approach.
    pub const FUSED: Self =
        Self { weights: Weights { heading: 0.15, distance: 0.1, speed: 0.1 }, ..Self::PAPER };

    /// Fields for which the paper gives no value: those of [`Self::PAPER`] are interpretations.
    pub const READINGS: &'static [&'static str] =
        &["window.movers_s", "window.distance_cap_m", "distance_term_cap_m"];

    /// Derived from the robot, one rule for all maps: [`WindowConfig::for_robot`], with the same
    /// cap in the evaluation. The weight of distance is small: with 0.1, heading and distance
    /// alternate beside obstacles, and the turn rate oscillates; with 0.02, a long robot gets
    /// stuck more often.
    pub fn for_robot(robot: &Robot) -> Self {
        let window = WindowConfig::for_robot(robot);
        Self {
            weights: Weights { heading: 0.8, distance: 0.05, speed: 0.3 },
            distance_term_cap_m: window.distance_cap_m,
            window,
        }
    }
}

/// The classic dynamic window approach.
#[derive(Clone, Debug)]
pub struct Dwa {
    window: DynamicWindow,
    weighing: Weighing<3>,
    distance_cap_m: f64,
}

impl Dwa {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "dwa";

    /// Creates a planner for a robot.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] if a value of the robot or the config is invalid, or the two do
    /// not fit together (a horizon too short to stop within it, or steps too small for one
    /// cycle); the error names the field.
    pub fn new(config: DwaConfig, robot: impl Into<Arc<Robot>>) -> Result<Self, ConfigError> {
        let DwaConfig { window, weights, distance_term_cap_m: distance_cap_m } = config;
        let window = DynamicWindow::new(window, robot)?;
        weights.validate().map_err(|error| error.within("weights"))?;
        ConfigError::unless_positive("distance_term_cap_m", distance_cap_m)?;
        let weighing = Weighing([
            Term::of(heading::NAME, weights.heading),
            Term::of(distance::NAME, weights.distance),
            Term::of(speed::NAME, weights.speed),
        ]);
        Ok(Self { window, weighing, distance_cap_m })
    }

    /// The robot that is driven.
    pub fn robot(&self) -> &Robot {
        self.window.robot()
    }

    /// The terms of eq. (9) before normalisation.
    fn terms(&self, velocity: Velocity, rollout: &Rollout) -> [TermValue; 3] {
        [
            TermValue::of(rollout.heading),
            TermValue::of(distance::raw(rollout.distance_m, self.distance_cap_m)),
            TermValue::of(speed::raw(velocity)),
        ]
    }
}

impl LocalParameters for DwaConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self, robot: &Arc<Robot>) -> Result<BoxedLocalPlanner, ConfigError> {
        Ok(Box::new(Dwa::new(self.clone(), Arc::clone(robot))?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        Self::READINGS
    }
}

impl LocalPlanner for Dwa {
    fn decide(
        &self,
        scene: &Scene<'_>,
        _: &mut DriveMemory,
        scratch: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        let terms = |velocity, rollout: &Rollout| self.terms(velocity, rollout);
        self.window.decide(scene, scratch, &self.weighing, terms)
    }

    fn explain(&self, scene: &Scene<'_>, _: &DriveMemory) -> Explanation {
        let terms = |velocity, rollout: &Rollout| self.terms(velocity, rollout);
        self.window.explain(scene, &self.weighing, terms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn equation_9_terms_before_they_are_normalised() {
        let judged = Pose::new(5.0, 10.0, 0.0);
        let heading = heading::raw(judged, Point::new(5.0, 15.0));
        let rollout = Rollout { judged, heading, distance_m: 9.0 };
        let dwa = Dwa::new(DwaConfig::PAPER, Robot::paper()).unwrap();
        let terms = dwa.terms(Velocity::new(-0.5, 0.0), &rollout).map(|value| value.raw);
        assert!((terms[0] - FRAC_PI_2).abs() < 1e-12);
        assert_eq!(terms[1..], [5.0, 0.5]);
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let field = |config| Dwa::new(config, Robot::small()).unwrap_err().path;
        let base = DwaConfig::for_robot(&Robot::small());
        let weights = Weights { speed: -1.0, ..base.weights };
        assert_eq!(field(DwaConfig { weights, ..base.clone() }), "weights.speed");
        let window = WindowConfig { horizon_s: f64::NAN, ..base.window.clone() };
        assert_eq!(field(DwaConfig { window, ..base.clone() }), "window.horizon_s");
        assert_eq!(field(DwaConfig { distance_term_cap_m: 0.0, ..base }), "distance_term_cap_m");
    }
}
