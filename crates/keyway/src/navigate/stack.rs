//! One full choice along the pipeline, as data.

use super::RecoveryKind;
use crate::ConfigError;
use crate::guide::GuideConfig;
use crate::local::{LocalConfig, StopRule, StopRuleConfig};
use crate::map::{GridFrame, LayerConfig};
use crate::plan::PlannerConfig;
use crate::robot::Robot;
use crate::sense::{SeenGround, SeenWanted, Tracker, TrackerConfig};
use crate::smooth::{SmootherConfig, UnsmoothedConfig};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;

/// A stack: planner, smoother, guide and local planner with all their parameters. An ablation is
/// another value of this type.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Stack {
    /// How the search's layers follow from the map. `map.clearance_m` is what a route keeps from
    /// obstacles where it can.
    pub map: LayerConfig,
    /// The global planner.
    pub planner: PlannerConfig,
    /// The smoother.
    pub smoother: SmootherConfig,
    /// The guide: which point the local planner drives towards.
    pub guide: GuideConfig,
    /// The local planner.
    pub local: LocalConfig,
    /// The navigation loop.
    pub controller: ControllerConfig,
}

/// Parameters of the navigation loop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own in stack files")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ControllerConfig {
    /// The goal is reached where the robot stands within this distance \[m\]; a way-point is passed
    /// within it.
    pub goal_tolerance_m: f64,
    /// Where the goal has a heading, it is reached within this angle \[rad\].
    pub goal_yaw_tolerance_rad: f64,
    /// What a route keeps from obstacles where `map.clearance_m` leaves no way \[m\].
    pub least_clearance_m: f64,
    /// The error that a start may have \[m\]: where the robot touches something there, but nothing
    /// at a place as near as this, it begins, and leaves what is too near. 0 refuses every such
    /// start, also in stack files that do not have it.
    #[serde(default)]
    pub start_error_m: f64,
    /// Plan again as soon as something sensed is too near to the rest of the route; and drive to a
    /// place of the route that is in sight while the guide point is not.
    pub watch_route: bool,
    /// Where movers walk to and fro on the way, go around the ground on which they are seen, once
    /// that takes no longer than the robot has been held up beside it. Needs `movers`; false in
    /// stack files that do not have it.
    #[serde(default)]
    pub go_around: bool,
    /// Drive to a place beside the way of somebody who comes towards the robot where two cannot pass,
    /// and let them pass, if that place is nearer than theirs. Needs `movers`; false in stack files
    /// that do not have it.
    #[serde(default)]
    pub make_way: bool,
    /// A recovery begins when nothing lets the robot drive for this long \[s\].
    pub blocked_s: f64,
    /// A recovery begins when the remaining way has not become shorter for this long \[s\], by 5 cm
    /// or by a tenth of what a slow robot drives in that time, nor the robot has turned towards it.
    pub no_progress_s: f64,
    /// What is tried when the robot gets no farther, one kind after the other until it does; then
    /// from the beginning. Where `turn` is among them, a robot that is not round also turns before
    /// it drives where it could not.
    pub recoveries: Cow<'static, [RecoveryKind]>,
    /// How far `back-up` goes back at most \[m\].
    pub back_up_m: f64,
    /// How long `wait` waits \[s\].
    pub wait_s: f64,
    /// A new route is given up after this many expanded nodes: planning must not hold up the
    /// control cycle for long.
    pub replan_budget: u64,
    /// After a new route was not found, the next attempt is made `blocked_s` later, then twice as
    /// much later each time, up to this \[s\]. Nor does the robot wait longer than this for
    /// something that moves before it counts as getting no farther.
    pub longest_wait_s: f64,
    /// Reaction to a way-point to which there is no route twice in turn, such as one on which
    /// something stands. `wait` in stack files that do not have it.
    #[serde(default)]
    pub if_way_point_blocked: IfWayPointBlocked,
    /// Stop while the sensors say nothing for longer than their time-outs (`sensors.timeout_s` of
    /// the robot), and before they have said anything: all of them, or one where the robot need not
    /// stay within ground that it has seen. True in stack files that do not have it.
    #[serde(default = "yes")]
    pub stop_when_blind: bool,
    /// How what moves is told from what stands. Without it everything counts as standing where it
    /// was seen last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub movers: Option<TrackerConfig>,
    /// The stop rule, through which every command goes, whoever gave it; it needs `movers`. Without
    /// it commands are issued as they were decided.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub safe: Option<StopRuleConfig>,
}

