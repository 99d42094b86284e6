//! Guided DWA: follows the route while no unknown obstacle is on it. Around one, a dynamic window
//! approach drives to a point behind it and from there back to the route.
//!
//! # Source
//! \[ZhuYin2024\]: the evaluation is equation (18), the points of the detour are (19) to (21)
//! (see `detour.rs`), and the order of both is that of its whole algorithm, steps 7 to 10.
//! Equations (11) to (17) are (4) to (8) of \[You2021\], those of [`WindowConfig`].
//!
//! | paper | here | unit | paper's value |
//! |---|---|---|---|
//! | alpha | `weights.heading`, of the heading of the trajectory's end towards the target | | not given |
//! | beta | `weights.target_distance`, of the distance of the end to the target; less is better | | not given |
//! | gamma | `weights.obstacle_distance`, of od: the distance of the end to obstacles | | not given |
//! | psi | division by the sum over all candidates | | |
//! | radius of the invalid zone | `detour.reached_m` | m | not given |
//!
//! # Where this differs from the paper
//! - The paper gives no numbers; those of [`GuidedDwaConfig::PAPER`] are from tables 2 and 3 of
//!   \[You2021\] if they are given there. Its weights are those of the same terms there, 0.08 for
//!   the heading and 0.2 for the distance to obstacles; the distance to the target, which has no
//!   term there, gets the third weight, 0.1.
//! - Equation (16) takes the nearest distance on the trajectory, od of (18) that of its end.
//! - In (18) beta target becomes beta (the largest target of all candidates - target).
//! - An unknown obstacle is on the route if a sensed cell comes nearer than `detour.clearance_m`
//!   to one of the nodes of the route within `detour.look_ahead_m`. Nodes are its points at every
//!   whole cell of arc length, and its end. The obstacle consists of all sensed cells connected
//!   with that cell, within the same distance of the robot.
//! - The follower ignores obstacles, so its command is only issued if the [stop rule](StopRule)
//!   for stationary obstacles admits it, with the margin of the window, or 0.1 mm; otherwise the
//!   dynamic window approach drives to the follower's carrot in that cycle. On routes as smooth
//!   and as far from obstacles as the paper's, that does not happen.
//! - The paper continues with the dynamic window approach while obstacles move. Here everything
//!   is evaluated again in each cycle, moving or not.
//!
//! # Limitations
//! A mirrored point lies straight behind the obstacle, so in front of it every turn increases the
//! costs of heading and target distance. With the weights of [`GuidedDwaConfig::PAPER`], and all
//! others tried that do not weigh od several times as much as the rest, the robot stops there.
//! The caller has to replan with the sensed obstacles.
//!
//! # Errors / cost
//! [`NoCommand`] if no position behind the obstacle is free: the caller is to plan a new route.
//! Otherwise see [`WindowConfig`]. A cycle on the route costs a few distances; one on a detour is
//! linear in the nodes of the remaining route and the cells of the obstacle.

mod detour;
mod obstacle;
mod route_nodes;

pub use detour::DetourConfig;

use super::dynamic_window::{DynamicWindow, Rollout, Term, TermValue, Weighing};
use super::parameters::{BoxedLocalPlanner, LocalParameters};
use super::terms::heading;
use super::{
    Decision, DistanceAt, DriveMemory, Evaluation, Explanation, Follower, FollowerConfig,
    LocalPlanner, NoCommand, Rejections, Scene, Scratch, StopRule, StopRuleConfig, Surroundings,
    WindowConfig,
};
use crate::ConfigError;
use crate::geometry::Point;
use crate::robot::Robot;
use detour::{AllCovered, GuidePoints};
use obstacle::Cluster;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Parameters of [`GuidedDwa`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GuidedDwaConfig {
    /// Candidate velocities around an obstacle, and the rules that refuse them.
    pub window: WindowConfig,
    /// Weights of the evaluation (18).
    pub weights: GuidedWeights,
    /// Detours around obstacles that are not on the known map.
    pub detour: DetourConfig,
    /// The path follower that drives while no unknown obstacle is on the route.
    pub follower: FollowerConfig,
}

/// Weights of the evaluation (18).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GuidedWeights {
    /// alpha: alignment with the target at `window.judged_s`.
    pub heading: f64,
    /// beta: nearness to the target at `window.judged_s`.
    pub target_distance: f64,
    /// gamma: distance to obstacles at the end of the trajectory.
    pub obstacle_distance: f64,
}

