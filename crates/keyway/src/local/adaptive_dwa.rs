//! Adaptive DWA: a dynamic window approach whose weights of heading and speed depend, candidate by
//! candidate, on the distance to obstacles at the end of its trajectory.
//!
//! # Source
//! \[S1\], with the local goals of [`LocalGoals`](crate::guide::LocalGoals). Equations (4) to (8)
//! and (10) of \[You2021\], which it shares, are those of [`WindowConfig`].
//!
//! | paper | here | unit | paper's value |
//! |---|---|---|---|
//! | dist | the footprint's distance at the end of the trajectory | m | |
//! | R | `safe_radius_m` | m | not given; read as 0.5 |
//! | a | `a` | | in (0, 1); read as 0.5 |
//! | dist* = max(dist - R, R) | [`AdaptiveDwa::factors`] | m | |
//! | alpha, beta, gamma | `weights` | | not given; those of \[You2021\], table 3 |
//!
//! G = sigma((a + (1 - a) dist* / R) alpha heading + beta dist + (a + R / dist*) gamma vel),
//! where sigma divides each term by its sum over the candidates.
//!
//! # Where this differs from the paper
//! - heading, dist and vel are first divided by their sums and then multiplied by their factors.
//!   dist* is in metres.
//! - The factors are as printed: near obstacles that of speed is a + 1, and far away it falls to
//!   a. So speed counts *more* near obstacles, the opposite of what the text announces. On open
//!   ground the factors can make standstill the best candidate, with the local goal straight
//!   ahead.
//! - dist is never capped near 2 R, unlike in the MATLAB sample behind much of this literature:
//!   dist* would always be R, and the weights constant.
//! - The paper gives no limits of its robot: those of [`Robot::paper`] are used.
//!
//! # Errors / cost
//! See [`WindowConfig`].

use super::dynamic_window::{DynamicWindow, Rollout, Term, TermValue, Weighing};
use super::parameters::{BoxedLocalPlanner, LocalParameters};
use super::terms::{heading, speed};
use super::{
    Decision, DistanceAt, DriveMemory, Explanation, LocalPlanner, NoCommand, Scene, Scratch,
    Weights, WindowConfig,
};
use crate::ConfigError;
use crate::geometry::Velocity;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Parameters of [`AdaptiveDwa`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct AdaptiveDwaConfig {
    /// Candidate velocities, and the rules that refuse them.
    pub window: WindowConfig,
    /// Weights of the evaluation, before they are multiplied by the factors.
    pub weights: Weights,
    /// a: the part of the factors that does not depend on the distance; above 0, below 1.
    pub a: f64,
    /// R: within twice this distance of an obstacle the factors are constant \[m\].
    pub safe_radius_m: f64,
}

impl AdaptiveDwaConfig {
    /// As published. The paper gives no numbers: all are readings, from tables 2 and 3 of
    /// \[You2021\] if they are given there.
    pub const PAPER: Self = Self {
        window: WindowConfig::AT_THE_END,
        weights: Weights { heading: 0.08, distance: 0.2, speed: 0.1 },
        a: 0.5,
        safe_radius_m: 0.5,
    };

    /// Fields for which the paper gives no value: those of [`Self::PAPER`] are interpretations.
    pub const READINGS: &'static [&'static str] = &[
        "window.horizon_s",
        "window.judged_s",
        "window.movers_s",
        "window.prediction_step_s",
        "window.v_step_mps",
        "window.omega_step_radps",
        "window.distance_cap_m",
        "window.safety_margin_m",
        "weights.heading",
        "weights.distance",
        "weights.speed",
        "a",
        "safe_radius_m",
    ];

    /// Derived from the robot, one rule for all maps: [`WindowConfig::for_robot`] with the
    /// distance and the heading at the end, as its local goals are farther ahead. The safe radius
    /// is half the stopping distance at full speed, so within the stopping distance of an
    /// obstacle the factors are constant; distances are capped at twice the stopping distance.
    /// The factor of heading is then at most 2: with the paper's 5, and more, standstill with the
    /// local goal straight ahead scores best on open ground.
    pub fn for_robot(robot: &Robot) -> Self {
        let stop_m = robot.limits.stop_m();
        let window = WindowConfig::for_robot(robot);
        Self {
            window: WindowConfig {
                distance_at: DistanceAt::End,
                judged_s: window.horizon_s,
                distance_cap_m: 2.0 * stop_m,
                ..window
            },
            weights: Weights { heading: 0.4, distance: 0.1, speed: 0.3 },
            a: Self::PAPER.a,
            safe_radius_m: 0.5 * stop_m,
        }
    }
}

/// The dynamic window approach of \[S1\].
#[derive(Clone, Debug)]
pub struct AdaptiveDwa {
    window: DynamicWindow,
    weighing: Weighing<3>,
    a: f64,
    safe_radius_m: f64,
}

impl AdaptiveDwa {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "adaptive-dwa";

    /// Name of dist in an evaluation.
    const END_DISTANCE: &'static str = "end-distance";

