//! The parts of the pipeline and their parameters, as data.

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
    /// Layers of the search, derived from the map. `map.clearance_m` is the clearance that a
    /// route keeps from obstacles if possible.
    pub map: LayerConfig,
    /// The global planner.
    pub planner: PlannerConfig,
    /// The smoother.
    pub smoother: SmootherConfig,
    /// The guide, which chooses the point that the local planner drives towards.
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
    /// Position tolerance of the goal, at which the robot must be stationary; a way-point is
    /// passed within it \[m\].
    pub goal_tolerance_m: f64,
    /// Heading tolerance of a goal with a heading \[rad\].
    pub goal_yaw_tolerance_rad: f64,
    /// Clearance of a route if no path keeps `map.clearance_m`, or only too long a one \[m\].
    pub least_clearance_m: f64,
    /// Longest detour of a new route for more clearance than `least_clearance_m` \[m\]. A route
    /// that is planned among sensed obstacles uses the map layer with the largest clearance on
    /// which it is at most this much longer than on the one with the least. It uses the largest
    /// of all, however long that is, once the robot has made no progress on its leg, or has taken
    /// detours around gaps that closed, of more than this or 2 m altogether; and so does the route
    /// that a new goal finds on the map alone. 2 m in stack files without this field.
    #[serde(default = "two_metres")]
    pub detour_for_clearance_m: f64,
    /// Tolerated error of a start \[m\]: a robot that touches an obstacle there, but none at a
    /// position within this distance, starts, and leaves the obstacle first. 0 rejects every such
    /// start, also in stack files without this field.
    #[serde(default)]
    pub start_error_m: f64,
    /// Replan as soon as a sensed obstacle is too close to the rest of the route, and drive to a
    /// point of the route in line of sight while the guide point is not.
    pub watch_route: bool,
    /// Take a detour around the area in which moving obstacles walk back and forth on the route,
    /// once it takes no longer than the robot has been held up. Needs `movers`; false in stack
    /// files without this field.
    #[serde(default)]
    pub go_around: bool,
    /// Let an oncoming moving obstacle pass where two cannot, at a position beside its path, if
    /// that position is closer than its own. Needs `movers`; false in stack files without this
    /// field.
    #[serde(default)]
    pub make_way: bool,
    /// Time without an admissible motion after which a recovery starts \[s\].
    pub blocked_s: f64,
    /// Time without progress after which a recovery starts \[s\]. Progress is a decrease of the
    /// remaining path length by 5 cm, or for a slow robot by a tenth of the distance that it
    /// covers in that time, or a rotation towards the route.
    pub no_progress_s: f64,
    /// Recoveries of a robot that makes no progress, tried one after the other until it does;
    /// then from the start. With `turn` among them, a non-circular robot also rotates before it
    /// drives to where it could not.
    pub recoveries: Cow<'static, [RecoveryKind]>,
    /// Maximum distance of `back-up` \[m\].
    pub back_up_m: f64,
    /// Duration of `wait` \[s\].
    pub wait_s: f64,
    /// Node budget of each search for a new route: planning must not hold up the control cycle for
    /// long.
    pub replan_budget: u64,
    /// Longest waiting time \[s\]. After a failed search for a route, the next attempt follows
    /// after `blocked_s`, then after twice as long each time, up to this limit. The robot also
    /// waits no longer than this for a moving obstacle before it counts as making no progress.
    pub longest_wait_s: f64,
    /// Reaction to a way-point to which two searches in a row find no route, for example an
    /// occupied one. `wait` in stack files without this field.
    #[serde(default)]
    pub if_way_point_blocked: IfWayPointBlocked,
    /// Stop while the sensors have had no valid reading for longer than their time-outs
    /// (`sensors.timeout_s` of the robot), and before the first one. Applies to all sensors, or
    /// to any one of them if the robot need not stay within observed free space. True in stack
    /// files without this field.
    #[serde(default = "yes")]
    pub stop_when_blind: bool,
    /// Tracking of moving obstacles. Without it, everything counts as stationary at its last
    /// sensed position.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub movers: Option<TrackerConfig>,
    /// The stop rule, which checks every command, whatever its source; it needs `movers`. Without
    /// it, commands are issued as decided.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub safe: Option<StopRuleConfig>,
}

/// Reaction to a way-point that cannot be reached at present. The goal is never skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum IfWayPointBlocked {
    /// Keep trying, as for the goal.
    #[default]
    Wait,
    /// Pass the nearest position with enough clearance instead, at most a metre or twice the
    /// robot's diameter from the way-point; without one, skip the way-point.
    PassNear,
    /// Continue to the next way-point.
    Skip,
}

const fn yes() -> bool {
    true
}

const fn two_metres() -> f64 {
    ControllerConfig::PAPER.detour_for_clearance_m
}

