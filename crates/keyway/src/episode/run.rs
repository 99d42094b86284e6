//! From an episode to its report.

use super::{Cycle, Episode, EpisodeObserver, EpisodeOutcome, EpisodeReport, EpisodeRules};
use crate::ConfigError;
use crate::geometry::{Point, Pose, Velocity};
use crate::map::{Clearance, LayerConfig, SearchMap, UnknownPolicy};
use crate::metrics::Mrpb;
use crate::navigate::{Blocked, Controller, NavigateError, Parts, Step, touches};
use crate::plan::{Plan, PlanError};
use crate::report::{
    Clock, Controlled, Inputs, Parameters, PlanPart, RunPart, SmoothedPart, WayPointPart, timed,
    trajectory_row,
};
use crate::route::Route;
use crate::search::{Query, SearchStatistics, Workspace};
use crate::sense::Scan;
use crate::sim::{
    Action, Circle, Control, Obstacle, Outcome, Participant, Run, RunRules, SimError, World,
    WorldError, simulate,
};
use thiserror::Error;

/// Why an episode cannot be run. A start without a route to the goal is not an error but a report.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EpisodeError {
    /// The robot, the stack, the start or the goal cannot be used.
    #[error(transparent)]
    Navigate(#[from] NavigateError),
    /// The obstacles cannot be used.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The map layers cannot be derived.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The start's heading or the rules cannot be used.
    #[error(transparent)]
    Sim(#[from] SimError),
}

/// Runs an episode. Equal episodes give equal reports; times are not measured.
///
/// # Errors
/// When the episode cannot be run. No route, a collision or a timeout are results.
pub fn run_episode(episode: &Episode) -> Result<EpisodeReport, EpisodeError> {
    watch_episode(episode, None, &mut ())
}

/// Runs an episode while somebody watches it, and measures times by the caller's clock.
///
/// # Errors
/// As for [`run_episode`].
pub fn watch_episode(
    episode: &Episode,
    clock: Clock<'_>,
    observer: &mut dyn EpisodeObserver,
) -> Result<EpisodeReport, EpisodeError> {
    let Episode { stack, robot, .. } = episode;
    let checked = stack.validate(robot).and_then(|()| Parts::of(stack, robot));
    run_with_parts(episode, checked.map_err(NavigateError::from)?, clock, observer)
}

/// Runs an episode with a local planner or a guide of one's own, in place of those of its stack. The report does not
/// know them: its `inputs` hold the stack, and what [`Episode::stack_name`] says.
///
/// # Errors
/// As for [`run_episode`].
pub fn run_with_parts(
    episode: &Episode,
    parts: Parts,
    clock: Clock<'_>,
    observer: &mut dyn EpisodeObserver,
) -> Result<EpisodeReport, EpisodeError> {
    let world = episode.world()?;
    let Episode { known, robot, stack, .. } = episode;
    let start = episode.start.position;
    let way = (start, &episode.via[..], episode.goal);
    let mut controller = match Controller::with_parts(known, robot, stack, parts, way) {
        Ok(controller) => controller,
        Err(error) => return episode.without_route(error, observer),
    };
    let start = episode.start_pose(&world, controller.route())?;
    observer.started(&controller);
    let (route, key_points) = (controller.route().clone(), controller.guide_points());
    let misfit = controller.misfit();
    let rules = episode.run_rules(controller.guidance().remaining_m);
    let drive = Drive { episode, world: &world, rules: &rules, start };
    let driven = drive.simulated(&mut controller, clock, observer)?;
    observer.ended(&driven.run, &controller);
    let map = episode.layer_of(&route)?;
    let controlled = Controlled {
        routes_planned: controller.routes_planned(),
        recoveries: controller.recoveries(),
        unsafe_commands: controller.refusals(),
        way_points: driven.way_points(&episode.via),
        mean_cycle_us: driven.mean_cycle_us,
    };
    let mrpb = Mrpb::of_run(&driven.run, &world, Mrpb::safe_distance_m(robot));
    Ok(EpisodeReport {
        schema: EpisodeReport::SCHEMA,
        outcome: EpisodeOutcome::of(driven.run.outcome),
        reason: driven.reason(&rules),
        plan: episode.plan_part(&route, &map, clock),
        smoothed: Some(SmoothedPart::of(&route, &map, None)),
        key_points_m: Some(key_points),
        misfit,
        run: Some(RunPart::of(&driven.run, mrpb, controlled)),
        trajectory: Some(driven.run.samples.iter().map(trajectory_row).collect()),
        inputs: episode.inputs(Some(rules.time_limit_s)),
    })
}

/// What is driven, where, and until when.
struct Drive<'a> {
    episode: &'a Episode,
    world: &'a World,
    rules: &'a RunRules,
    start: Pose,
}