    /// Creates a planner for a robot.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] if a value of the robot or the config is invalid, or the two do
    /// not fit together; the error names the field.
    pub fn new(
        config: AdaptiveDwaConfig,
        robot: impl Into<Arc<Robot>>,
    ) -> Result<Self, ConfigError> {
        let AdaptiveDwaConfig { window, weights, a, safe_radius_m } = config;
        if window.distance_at != DistanceAt::End {
            let reason = "must be `end`: the weights depend on the distance at the end";
            return Err(ConfigError::new("window.distance_at", reason));
        }
        let window = DynamicWindow::new(window, robot)?;
        weights.validate().map_err(|error| error.within("weights"))?;
        if !(a > 0.0 && a < 1.0) {
            return Err(ConfigError::must_be("a", "a number above 0 and below 1", a));
        }
        ConfigError::unless_positive("safe_radius_m", safe_radius_m)?;
        let weighing = Weighing([
            Term::of(heading::NAME, weights.heading),
            Term::of(Self::END_DISTANCE, weights.distance),
            Term::of(speed::NAME, weights.speed),
        ]);
        Ok(Self { window, weighing, a, safe_radius_m })
    }

    /// The robot that is driven.
    pub fn robot(&self) -> &Robot {
        self.window.robot()
    }

    /// Factors of the weights of heading and of speed at a distance \[m\].
    fn factors(&self, dist_m: f64) -> (f64, f64) {
        let (a, radius_m) = (self.a, self.safe_radius_m);
        let beyond_m = (dist_m - radius_m).max(radius_m);
        (a + (1.0 - a) * beyond_m / radius_m, a + radius_m / beyond_m)
    }

    /// The terms of the evaluation before normalisation.
    fn terms(&self, velocity: Velocity, rollout: &Rollout) -> [TermValue; 3] {
        let dist_m = rollout.distance_m;
        let (of_heading, of_speed) = self.factors(dist_m);
        [
            TermValue { raw: rollout.heading, factor: of_heading },
            TermValue::of(dist_m),
            TermValue { raw: speed::raw(velocity), factor: of_speed },
        ]
    }
}

impl LocalParameters for AdaptiveDwaConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self, robot: &Arc<Robot>) -> Result<BoxedLocalPlanner, ConfigError> {
        Ok(Box::new(AdaptiveDwa::new(self.clone(), Arc::clone(robot))?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        Self::READINGS
    }
}

impl LocalPlanner for AdaptiveDwa {
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

    #[test]
    fn factors_by_hand() {
        let planner = AdaptiveDwa::new(AdaptiveDwaConfig::PAPER, Robot::paper()).unwrap();
        for dist_m in [0.0, 0.3, 0.5, 1.0] {
            assert_eq!(planner.factors(dist_m), (1.0, 1.5), "{dist_m}");
        }
        // dist* = 1.5 m: 0.5 + 0.5 * 3, and 0.5 + 1 / 3.
        let (heading, speed) = planner.factors(2.0);
        assert!((heading - 2.0).abs() < 1e-12 && (speed - 5.0 / 6.0).abs() < 1e-12);
        // 4.5 m: 0.5 + 0.5 * 9, and 0.5 + 1 / 9.
        let (heading, speed) = planner.factors(5.0);
        assert!((heading - 5.0).abs() < 1e-12 && (speed - 11.0 / 18.0).abs() < 1e-12);
    }

    #[test]
    fn terms_before_they_are_normalised() {
        let judged = Pose::new(5.0, 10.0, 0.0);
        let heading = heading::raw(judged, Point::new(5.0, 15.0));
        let rollout = Rollout { judged, heading, distance_m: 2.0 };
        let planner = AdaptiveDwa::new(AdaptiveDwaConfig::PAPER, Robot::paper()).unwrap();
        let terms = planner.terms(Velocity::new(0.5, 0.0), &rollout);
        let half_pi = std::f64::consts::FRAC_PI_2;
        assert!((terms[0].raw - half_pi).abs() < 1e-12 && (terms[0].factor - 2.0).abs() < 1e-12);
        assert_eq!(terms[1], TermValue::of(2.0));
        assert!(terms[2].raw == 0.5 && (terms[2].factor - 5.0 / 6.0).abs() < 1e-12);
    }

    #[test]
    fn factors_of_a_robot_stay_small() {
        let robot = Robot::small();
        let config = AdaptiveDwaConfig::for_robot(&robot);
        let (cap_m, planner) = (config.window.distance_cap_m, AdaptiveDwa::new(config, robot));
        // It stops within 0.25 m.
        let factors = |dist_m| planner.as_ref().unwrap().factors(dist_m);
        assert_eq!((factors(0.1), factors(0.25)), ((1.0, 1.5), (1.0, 1.5)));
        let (heading, speed) = factors(cap_m);
        assert!((heading - 2.0).abs() < 1e-12 && (speed - 5.0 / 6.0).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let base = AdaptiveDwaConfig::PAPER;
        let field = |config| AdaptiveDwa::new(config, Robot::paper()).unwrap_err().path;
        for a in [0.0, 1.0, f64::NAN] {
            assert_eq!(field(AdaptiveDwaConfig { a, ..base.clone() }), "a");
        }
        assert_eq!(
            field(AdaptiveDwaConfig { safe_radius_m: 0.0, ..base.clone() }),
            "safe_radius_m"
        );
        let weights = Weights { speed: -1.0, ..base.weights };
        assert_eq!(field(AdaptiveDwaConfig { weights, ..base.clone() }), "weights.speed");
        let window = WindowConfig { distance_at: DistanceAt::Trajectory, ..base.window.clone() };
        assert_eq!(field(AdaptiveDwaConfig { window, ..base.clone() }), "window.distance_at");
        let window = WindowConfig { v_step_mps: 0.0, ..base.window.clone() };
        assert_eq!(field(AdaptiveDwaConfig { window, ..base }), "window.v_step_mps");
    }
}
