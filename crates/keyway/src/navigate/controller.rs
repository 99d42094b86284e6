//! The navigation loop, as a value with a step.

use super::Stack;
use super::route::{Layers, NavigateError, check_room, explain, first_route, footprint_query};
use crate::geometry::{Point, Pose, Segment, Velocity};
use crate::guide::{Guidance, Guide, GuideMemory, GuideView};
use crate::local::{DriveMemory, Evaluation, Explanation, LocalPlanner, NoCommand, Scene, Scratch};
use crate::map::{BitGrid, CellWindow, Clearance, DistanceField, Edit, FieldConfig, OccupancyGrid};
use crate::plan::{GlobalPlanner, PathEnd, PlanError};
use crate::robot::Robot;
use crate::route::{Route, RouteQuery};
use crate::search::Workspace;
use crate::sense::{Scan, SensedLayer};
use crate::smooth::Smoother;
use thiserror::Error;

/// What to do until the next cycle.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Drive with this velocity.
    Drive(Velocity),
    /// The goal is reached: stop.
    Arrived,
    /// There is no good way on at the moment: drive with `command`, which is safe, and ask again.
    Blocked {
        /// Drives on as far as is safe, brakes along the present arc, or turns on the spot.
        command: Velocity,
        /// What is in the way.
        why: Blocked,
    },
}

/// Why a robot makes no progress.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Blocked {
    /// The local planner found no admissible velocity.
    #[error(transparent)]
    NothingAdmissible(NoCommand),
    /// With what was sensed, there is no longer a route. The robot goes on along the last one as
    /// far as is safe (it may see a gap when it is nearer), and plans again from time to time.
    #[error("{}", no_route_text(.0))]
    NoRoute(NavigateError),
    /// A pose or velocity that cannot be true: where the robot is or how it moves is unknown. The
    /// command is to stop.
    #[error("{0} cannot be true: it is not finite, or far beyond the robot's limits")]
    BadInput(&'static str),
}

/// The route would begin at the robot, not at the start.
fn no_route_text(why: &NavigateError) -> String {
    match why {
        NavigateError::Plan(PlanError::NoPath { .. }) => {
            "what the robot has seen leaves no path to the goal".to_owned()
        }
        why => format!("what the robot has seen leaves no route to the goal ({why})"),
    }
}

/// Drives a robot to a goal: it plans on the known map, remembers what scans show, follows the key
/// points of its route with the local planner, and plans again when the route turns out to be
/// obstructed.
///
/// It sees the known map, poses, velocities and scans, and nothing else; the same inputs give the
/// same commands. Frames and units are those of the map: metres, radians, seconds.
pub struct Controller {
    known: OccupancyGrid,
    stack: Stack,
    goal: Point,
    planner: Box<dyn GlobalPlanner + Send + Sync>,
    smoother: Box<dyn Smoother + Send + Sync>,
    robot: Robot,
    local: Box<dyn LocalPlanner + Send + Sync>,
    memory: DriveMemory,
    scratch: Scratch,
    layers: Layers,
    /// Distances to what is known and what was sensed.
    obstacles: DistanceField,
    sensed: SensedLayer,
    edits: Vec<Edit>,
    workspace: Workspace,
    route: Route,
    guide: Box<dyn Guide + Send + Sync>,
    guide_memory: GuideMemory,
    /// Where the last cycle drove to; before the first one to the goal.
    guidance: Guidance,
    watch: Watch,
    evaluation: Evaluation,
    /// What the last cycle asked the local planner; `None` when it did not.
    asked: Option<Asked>,
    routes_planned: u32,
    /// Why the last attempt at a new route failed; cleared by the next success.
    no_route: Option<NavigateError>,
    /// How long the last wait between two attempts was \[s\].
    waited_s: f64,
}

/// What of a question to the local planner is not kept elsewhere.
#[derive(Clone, Debug)]
struct Asked {
    pose: Pose,
    velocity: Velocity,
    /// What it remembered before it answered.
    memory: DriveMemory,
}

/// How long the robot has made no progress.
#[derive(Clone, Copy, Debug)]
struct Watch {
    /// Age of the route \[s\].
    route_s: f64,
    blocked_s: f64,
    shortest_m: f64,
    no_progress_s: f64,
    /// Time until the next attempt at a route, after one that failed \[s\].
    wait_s: f64,
}

impl Watch {
    /// The remaining way must become shorter by this to count as progress \[m\].
    const PROGRESS_M: f64 = 0.05;

    const NEW: Self = Self {
        route_s: 0.0,
        blocked_s: 0.0,
        shortest_m: f64::INFINITY,
        no_progress_s: 0.0,
        wait_s: 0.0,
    };

    fn note_cycle(&mut self, remaining_m: f64, is_blocked: bool, cycle_s: f64) {
        self.route_s += cycle_s;
        self.blocked_s = if is_blocked { self.blocked_s + cycle_s } else { 0.0 };
        if remaining_m < self.shortest_m - Self::PROGRESS_M {
            self.shortest_m = remaining_m;
            self.no_progress_s = 0.0;
        } else {
            self.no_progress_s += cycle_s;
        }
    }
}