/// A run, and what the controller did in it.
struct Driven {
    run: Run,
    mean_cycle_us: Option<f64>,
    /// When each way-point was passed, up to the last one that was \[s\].
    passed_s: Vec<f64>,
    /// What was in the way last, if anything.
    blocked: Option<Blocked>,
}

impl Drive<'_> {
    fn simulated(
        &self,
        controller: &mut Controller,
        clock: Clock<'_>,
        observer: &mut dyn EpisodeObserver,
    ) -> Result<Driven, SimError> {
        let &Episode { ref robot, goal, disturbances, .. } = self.episode;
        let start = self.start;
        let (mut index, mut steps_s, mut blocked) = (0, 0.0, None);
        let mut passed_s = Vec::new();
        let mut decide = |pose: Pose, velocity: Velocity, scan: &Scan| {
            let (step, step_s) = timed(clock, || controller.step(pose, velocity, scan));
            steps_s += step_s.unwrap_or_default();
            let t_s = index as f64 * robot.cycle_s;
            observer.decided(&Cycle { index, t_s, pose, velocity, scan, step: &step, controller });
            passed_s.resize(controller.way_points_passed(), t_s);
            index += 1;
            let remaining_m = controller.guidance().remaining_m;
            let action = match step {
                Step::Arrived => Action::Arrived,
                // What it tries is not what is in the way.
                Step::Drive(command) | Step::Blocked { command, why: Blocked::Recovering(_) } => {
                    Action::Drive(command)
                }
                Step::Blocked { command, why } => {
                    blocked = Some(why);
                    Action::Drive(command)
                }
            };
            Control { action, remaining_m, route: controller.ways_taken() }
        };
        let goal = goal.position;
        let participant = Participant { robot, start, goal, disturbances, controller: &mut decide };
        // One robot has one run.
        let run = simulate(self.world, &mut [participant], self.rules)?.swap_remove(0);
        let is_measured = clock.is_some() && index > 0;
        let mean_cycle_us = is_measured.then(|| steps_s * 1e6 / index as f64);
        Ok(Driven { run, mean_cycle_us, passed_s, blocked })
    }
}

impl Driven {
    fn way_points(&self, via: &[Point]) -> Vec<WayPointPart> {
        let part = |(index, &position): (usize, &Point)| WayPointPart {
            position,
            passed_s: self.passed_s.get(index).copied(),
        };
        via.iter().enumerate().map(part).collect()
    }

    /// Why the goal was not reached.
    fn reason(&self, rules: &RunRules) -> Option<String> {
        let RunRules { time_limit_s, stuck_window_s, stuck_progress_m, .. } = rules;
        let what = match self.run.outcome {
            Outcome::Reached => return None,
            Outcome::Collided { pose, with, robot_stood, jumped_onto } => {
                let with = match with {
                    Obstacle::Circle(index) => format!("unknown obstacle {index}"),
                    Obstacle::Mover(index) => format!("moving obstacle {index}"),
                    Obstacle::Border => "the border of the map".to_owned(),
                    Obstacle::Square => "an obstacle of the map".to_owned(),
                    Obstacle::Robot(index) => format!("robot {index}"),
                };
                let has_driven = self.run.cycles > 0;
                let stood = if robot_stood && has_driven { ", while the robot stood" } else { "" };
                let jumped = if jumped_onto { ", just after it had jumped" } else { "" };
                format!("touched {with} at ({:.3}, {:.3}){stood}{jumped}", pose.x, pose.y)
            }
            Outcome::Timeout => format!("the time limit of {time_limit_s:.1} s passed"),
            Outcome::Stuck => format!(
                "the remaining way did not become {stuck_progress_m} m shorter within {stuck_window_s} s"
            ),
        };
        let last = self.blocked.as_ref().map(|why| format!("; the last problem: {why}"));
        Some(what + &last.unwrap_or_default())
    }
}

impl EpisodeOutcome {
    const fn of(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Reached => Self::Reached,
            Outcome::Collided { .. } => Self::Collided,
            Outcome::Timeout => Self::Timeout,
            Outcome::Stuck => Self::Stuck,
        }
    }
}