/// Reaction to a way-point that cannot be reached for now. The goal is always waited for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum IfWayPointBlocked {
    /// The robot goes on trying, as for the goal.
    #[default]
    Wait,
    /// It passes the nearest place with room for it instead, no farther than a metre or twice its
    /// diameter from the way-point; where there is none it skips the way-point.
    PassNear,
    /// It goes on to the next one.
    Skip,
}

const fn yes() -> bool {
    true
}

impl ControllerConfig {
    /// For \[You2021\], whose robot is a point that plans once and never again: a new route is
    /// planned only where it would otherwise stand still for ever.
    pub const PAPER: Self = Self {
        goal_tolerance_m: 0.5,
        goal_yaw_tolerance_rad: 0.05,
        least_clearance_m: 0.0,
        start_error_m: 0.0,
        watch_route: false,
        go_around: false,
        make_way: false,
        recoveries: Cow::Borrowed(&[RecoveryKind::Replan]),
        back_up_m: 1.0,
        wait_s: 2.0,
        blocked_s: 1.0,
        no_progress_s: 3.0,
        replan_budget: 1_000_000,
        longest_wait_s: 8.0,
        if_way_point_blocked: IfWayPointBlocked::Wait,
        stop_when_blind: false,
        movers: None,
        safe: None,
    };

    /// Fields for which the paper gives no value: all of them.
    pub const READINGS: &'static [&'static str] = &[
        "goal_tolerance_m",
        "goal_yaw_tolerance_rad",
        "least_clearance_m",
        "start_error_m",
        "watch_route",
        "go_around",
        "make_way",
        "blocked_s",
        "no_progress_s",
        "recoveries",
        "back_up_m",
        "wait_s",
        "replan_budget",
        "longest_wait_s",
        "if_way_point_blocked",
        "stop_when_blind",
        "movers",
        "safe",
    ];

    /// The usual error of a localisation by scans \[m\]; a cell of most maps.
    const START_ERROR_M: f64 = 0.05;

    /// Derived from the robot: the goal tolerance is 0.15 m or half the inscribed radius, whichever
    /// is larger; the least clearance is the inscribed radius and the margin that the local planner
    /// keeps. The route is watched, a start may be off by 5 cm (a cell of most maps, and what a
    /// localisation by scans is off), the robot goes around movers that hold it up and makes way
    /// where two cannot pass, all recoveries are tried, and it goes back by up to twice its
    /// circumscribed radius. Movers are followed; there is no stop rule. A robot that sees nothing
    /// stops.
    pub fn for_robot(robot: &Robot) -> Self {
        Self {
            goal_tolerance_m: (0.5 * robot.footprint.inscribed_radius_m()).max(0.15),
            least_clearance_m: robot.footprint.inscribed_radius_m() + robot.safety_margin_m(),
            start_error_m: Self::START_ERROR_M,
            watch_route: true,
            go_around: true,
            make_way: true,
            recoveries: Cow::Borrowed(&[
                RecoveryKind::Replan,
                RecoveryKind::Turn,
                RecoveryKind::Manoeuvre,
                RecoveryKind::BackUp,
                RecoveryKind::Wait,
            ]),
            if_way_point_blocked: IfWayPointBlocked::PassNear,
            stop_when_blind: true,
            back_up_m: (2.0 * robot.footprint.circumscribed_radius_m()).max(0.1),
            movers: Some(TrackerConfig::default()),
            ..Self::PAPER
        }
    }

    /// The same with the stop rule for a robot, and movers followed, which it needs.
    #[must_use]
    pub fn with_stop_rule(self, robot: &Robot) -> Self {
        let movers = self.movers.or_else(|| Some(TrackerConfig::default()));
        let safe = self.safe.or_else(|| Some(StopRuleConfig::for_robot(robot)));
        Self { movers, safe, ..self }
    }
}