impl Controller {
    /// Plans a route from the start to the goal on the known map, which is copied.
    ///
    /// # Errors
    /// When a value of the robot or the stack cannot be used, when the robot does not fit at the
    /// start or goal, or when there is no route.
    pub fn new(
        known: &OccupancyGrid,
        robot: &Robot,
        stack: &Stack,
        start: Point,
        goal: Point,
    ) -> Result<Self, NavigateError> {
        stack.validate(robot)?;
        stack.check_planner()?;
        stack.check_map()?;
        let local = stack.local.build(robot)?;
        let layers = Layers::new(known, stack, robot)?;
        let radius_m = robot.footprint.inscribed_radius_m();
        check_room(&layers, PathEnd::Start, start, radius_m)?;
        check_room(&layers, PathEnd::Goal, goal, radius_m)?;
        let planner = stack.planner.build(layers.obstacles())?;
        let smoother = stack.smoother.build()?;
        let mut workspace = Workspace::default();
        let query = footprint_query(start, goal, radius_m);
        let route = first_route(layers.fitting(), &*planner, &*smoother, &query, &mut workspace)
            .map_err(|error| explain(&layers, &*planner, &query, error))?;
        let config = FieldConfig { reach_m: robot.decision_reach_m(), ..FieldConfig::default() };
        let known_obstacles = layers.obstacles().obstacles();
        Ok(Self {
            obstacles: DistanceField::new(known.frame(), known_obstacles, &config),
            sensed: SensedLayer::new(known.frame()),
            guide: stack.guide.build()?,
            guide_memory: GuideMemory::default(),
            guidance: Guidance { point: goal, remaining_m: route.smoothed.length_m() },
            known: known.clone(),
            stack: stack.clone(),
            goal,
            planner,
            smoother,
            robot: robot.clone(),
            local,
            memory: DriveMemory::default(),
            scratch: Scratch::default(),
            layers,
            edits: Vec::new(),
            workspace,
            route,
            watch: Watch::NEW,
            evaluation: Evaluation::default(),
            asked: None,
            routes_planned: 1,
            no_route: None,
            waited_s: 0.0,
        })
    }

    /// The route being followed.
    pub const fn route(&self) -> &Route {
        &self.route
    }

    /// The points that the guide hands out along the route, the goal last.
    pub fn guide_points(&self) -> Vec<Point> {
        self.guide.points(&self.route.smoothed)
    }

    /// Where the last cycle drove to, and what was left of the way there. Before the first cycle: the goal, and the
    /// whole route.
    pub const fn guidance(&self) -> &Guidance {
        &self.guidance
    }

    /// Cells that hold something which the known map does not show.
    pub const fn sensed(&self) -> &BitGrid {
        self.sensed.sensed()
    }

    /// How the candidates of the last cycle fared.
    pub const fn evaluation(&self) -> &Evaluation {
        &self.evaluation
    }

    /// Why the local planner decided as it did in the last cycle, candidate by candidate; empty when it was not asked.
    /// Costs many times as much as the decision ([`LocalPlanner::explain`]).
    pub fn explain(&self) -> Explanation {
        let Some(Asked { pose, velocity, memory }) = &self.asked else {
            return Explanation::default();
        };
        // Nothing of it has changed since the decision.
        let scene = Scene {
            obstacles: &self.obstacles,
            pose: *pose,
            velocity: *velocity,
            guide: self.guidance.point,
            path: &self.route.smoothed,
        };
        self.local.explain(&scene, memory)
    }

    /// What the local planner remembers from the last cycle.
    pub const fn memory(&self) -> &DriveMemory {
        &self.memory
    }

    /// Routes planned so far, the first one included.
    pub const fn routes_planned(&self) -> u32 {
        self.routes_planned
    }

    /// One control cycle: from where the robot is, how it moves and what it sees to what it is to
    /// do.
    pub fn step(&mut self, pose: Pose, velocity: Velocity, scan: &Scan) -> Step {
        self.asked = None;
        if let Some(field) = self.unbelievable(pose, velocity) {
            return Step::Blocked { command: Velocity::ZERO, why: Blocked::BadInput(field) };
        }
        self.take_in(pose, scan);
        let position = pose.point();
        if position.distance(self.goal) <= self.stack.controller.goal_tolerance_m {
            return Step::Arrived;
        }
        if self.is_obstructed(position) {
            self.replan(position);
        }
        let driven = self.drive(pose, velocity);
        match (self.no_route.clone(), driven) {
            (None, Ok(command)) => Step::Drive(command),
            (None, Err(why)) => {
                Step::Blocked { command: why.fallback, why: Blocked::NothingAdmissible(why) }
            }
            // On along the old route, as far as is safe: the robot sees better when it is nearer.
            (Some(why), driven) => {
                self.watch.wait_s -= self.robot.cycle_s;
                let command = driven.unwrap_or_else(|why| why.fallback);
                Step::Blocked { command, why: Blocked::NoRoute(why) }
            }
        }
    }