impl ControllerConfig {
    /// Values for \[You2021\], whose robot is a point that plans only once. A new route is
    /// planned only if the robot would otherwise stay stationary forever.
    pub const PAPER: Self = Self {
        goal_tolerance_m: 0.5,
        goal_yaw_tolerance_rad: 0.05,
        least_clearance_m: 0.0,
        detour_for_clearance_m: 2.0,
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
        "detour_for_clearance_m",
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

    /// Usual error of a scan-based localisation \[m\]; a cell of most maps.
    const START_ERROR_M: f64 = 0.05;

    /// Tolerance of the goal heading for a car-like robot \[rad\].
    const CAR_YAW_RAD: f64 = 0.1;

    /// Derives the parameters from the robot. The goal tolerance is 0.15 m or half the inscribed
    /// radius, whichever is larger; the tolerance of its heading is 0.05 rad, or 0.1 rad for a
    /// car-like robot; the least clearance is the inscribed radius plus the margin of the local
    /// planner; and the start tolerance is 5 cm (a cell of most maps, and the usual error of a
    /// scan-based localisation). The route is watched, the robot takes detours around moving
    /// obstacles that hold it up and makes way where two cannot pass, all recoveries are enabled,
    /// and it backs up by at most twice its circumscribed radius. Moving obstacles are tracked;
    /// there is no stop rule. A blind robot stops.
    pub fn for_robot(robot: &Robot) -> Self {
        // A car-like robot has no last turn in place.
        let turns = robot.limits.turns_in_place();
        let yaw_rad = if turns { Self::PAPER.goal_yaw_tolerance_rad } else { Self::CAR_YAW_RAD };
        Self {
            goal_yaw_tolerance_rad: yaw_rad,
            goal_tolerance_m: (0.5 * robot.footprint.inscribed_radius_m()).max(0.15),
            least_clearance_m: robot.footprint.inscribed_radius_m()
                + robot.safety_margin_or_default_m(),
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

    /// Adds the stop rule for a robot, and the tracking of moving obstacles, which it needs.
    #[must_use]
    pub fn with_stop_rule(self, robot: &Robot) -> Self {
        let movers = self.movers.or_else(|| Some(TrackerConfig::default()));
        let safe = self.safe.or_else(|| Some(StopRuleConfig::for_robot(robot)));
        Self { movers, safe, ..self }
    }
}

impl ControllerConfig {
    /// Checks its own values; those of the tracker and the stop rule are checked when these are
    /// built.
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        ConfigError::unless_positive("goal_tolerance_m", self.goal_tolerance_m)?;
        ConfigError::unless_positive("goal_yaw_tolerance_rad", self.goal_yaw_tolerance_rad)?;
        ConfigError::unless_positive("blocked_s", self.blocked_s)?;
        ConfigError::unless_positive("no_progress_s", self.no_progress_s)?;
        ConfigError::unless_positive("longest_wait_s", self.longest_wait_s)?;
        ConfigError::unless_positive("back_up_m", self.back_up_m)?;
        ConfigError::unless_not_negative("wait_s", self.wait_s)?;
        ConfigError::unless_not_negative("least_clearance_m", self.least_clearance_m)?;
        let detour_m = self.detour_for_clearance_m;
        ConfigError::unless_not_negative("detour_for_clearance_m", detour_m)?;
        ConfigError::unless_not_negative("start_error_m", self.start_error_m)?;
        if self.go_around && self.movers.is_none() {
            let reason = "needs `controller.movers`: the robot cannot go around moving obstacles \
                          without tracking them; set it to false";
            return Err(ConfigError::new("go_around", reason));
        }
        if self.make_way && self.movers.is_none() {
            let reason = "needs `controller.movers`: oncoming obstacles are not detected otherwise; set it to false";
            return Err(ConfigError::new("make_way", reason));
        }
        Ok(())
    }

    /// The tracker of moving obstacles, if it is enabled.
    pub(super) fn build_tracker(&self) -> Result<Option<Tracker>, ConfigError> {
        let tracker = self.movers.clone().map(Tracker::new).transpose();
        tracker.map_err(|error| error.within("movers"))
    }

    /// Maximum speed of a pedestrian that approaches from behind a robot without rear sensing
    /// \[m/s\]; 0 without a stop rule.
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
            let reason = "needs `controller.movers`: without tracking, it cannot keep clear of \
                          moving obstacles";
            return Err(ConfigError::new("safe", reason));
        }
        let rule = StopRule::new(safe.clone(), Arc::clone(robot));
        rule.map(Some).map_err(|error| error.within("safe"))
    }
}

impl Stack {
    /// The observed free space, as far as the stop rule or the local planner needs it.
    pub(super) fn build_seen_ground(&self, frame: &GridFrame, robot: &Robot) -> Option<SeenGround> {
        let looks_ahead = self.controller.safe.is_some() || self.local.stops_within_sight();
        let wanted = if looks_ahead { SeenWanted::AheadAndBehind } else { SeenWanted::Behind };
        SeenGround::new(frame, robot, self.controller.walker_mps(), wanted)
    }

    /// Adds the stop rule for a robot ([`ControllerConfig::with_stop_rule`]).
    #[must_use]
    pub fn with_stop_rule(self, robot: &Robot) -> Self {
        Self { controller: self.controller.with_stop_rule(robot), ..self }
    }

    /// Adds the stop rule if `safe`.
    #[must_use]
    pub fn safe_if(self, safe: bool, robot: &Robot) -> Self {
        if safe { self.with_stop_rule(robot) } else { self }
    }

    /// Default parameters for plans without driving: those of the default stack, but for a point
    /// robot and without smoothing.
    pub fn for_plans(robot: &Robot) -> Self {
        let stack = Self::keyway(robot);
        let map = LayerConfig { clearance_m: 0.0, ..stack.map };
        Self { map, smoother: SmootherConfig::None(UnsmoothedConfig::default()), ..stack }
    }
}