impl GuidedWeights {
    fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_weight("heading", self.heading)?;
        ConfigError::unless_weight("target_distance", self.target_distance)?;
        ConfigError::unless_weight("obstacle_distance", self.obstacle_distance)
    }
}

impl GuidedDwaConfig {
    /// As published. The paper gives no numbers: all are readings, from tables 2 and 3 of
    /// \[You2021\] if they are given there.
    pub const PAPER: Self = Self {
        window: WindowConfig { distance_at: DistanceAt::End, ..WindowConfig::PAPER },
        weights: GuidedWeights { heading: 0.08, target_distance: 0.1, obstacle_distance: 0.2 },
        detour: DetourConfig::PAPER,
        follower: FollowerConfig::PAPER,
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
        "weights.target_distance",
        "weights.obstacle_distance",
        "detour.look_ahead_m",
        "detour.clearance_m",
        "detour.reached_m",
        "follower.look_ahead_m",
    ];

    /// Derived from the robot, one rule for all maps: [`WindowConfig::for_robot`] with all terms at
    /// the end, [`DetourConfig::for_robot`] and [`FollowerConfig::for_robot`]. The target weighs
    /// twice as much as obstacles, which the rollout avoids anyway.
    pub fn for_robot(robot: &Robot) -> Self {
        let window = WindowConfig::for_robot(robot);
        let judged_s = window.horizon_s;
        Self {
            window: WindowConfig { distance_at: DistanceAt::End, judged_s, ..window },
            weights: GuidedWeights { heading: 0.08, target_distance: 0.2, obstacle_distance: 0.1 },
            detour: DetourConfig::for_robot(robot),
            follower: FollowerConfig::for_robot(robot),
        }
    }
}

/// The path-guided dynamic window approach of \[ZhuYin2024\].
#[derive(Clone, Debug)]
pub struct GuidedDwa {
    window: DynamicWindow,
    weighing: Weighing<3>,
    detour: DetourConfig,
    follower: Follower,
    rule: StopRule,
}

/// No position behind an obstacle is free.
const COVERED: &str = "covered";

const RULES: [(&str, &str); 1] = [(COVERED, "positions behind an obstacle are not free")];

impl GuidedDwa {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "guided-dwa";

    /// Name of target(v, omega) in an evaluation.
    const TARGET_DISTANCE: &'static str = "target-distance";

    /// Margin of the stop rule if the window has none \[m\].
    const LEAST_MARGIN_M: f64 = 1e-4;

    /// Name of od(v, omega) in an evaluation.
    const OBSTACLE_DISTANCE: &'static str = "obstacle-distance";

    /// Creates a planner for a robot.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] if a value of the robot or the config is invalid, or the two do
    /// not fit together; the error names the field.
    pub fn new(config: GuidedDwaConfig, robot: impl Into<Arc<Robot>>) -> Result<Self, ConfigError> {
        let GuidedDwaConfig { window, weights, detour, follower } = config;
        let margin_m = window.safety_margin_m.max(Self::LEAST_MARGIN_M);
        let robot = robot.into();
        let stop_rule = StopRuleConfig { margin_m, ..StopRuleConfig::for_robot(&robot) };
        let follower = Follower::new(follower, Arc::clone(&robot));
        let window = DynamicWindow::new(window, Arc::clone(&robot))?;
        let follower = follower.map_err(|error| error.within("follower"))?;
        weights.validate().map_err(|error| error.within("weights"))?;
        detour.validate().map_err(|error| error.within("detour"))?;
        let weighing = Weighing([
            Term::of(heading::NAME, weights.heading),
            Term::cost(Self::TARGET_DISTANCE, weights.target_distance),
            Term::of(Self::OBSTACLE_DISTANCE, weights.obstacle_distance),
        ]);
        let rule = StopRule::for_any_brakes(stop_rule, robot)?;
        Ok(Self { window, weighing, detour, follower, rule })
    }

    /// The robot that is driven.
    pub fn robot(&self) -> &Robot {
        self.window.robot()
    }