    /// The field that cannot be true, if any: not finite, or faster than twice the robot's limits.
    fn unbelievable(&self, pose: Pose, velocity: Velocity) -> Option<&'static str> {
        let limits = &self.robot.limits;
        let fastest_mps = limits.v_max_mps.max(-limits.v_min_mps);
        let checks = [
            ("pose.x", pose.x.is_finite()),
            ("pose.y", pose.y.is_finite()),
            ("pose.theta", pose.theta.is_finite()),
            ("velocity.v", velocity.v.abs() <= 2.0 * fastest_mps),
            ("velocity.omega", velocity.omega.abs() <= 2.0 * limits.omega_max_radps),
        ];
        checks.into_iter().find(|check| !check.1).map(|(field, _)| field)
    }

    /// Adds what a scan shows to the sensed layer, and to every map that follows from it.
    fn take_in(&mut self, pose: Pose, scan: &Scan) {
        self.edits.clear();
        self.sensed.update(&self.known, pose, scan, &mut self.edits);
        for map in &mut self.layers.maps {
            map.apply(&self.edits);
        }
        let cells = self.edits.iter().map(|edit| CellWindow { low: edit.cell, high: edit.cell });
        if let Some(window) = cells.reduce(|all, cell| all.union(&cell)) {
            let obstacles = self.layers.obstacles().obstacles();
            self.obstacles.update(obstacles, window);
        }
    }

    /// True when the route should be planned again: something sensed covers its guide point or the
    /// straight way there, or the robot has made no progress for too long.
    fn is_obstructed(&self, position: Point) -> bool {
        if self.no_route.is_some() {
            return self.watch.wait_s <= 0.0;
        }
        let config = &self.stack.controller;
        let sensed = Clearance::new(self.known.frame(), self.sensed.sensed());
        let way = Segment::new(position, self.guidance.point);
        let is_covered = !sensed.is_clear(way, self.robot.footprint.inscribed_radius_m());
        // A goal that stays covered must not cause a new plan in every cycle.
        (is_covered && self.watch.route_s >= config.blocked_s)
            || self.watch.blocked_s >= config.blocked_s
            || self.watch.no_progress_s >= config.no_progress_s
    }

    /// Plans again on what is known and sensed. When that fails, the old route stays, and the next
    /// attempt waits longer each time.
    fn replan(&mut self, position: Point) {
        let config = &self.stack.controller;
        self.routes_planned += 1;
        self.watch = Watch::NEW;
        let radius_m = self.robot.footprint.inscribed_radius_m();
        let query = RouteQuery {
            budget: Some(config.replan_budget),
            ..footprint_query(position, self.goal, radius_m)
        };
        let (maps, planner, smoother) = (&self.layers.maps, &*self.planner, &*self.smoother);
        let route = first_route(maps, planner, smoother, &query, &mut self.workspace);
        match route {
            Ok(route) => {
                self.guide_memory = GuideMemory::default();
                self.memory = DriveMemory::default();
                self.route = route;
                (self.no_route, self.waited_s) = (None, 0.0);
            }
            Err(why) => {
                let longest_s = config.longest_wait_s.max(config.blocked_s);
                self.waited_s = (2.0 * self.waited_s).clamp(config.blocked_s, longest_s);
                self.watch.wait_s = self.waited_s;
                self.no_route = Some(why);
            }
        }
    }

    /// The local planner's command towards the current key point.
    fn drive(&mut self, pose: Pose, velocity: Velocity) -> Result<Velocity, NoCommand> {
        let position = pose.point();
        let obstacles = &self.obstacles;
        let clearance_m = self.stack.controller.least_clearance_m;
        let path = &self.route.smoothed;
        let view = GuideView { path, position, obstacles: obstacles.clearance(), clearance_m };
        if let Some(guidance) = self.guide.guide(&view, &mut self.guide_memory) {
            self.guidance = guidance;
        }
        let Guidance { point: guide, remaining_m } = self.guidance;
        self.asked = Some(Asked { pose, velocity, memory: self.memory.clone() });
        let scene = Scene { obstacles, pose, velocity, guide, path };
        let decision = self.local.decide(&scene, &mut self.memory, &mut self.scratch);
        self.evaluation = match &decision {
            Ok(decision) => decision.evaluation.clone(),
            Err(why) => why.evaluation.clone(),
        };
        let cycle_s = self.robot.cycle_s;
        let is_blocked = match &decision {
            Ok(decision) => decision.command == Velocity::ZERO,
            Err(_) => true,
        };
        self.watch.note_cycle(remaining_m, is_blocked, cycle_s);
        decision.map(|decision| decision.command)
    }
}