impl Episode {
    /// The real obstacles: the known ones under the policy for unknown cells, circles, and what moves.
    fn world(&self) -> Result<World, WorldError> {
        let mut squares = self.known.occupied().clone();
        if self.stack.map.unknown == UnknownPolicy::Blocked {
            squares.merge(self.known.unknown());
        }
        let world = World::new(*self.known.frame(), squares, self.obstacles.clone())?;
        Ok(world.with_movers(self.movers.clone()))
    }

    /// Where the robot stands at the beginning of a route.
    ///
    /// # Errors
    /// When it touches something there that it knows of. What it does not know of is met by driving, or by standing.
    fn start_pose(&self, world: &World, route: &Route) -> Result<Pose, NavigateError> {
        let footprint = &self.robot.footprint;
        let at_start = world.at(0.0);
        let has_room = |pose| {
            let border_m = at_start.border_distance(footprint, pose);
            at_start.distance(footprint, pose, f64::INFINITY).min(border_m) > 0.0
        };
        let pose = self.start.pose(route, has_room);
        if !touches(footprint, pose, &Clearance::new(world.frame(), world.squares())) {
            return Ok(pose);
        }
        let map = SearchMap::new(&self.known, LayerConfig::default())
            .map_err(|error| error.within("map"))?;
        Err(NavigateError::StartTouches {
            position: pose.point(),
            yaw_deg: self.start.yaw_deg,
            footprint: footprint.clone(),
            why: map.hindrance(pose.point()),
        })
    }

    /// For a way of this length \[m\].
    fn run_rules(&self, length_m: f64) -> RunRules {
        let EpisodeRules {
            goal_tolerance_m,
            arrival,
            time_limit_s,
            stuck_window_s,
            stuck_progress_m,
        } = self.rules;
        let v_max_mps = self.robot.limits.v_max_mps;
        let usual_s = 60.0 + 4.0 * length_m / v_max_mps;
        let usual_m = RunRules::default().stuck_progress_m.min(0.05 * v_max_mps * stuck_window_s);
        RunRules {
            goal_tolerance_m: goal_tolerance_m.unwrap_or(self.stack.controller.goal_tolerance_m),
            arrival,
            time_limit_s: time_limit_s.unwrap_or(usual_s),
            stuck_window_s,
            stuck_progress_m: stuck_progress_m.unwrap_or(usual_m),
        }
    }

    /// The layers on which a route was planned.
    fn layer_of(&self, route: &Route) -> Result<SearchMap, ConfigError> {
        let config = LayerConfig { clearance_m: route.clearance_m, ..self.stack.map.clone() };
        SearchMap::new(&self.known, config).map_err(|error| error.within("map"))
    }

    /// The first route; its query is repeated for the time alone, on layers that are ready.
    fn plan_part(&self, route: &Route, map: &SearchMap, clock: Clock<'_>) -> PlanPart {
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
        // The route shows that there is a path.
        timed(clock, || planner.plan_into(map, &query, &mut workspace, None, &mut plan)).1
    }

    /// A start without a route is a result; everything else is bad input.
    fn without_route(
        &self,
        error: NavigateError,
        observer: &mut dyn EpisodeObserver,
    ) -> Result<EpisodeReport, EpisodeError> {
        let planner = self.stack.planner.name();
        // Of a way-point that cannot be reached, why not.
        let cause = match &error {
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
        };
        let Some(plan) = plan else { return Err(error.into()) };
        observer.no_route(&error);
        Ok(EpisodeReport {
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

    /// All that the result depends on; `time_limit_s` is the limit that is in force.
    pub fn inputs(&self, time_limit_s: Option<f64>) -> Inputs {
        let to_row = |circle: &Circle| [circle.centre.x, circle.centre.y, circle.radius_m];
        Inputs {
            version: Inputs::VERSION,
            map: self.source.name.clone(),
            map_digest: self.source.digest.clone(),
            placement: self.source.placement,
            robot: Some(self.robot.clone()),
            stack: Some(self.stack_name.clone()),
            config: Parameters::Run(Box::new(self.stack.clone())),
            start: self.start.into(),
            goal: self.goal.into(),
            goals: None,
            via: (!self.via.is_empty()).then(|| self.via.clone()),
            nearest_reachable: None,
            obstacles: self.obstacles.iter().map(to_row).collect(),
            moving: self.movers.clone(),
            disturbances: (!self.disturbances.is_none()).then_some(self.disturbances),
            goal_tolerance_m: self.rules.goal_tolerance_m,
            arrival: Some(self.rules.arrival),
            time_limit_s,
            budget: None,
        }
    }
}
