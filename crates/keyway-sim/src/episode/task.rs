//! One robot's part of a run: its inputs, and the results before and after driving.

use super::{Episode, EpisodeOutcome, EpisodeReport, EpisodeRules, Start};
use crate::report::{Clock, Inputs, MapSource, Parameters, Placed, PlanPart, timed};
use crate::sim::{Circle, Disturbances, Mover, RunRules, StandingPolygon, World};
use keyway::ConfigError;
use keyway::geometry::{Point, Pose};
use keyway::map::{BitGrid, Cell, Clearance, LayerConfig, OccupancyGrid, SearchMap, UnknownPolicy};
use keyway::navigate::{FittedStack, Goal, NavigateError, Progress, Stack, touches};
use keyway::plan::{Plan, PlanError};
use keyway::robot::Robot;
use keyway::route::Route;
use keyway::search::{Query, SearchStatistics, Workspace};

/// A robot with its stack, its route, and the world in which it drives, alone or with others. The
/// fields are those of [`Episode`].
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub(super) known: &'a OccupancyGrid,
    pub(super) source: &'a MapSource,
    pub(super) obstacles: &'a [Circle],
    pub(super) polygons: &'a [StandingPolygon],
    pub(super) hidden_cells: &'a [Cell],
    pub(super) movers: &'a [Mover],
    pub(super) random: Option<Placed>,
    pub(super) rules: &'a EpisodeRules,
    pub(super) robot: &'a Robot,
    pub(super) disturbances: Disturbances,
    pub(super) stack: &'a Stack,
    pub(super) stack_name: &'a str,
    pub(super) start: Start,
    pub(super) via: &'a [Point],
    pub(super) goal: Goal,
}

impl Episode {
    pub(super) fn task(&self) -> Task<'_> {
        Task {
            known: &self.known,
            source: &self.source,
            obstacles: &self.obstacles,
            polygons: &self.polygons,
            hidden_cells: &self.hidden_cells,
            movers: &self.movers,
            random: self.random,
            rules: &self.rules,
            robot: &self.robot,
            disturbances: self.disturbances,
            stack: &self.stack,
            stack_name: &self.stack_name,
            start: self.start,
            via: &self.via,
            goal: self.goal,
        }
    }
}