impl ControllerConfig {
    /// Checks the values of its own; those of its tracker and its stop rule are checked when they
    /// are built.
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        ConfigError::unless_positive("goal_tolerance_m", self.goal_tolerance_m)?;
        ConfigError::unless_positive("goal_yaw_tolerance_rad", self.goal_yaw_tolerance_rad)?;
        ConfigError::unless_positive("blocked_s", self.blocked_s)?;
        ConfigError::unless_positive("no_progress_s", self.no_progress_s)?;
        ConfigError::unless_positive("longest_wait_s", self.longest_wait_s)?;
        ConfigError::unless_positive("back_up_m", self.back_up_m)?;
        ConfigError::unless_not_negative("wait_s", self.wait_s)?;
        ConfigError::unless_not_negative("least_clearance_m", self.least_clearance_m)?;
        ConfigError::unless_not_negative("start_error_m", self.start_error_m)?;
        if self.go_around && self.movers.is_none() {
            let reason = "needs `controller.movers`: movers that are not told apart cannot be gone around; set it to false";
            return Err(ConfigError::new("go_around", reason));
        }
        if self.make_way && self.movers.is_none() {
            let reason =
                "needs `controller.movers`: nobody is seen to come otherwise; set it to false";
            return Err(ConfigError::new("make_way", reason));
        }
        Ok(())
    }

    /// What tells movers apart, if anything does.
    pub(super) fn build_tracker(&self) -> Result<Option<Tracker>, ConfigError> {
        let tracker = self.movers.clone().map(Tracker::new).transpose();
        tracker.map_err(|error| error.within("movers"))
    }

    /// How fast somebody may walk up behind a robot that does not look there \[m/s\]; 0 without a
    /// stop rule.
    pub(super) fn walker_mps(&self) -> f64 {
        self.safe.as_ref().map_or(0.0, |safe| safe.movers.speed_mps)
    }

    /// The stop rule, if there is one.
    pub(super) fn build_stop_rule(
        &self,
        robot: &Arc<Robot>,
    ) -> Result<Option<StopRule>, ConfigError> {
        let Some(safe) = &self.safe else { return Ok(None) };
        if self.movers.is_none() {
            let reason = "needs `controller.movers`: who does not tell movers apart cannot keep clear of them";
            return Err(ConfigError::new("safe", reason));
        }
        let rule = StopRule::new(safe.clone(), Arc::clone(robot));
        rule.map(Some).map_err(|error| error.within("safe"))
    }
}

impl Stack {
    /// The memory of ground that the robot has seen, as far as its stop rule or its local planner
    /// ask for it.
    pub(super) fn build_seen_ground(&self, frame: &GridFrame, robot: &Robot) -> Option<SeenGround> {
        let looks_ahead = self.controller.safe.is_some() || self.local.stops_within_sight();
        let wanted = if looks_ahead { SeenWanted::AheadAndBehind } else { SeenWanted::Behind };
        SeenGround::new(frame, robot, self.controller.walker_mps(), wanted)
    }

    /// The same with the stop rule for a robot ([`ControllerConfig::with_stop_rule`]).
    #[must_use]
    pub fn with_stop_rule(self, robot: &Robot) -> Self {
        Self { controller: self.controller.with_stop_rule(robot), ..self }
    }

    /// The same, with the stop rule where it is to be safe.
    #[must_use]
    pub fn safe_if(self, safe: bool, robot: &Robot) -> Self {
        if safe { self.with_stop_rule(robot) } else { self }
    }

    /// The parameters for plans without driving, unless others are asked for: those of the usual
    /// stack, but for a point, and not smoothed.
    pub fn for_plans(robot: &Robot) -> Self {
        let stack = Self::keyway(robot);
        let map = LayerConfig { clearance_m: 0.0, ..stack.map };
        Self { map, smoother: SmootherConfig::None(UnsmoothedConfig::default()), ..stack }
    }
}
