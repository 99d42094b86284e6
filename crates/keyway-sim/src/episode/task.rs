//! One robot's part of a run: its inputs, and the results before and after driving.

use super::{
    Episode, EpisodeError, EpisodeOutcome, EpisodeRobot, EpisodeRules, RobotReport, RunError,
};
use crate::report::{Clock, Inputs, Parameters, PlanPart, timed};
use crate::sim::{ElusiveObstacle, RunRules, World};
use keyway::ConfigError;
use keyway::geometry::{Disc, Pose};
use keyway::map::{BitGrid, Clearance, LayerConfig, SearchMap, UnknownPolicy};
use keyway::navigate::{FittedStack, NavigateError, WayProgress, touches};
use keyway::plan::{Plan, PlanError};
use keyway::route::Route;
use keyway::search::{Query, SearchStatistics, Workspace};

/// A robot of an episode.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub(super) episode: &'a Episode,
    pub(super) robot: &'a EpisodeRobot,
    /// Index of the robot if there are several.
    index: Option<usize>,
}

impl<'a> Task<'a> {
    /// Robot of this index.
    pub(super) fn new(episode: &'a Episode, index: usize) -> Self {
        let is_alone = episode.robots.len() == 1;
        Self { episode, robot: &episode.robots[index], index: (!is_alone).then_some(index) }
    }

    /// Attributes an error to the robot.
    pub(super) fn blame(&self, why: impl Into<RunError>) -> EpisodeError {
        EpisodeError::of_robot(self.index, why)
    }
}