impl Task<'_> {
    /// Its stack, built for its robot.
    pub(super) fn fit(&self) -> Result<FittedStack, NavigateError> {
        Ok(self.stack.fit(self.robot)?)
    }

    /// Cells that the robot knows to be obstacles, under its policy for unknown cells.
    pub(super) fn known_squares(&self) -> BitGrid {
        let mut squares = self.known.occupied().clone();
        if self.stack.map.unknown == UnknownPolicy::Blocked {
            squares.merge(self.known.unknown());
        }
        squares
    }

    /// Returns the robot's pose at the beginning of a route.
    ///
    /// # Errors
    /// When the robot touches a known obstacle there. Unknown obstacles are met while driving or
    /// standing.
    pub(super) fn start_pose(&self, world: &World, route: &Route) -> Result<Pose, NavigateError> {
        let footprint = &self.robot.footprint;
        let at_start = world.at(0.0);
        let has_room = |pose| {
            let border_m = at_start.border_distance(footprint, pose);
            at_start.distance(footprint, pose, f64::INFINITY).min(border_m) > 0.0
        };
        let pose = self.start.pose(route, has_room);
        let squares = self.known_squares();
        if !touches(footprint, pose, &Clearance::new(world.frame(), &squares)) {
            return Ok(pose);
        }
        let map = SearchMap::new(self.known, LayerConfig::default())
            .map_err(|error| error.within("map"))?;
        Err(NavigateError::StartTouches {
            position: pose.point(),
            heading_rad: self.start.heading_rad,
            footprint: footprint.clone(),
            why: map.hindrance(pose.point()),
        })
    }

    /// Returns the rules for a path of this length \[m\].
    pub(super) fn run_rules(&self, length_m: f64) -> RunRules {
        let EpisodeRules {
            goal_tolerance_m,
            arrival,
            time_limit_s,
            stuck_window_s,
            stuck_progress_m,
        } = *self.rules;
        let usual_s = 60.0 + 4.0 * length_m / self.robot.limits.v_max_mps;
        let usual_m = Progress::step_m(self.robot, stuck_window_s);
        RunRules {
            goal_tolerance_m: goal_tolerance_m.unwrap_or(self.stack.controller.goal_tolerance_m),
            arrival,
            time_limit_s: time_limit_s.unwrap_or(usual_s),
            stuck_window_s,
            stuck_progress_m: stuck_progress_m.unwrap_or(usual_m),
        }
    }

    /// Returns the layers on which a route was planned.
    pub(super) fn layer_of(&self, route: &Route) -> Result<SearchMap, ConfigError> {
        let config = LayerConfig { clearance_m: route.clearance_m, ..self.stack.map.clone() };
        SearchMap::new(self.known, config).map_err(|error| error.within("map"))
    }

    /// Reports the first route; its query is repeated on prepared layers, only to measure its time.
    pub(super) fn plan_part(&self, route: &Route, map: &SearchMap, clock: Clock<'_>) -> PlanPart {
        let planner = &self.stack.planner;
        let time_s = self.search_time_s(route, map, clock);
        PlanPart::found(planner.name(), &route.plan, &route.line, map, time_s)
    }

    fn search_time_s(&self, route: &Route, map: &SearchMap, clock: Clock<'_>) -> Option<f64> {
        clock?;
        let planner = self.stack.planner.build(map).ok()?;
        let (&from, to) = (route.plan.cells.first()?, route.plan.reached()?);
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        let query = Query::new(from, to);
        // The route shows that a path exists.
        timed(clock, || planner.plan_into(map, &query, &mut workspace, None, &mut plan)).1
    }

    /// Report of a start without a route; `None` for every other error, which is bad input.
    pub(super) fn without_route(&self, error: &NavigateError) -> Option<EpisodeReport> {
        let planner = self.stack.planner.name();
        // For a way-point that cannot be reached, the cause of that.
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
        Some(EpisodeReport {
            schema: EpisodeReport::SCHEMA,
            outcome: EpisodeOutcome::NoPath,
            reason: plan.why.clone(),
            plan,
            smoothed: None,
            key_points_m: None,
            misfit: None,
            run: None,
            trajectory: None,
            inputs: self.inputs(self.rules.time_limit_s),
        })
    }

    /// Returns all inputs of the result; `time_limit_s` is the limit of this run.
    pub(super) fn inputs(&self, time_limit_s: Option<f64>) -> Inputs {
        let to_row = |circle: &Circle| [circle.centre.x, circle.centre.y, circle.radius_m];
        Inputs {
            version: Inputs::VERSION,
            map: self.source.name.clone(),
            map_digest: self.source.digest.clone(),
            placement: self.source.placement,
            robot: Some(self.robot.clone()),
            stack: Some(self.stack_name.to_owned()),
            config: Parameters::Run(Box::new(self.stack.clone())),
            start: self.start.into(),
            goal: self.goal.into(),
            goals: None,
            via: (!self.via.is_empty()).then(|| self.via.to_vec()),
            nearest_reachable: None,
            obstacles: self.obstacles.iter().map(to_row).collect(),
            polygons: self.polygons.to_vec(),
            hidden_cells: self.hidden_cells.to_vec(),
            moving: self.movers.to_vec(),
            random: self.random,
            disturbances: (!self.disturbances.is_none()).then_some(self.disturbances),
            goal_tolerance_m: self.rules.goal_tolerance_m,
            arrival: Some(self.rules.arrival),
            time_limit_s,
            stuck_window_s: Some(self.rules.stuck_window_s),
            budget: None,
        }
    }
}