    /// Drives by eq. (18) towards the guide point of the scene.
    fn drive_to_guide(
        &self,
        scene: &Scene<'_>,
        scratch: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        let terms = |_, rollout: &Rollout| Self::terms(scene, rollout);
        self.window.decide(scene, scratch, &self.weighing, terms)
    }

    fn terms(scene: &Scene<'_>, rollout: &Rollout) -> [TermValue; 3] {
        let Rollout { judged, heading, distance_m } = *rollout;
        [
            TermValue::of(heading),
            TermValue::of(judged.point().distance(scene.guide)),
            TermValue::of(distance_m),
        ]
    }

    /// Step 7: drives along the route.
    fn follow(
        &self,
        scene: &Scene<'_>,
        memory: &mut DriveMemory,
        scratch: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        let decision = self.follower.decide(scene, memory, scratch)?;
        if self.rule.admits(&Surroundings::standing(scene), decision.command, scratch).is_ok() {
            return Ok(decision);
        }
        let guide = self.carrot(scene, memory);
        self.drive_to_guide(&Scene { guide, ..*scene }, scratch)
    }

    /// The follower's carrot on the route, once it has decided.
    fn carrot(&self, scene: &Scene<'_>, memory: &DriveMemory) -> Point {
        self.follower.carrot(scene.path, memory.covered_m).unwrap_or(scene.guide)
    }

    /// Explains the result of [`Self::drive_to_guide`].
    fn explain_towards(&self, scene: &Scene<'_>) -> Explanation {
        let terms = |_, rollout: &Rollout| Self::terms(scene, rollout);
        self.window.explain(scene, &self.weighing, terms)
    }

    /// Explains the result of [`Self::follow`].
    fn explain_following(&self, scene: &Scene<'_>, memory: &mut DriveMemory) -> Explanation {
        let mut scratch = Scratch::default();
        let command = self.follower.decide(scene, memory, &mut scratch).map(|one| one.command);
        let around = Surroundings::standing(scene);
        let guide = self.carrot(scene, memory);
        match command {
            Ok(command) if self.rule.admits(&around, command, &mut scratch).is_err() => {
                self.explain_towards(&Scene { guide, ..*scene })
            }
            _ => Explanation { target: Some(guide), ..Explanation::default() },
        }
    }

    /// No position behind the obstacle is free: brakes, and lets the caller plan a new route.
    fn covered(&self, scene: &Scene<'_>, AllCovered { tried }: AllCovered) -> NoCommand {
        let mut rejected = Rejections::none_by(&RULES);
        (0..tried).for_each(|_| rejected.add(COVERED));
        let evaluation = Evaluation { candidates: tried, rejected, ..Evaluation::default() };
        let Robot { limits, cycle_s, .. } = self.robot();
        NoCommand { evaluation, fallback: limits.braked(scene.velocity, *cycle_s) }
    }
}

impl LocalParameters for GuidedDwaConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self, robot: &Arc<Robot>) -> Result<BoxedLocalPlanner, ConfigError> {
        Ok(Box::new(GuidedDwa::new(self.clone(), Arc::clone(robot))?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        Self::READINGS
    }
}

impl LocalPlanner for GuidedDwa {
    fn decide(
        &self,
        scene: &Scene<'_>,
        memory: &mut DriveMemory,
        scratch: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        let guide_points = GuidePoints { config: &self.detour, scene };
        let cluster: &mut Cluster = scratch.part();
        match guide_points.target(memory, cluster) {
            Ok(None) => self.follow(scene, memory, scratch),
            Ok(Some(guide)) => self.drive_to_guide(&Scene { guide, ..*scene }, scratch),
            Err(all_covered) => Err(self.covered(scene, all_covered)),
        }
    }

    /// While the follower drives along the route there are no candidates.
    fn explain(&self, scene: &Scene<'_>, memory: &DriveMemory) -> Explanation {
        let mut memory = memory.clone();
        let guide_points = GuidePoints { config: &self.detour, scene };
        match guide_points.target(&mut memory, &mut Cluster::default()) {
            Ok(Some(guide)) => self.explain_towards(&Scene { guide, ..*scene }),
            Ok(None) => self.explain_following(scene, &mut memory),
            Err(_) => Explanation::default(),
        }
    }
}

#[cfg(test)]
mod tests;