impl Task<'_> {
    /// Builds the robot's stack.
    pub(super) fn fit(&self) -> Result<FittedStack, EpisodeError> {
        let fitted = self.robot.stack.fit(&self.robot.robot);
        fitted.map_err(|error| self.blame(NavigateError::from(error)))
    }

    /// Cells that are obstacles on the robot's map, under its policy for unknown cells.
    pub(super) fn known_squares(&self) -> BitGrid {
        let mut squares = self.episode.known.occupied().clone();
        if self.robot.stack.map.unknown == UnknownPolicy::Blocked {
            squares.merge(self.episode.known.unknown());
        }
        squares
    }

    /// Returns the robot's pose at the beginning of a route.
    ///
    /// # Errors
    /// Returns an error if the robot touches a known obstacle there. Contact with an unknown
    /// obstacle ends the simulated run instead.
    pub(super) fn start_pose(&self, world: &World, route: &Route) -> Result<Pose, NavigateError> {
        let footprint = &self.robot.robot.footprint;
        let at_start = world.at(0.0);
        let has_room = |pose| {
            let border_m = at_start.border_distance(footprint, pose);
            at_start.distance(footprint, pose, f64::INFINITY).min(border_m) > 0.0
        };
        let pose = self.robot.start.pose(route, has_room);
        let squares = self.known_squares();
        if !touches(footprint, pose, &Clearance::new(world.frame(), &squares)) {
            return Ok(pose);
        }
        let map = SearchMap::new(&self.episode.known, LayerConfig::default())
            .map_err(|error| error.within("map"))?;
        Err(NavigateError::StartTouches {
            position: pose.point(),
            heading_rad: self.robot.start.heading_rad,
            footprint: footprint.clone(),
            why: map.hindrance(pose.point()),
        })
    }

    /// Returns the rules for a path of this length \[m\].
    pub(super) fn run_rules(&self, length_m: f64) -> RunRules {
        let EpisodeRules {
            goal_tolerance_m,
            arrival,
            reached_by,
            time_limit_s,
            stuck_window_s,
            stuck_progress_m,
            ..
        } = self.episode.rules;
        let usual_s = 60.0 + 4.0 * length_m / self.robot.robot.limits.v_max_mps;
        let usual_m = WayProgress::step_m(&self.robot.robot, stuck_window_s);
        RunRules {
            goal_tolerance_m: goal_tolerance_m
                .unwrap_or(self.robot.stack.controller.goal_tolerance_m),
            arrival,
            reached_by,
            time_limit_s: time_limit_s.unwrap_or(usual_s),
            stuck_window_s,
            stuck_progress_m: stuck_progress_m.unwrap_or(usual_m),
        }
    }

    /// Returns the layers on which a route was planned.
    pub(super) fn layer_of(&self, route: &Route) -> Result<SearchMap, ConfigError> {
        let config = LayerConfig { clearance_m: route.clearance_m, ..self.robot.stack.map.clone() };
        SearchMap::new(&self.episode.known, config).map_err(|error| error.within("map"))
    }

    /// Reports the first route. Its query is repeated on prepared layers only to measure its
    /// time.
    pub(super) fn plan_part(&self, route: &Route, map: &SearchMap, clock: Clock<'_>) -> PlanPart {
        let planner = &self.robot.stack.planner;
        let time_s = self.search_time_s(route, map, clock);
        PlanPart::found(planner.name(), &route.plan, &route.line, map, time_s)
    }

    fn search_time_s(&self, route: &Route, map: &SearchMap, clock: Clock<'_>) -> Option<f64> {
        clock?;
        let planner = self.robot.stack.planner.build(map).ok()?;
        let (&from, to) = (route.plan.cells.first()?, route.plan.reached()?);
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        let query = Query::new(from, to);
        // The route shows that a path exists.
        timed(clock, || planner.plan_into(map, &query, &mut workspace, None, &mut plan)).1
    }

    /// Report of a robot without a route; `None` for every other error, which is invalid input.
    pub(super) fn without_route(&self, error: &NavigateError) -> Option<RobotReport> {
        let planner = self.robot.stack.planner.name();
        // The cause of an unreachable way-point.
        let cause = match error {
            NavigateError::WayPoint { why, .. } => why,
            error => error,
        };
        let plan = match cause {
            NavigateError::Plan(error) => PlanPart::failed(planner, error, None),
            NavigateError::NoWay { why } => {
                let statistics = SearchStatistics::default();
                PlanPart::failed(planner, &PlanError::NoPath { statistics }, None)
                    .map(|part| part.separated_by(why, error.to_string()))
            }
            _ => None,
        }?;
        Some(RobotReport {
            schema: RobotReport::SCHEMA,
            outcome: EpisodeOutcome::NoPath,
            reason: plan.why.clone(),
            plan,
            smoothed: None,
            key_points_m: None,
            misfit: None,
            noticed: None,
            run: None,
            trajectory: None,
            inputs: self.inputs(self.episode.rules.time_limit_s),
        })
    }

    /// True if the run depends on the seed of the disturbances.
    fn has_random_numbers(&self) -> bool {
        let is_glimpsed = |it: &ElusiveObstacle| !matches!(it.presence().seen, 0.0 | 1.0);
        !self.robot.disturbances.is_none() || self.episode.elusive.iter().any(is_glimpsed)
    }

    /// Returns all inputs of the result; `time_limit_s` is the limit of this run.
    pub(super) fn inputs(&self, time_limit_s: Option<f64>) -> Inputs {
        let to_row = |circle: &Disc| [circle.centre.x, circle.centre.y, circle.radius_m];
        Inputs {
            version: Inputs::VERSION,
            map: self.episode.source.name.clone(),
            map_digest: self.episode.source.digest.clone(),
            placement: self.episode.source.placement,
            robot: Some(self.robot.robot.clone()),
            stack: Some(self.robot.stack_name.clone()),
            config: Parameters::Run(Box::new(self.robot.stack.clone())),
            start: self.robot.start.into(),
            goal: self.robot.goal.into(),
            goals: None,
            via: (!self.robot.via.is_empty()).then(|| self.robot.via.clone()),
            nearest_reachable: None,
            obstacles: self.episode.obstacles.iter().map(to_row).collect(),
            polygons: self.episode.polygons.clone(),
            hidden_cells: self.episode.hidden_cells.clone(),
            absent_cells: self.episode.absent_cells.clone(),
            elusive: self.episode.elusive.clone(),
            moving: self.episode.movers.clone(),
            random: self.episode.random,
            disturbances: self.has_random_numbers().then(|| self.robot.disturbances.clone()),
            goal_tolerance_m: self.episode.rules.goal_tolerance_m,
            arrival: Some(self.episode.rules.arrival),
            reached_by: Some(self.episode.rules.reached_by),
            time_limit_s,
            stuck_window_s: Some(self.episode.rules.stuck_window_s),
            budget: None,
        }
    }
}
