//! The navigation loop, as a value with a step.

mod arriving;
mod driving;
mod guarding;
mod looking;
mod recovering;
mod replanning;
mod turning_first;

use super::recovery::{MotionUnderWay, Recovery, Track};
use super::route::{Router, check_goal_heading};
use super::start::{StartTooNear, touches};
use super::under_way::UnderWay;
use super::walked_ground::{Hold, WalkedGround};
use super::watch::Watch;
use super::{Blocked, FittedStack, Goal, Misfit, NavigateError, RecoveryCounts, Stack, Step};
use crate::geometry::{Disc, Point, Pose, Velocity};
use crate::guide::{Guidance, Guide, GuideMemory};
use crate::local::{
    DriveMemory, Evaluation, Explanation, LocalPlanner, Refusal, RefusalCounts, Scratch,
};
use crate::map::{BitGrid, DistanceField, Edit, FieldConfig, OccupancyGrid};
use crate::robot::Robot;
use crate::route::Route;
use crate::sense::{Mover, Scan, SeenGround, SensedLayer, Tracker};
use guarding::Guard;
use looking::Look;
use std::sync::Arc;

/// Drives a robot to a goal: it plans on the known map, remembers what scans show, follows the
/// guide points of its route with the local planner, plans again when the route turns out to be
/// obstructed, and tries its recoveries when it gets no farther.
///
/// It sees the known map, poses, velocities and scans, and nothing else; the same inputs give the
/// same commands. Frames and units are those of the map: metres, radians, seconds.
pub struct Controller {
    known: OccupancyGrid,
    stack: Arc<Stack>,
    robot: Arc<Robot>,
    /// Way-points, then the goal, each with the length of the leg that leads there \[m\].
    stops: Vec<(Point, f64)>,
    /// How many of them the robot has passed; never the goal.
    passed: usize,
    goal: Goal,
    router: Router,
    local: Arc<dyn LocalPlanner + Send + Sync>,
    guide: Arc<dyn Guide + Send + Sync>,
    memory: DriveMemory,
    scratch: Scratch,
    /// Distances to what is known and what was sensed.
    obstacles: DistanceField,
    sensed: SensedLayer,
    seen: Option<SeenGround>,
    /// What moves is in its list, not in the sensed layer; none where everything counts as
    /// standing.
    tracker: Option<Tracker>,
    look: Look,
    edits: Vec<Edit>,
    /// To the next of the stops.
    route: Route,
    /// How far along the route the robot has come \[m\].
    covered_m: f64,
    guide_memory: GuideMemory,
    /// Where the last cycle drove to; before the first one to the next stop.
    guidance: Guidance,
    /// No place of the route is in sight.
    is_lost: bool,
    watch: Watch,
    walked: WalkedGround,
    hold: Hold,
    track: Track,
    recovery: Recovery,
    /// Towards the guide point, before the robot enters ground on which it cannot turn.
    first_turn: Option<MotionUnderWay>,
    /// To the heading at the goal.
    final_turn: Option<MotionUnderWay>,
    evaluation: Evaluation,
    guard: Guard,
    under_way: UnderWay,
    /// What moves, as it will be when the next command acts.
    movers_then: Vec<Mover>,
    /// What the last cycle asked the local planner; `None` when it did not.
    asked: Option<Asked>,
    routes_planned: u32,
    ways_taken: u32,
    /// Why the last attempt at a new route failed; cleared by the next success.
    no_route: Option<NavigateError>,
    /// How long the last wait between two attempts was, and what is left of it \[s\].
    waited_s: f64,
    wait_s: f64,
    /// The obstacle that the robot has to leave first, until it has.
    too_near: Option<StartTooNear>,
}

/// What of a question to the local planner is not kept elsewhere.
#[derive(Clone, Debug)]
struct Asked {
    pose: Pose,
    velocity: Velocity,
    /// What it remembered before it answered.
    memory: DriveMemory,
}

impl Controller {
    /// Plans a route from the start to the goal on the known map, which is copied.
    ///
    /// # Errors
    /// When the robot does not fit at the start or goal, or not with the goal's heading, or touches
    /// something at the start, or when there is no route. A start that is too near to something by
    /// no more than [`start_error_m`](super::ControllerConfig::start_error_m) is none
    /// ([`Self::too_near`]).
    pub fn new(
        known: &OccupancyGrid,
        stack: &FittedStack,
        start: Point,
        goal: impl Into<Goal>,
    ) -> Result<Self, NavigateError> {
        Self::by_way_of(known, stack, start, &[], goal)
    }

    /// The same by way of some points, in their order. Each is passed within the goal tolerance.
    ///
    /// # Errors
    /// As for [`Self::new`]; [`NavigateError::WayPoint`] for one that cannot be reached.
    pub fn by_way_of(
        known: &OccupancyGrid,
        fitted: &FittedStack,
        start: Point,
        way_points: &[Point],
        goal: impl Into<Goal>,
    ) -> Result<Self, NavigateError> {
        let goal = goal.into();
        let FittedStack { robot, stack, local, guide, tracker, stop_rule, .. } = fitted;
        let mut router = Router::new(known, fitted)?;
        let start_error_m = stack.controller.start_error_m;
        let too_near = router.check_start(start, &robot.footprint, start_error_m)?;
        let begin = too_near.as_ref().map_or(start, |too_near| too_near.nearest);
        let mut legs = plan_legs(&mut router, known, begin, way_points, goal.position)?;
        let stops: Vec<_> = legs.iter().map(|(to, leg)| (*to, leg.smoothed.length_m())).collect();
        let (point, route) = legs.swap_remove(0);
        let remaining_m = stops.iter().map(|(_, length_m)| length_m).sum();
        let config = FieldConfig { reach_m: robot.decision_reach_m(), ..FieldConfig::default() };
        let known_obstacles = router.layers.obstacles().obstacles();
        let obstacles = DistanceField::new(known.frame(), known_obstacles, &config);
        let tolerance_rad = stack.controller.goal_yaw_tolerance_rad;
        check_goal_heading(&goal, &robot.footprint, tolerance_rad, &obstacles)?;
        Ok(Self {
            obstacles,
            sensed: SensedLayer::new(known.frame()),
            seen: stack.build_seen_ground(known.frame(), robot),
            tracker: tracker.clone(),
            look: Look::default(),
            guide_memory: GuideMemory::default(),
            guidance: Guidance { point, remaining_m },
            is_lost: false,
            track: Track::new(known.frame().resolution_m()),
            known: known.clone(),
            stack: Arc::clone(stack),
            robot: Arc::clone(robot),
            stops,
            passed: 0,
            goal,
            router,
            local: Arc::clone(local),
            guide: Arc::clone(guide),
            memory: DriveMemory::default(),
            scratch: Scratch::default(),
            edits: Vec::new(),
            route,
            covered_m: 0.0,
            watch: Watch::NEW,
            walked: WalkedGround::default(),
            hold: Hold::default(),
            recovery: Recovery::default(),
            first_turn: None,
            final_turn: None,
            evaluation: Evaluation::default(),
            guard: Guard::new(stop_rule.clone()),
            under_way: UnderWay::new(robot),
            movers_then: Vec::new(),
            asked: None,
            routes_planned: 1,
            ways_taken: 1,
            no_route: None,
            waited_s: 0.0,
            wait_s: 0.0,
            too_near,
        })
    }

    /// The route being followed: to the goal, or to the next way-point.
    pub const fn route(&self) -> &Route {
        &self.route
    }

    /// Where along the route the footprint does not fit, as far as is known and sensed; `None`
    /// where it fits.
    pub fn misfit(&self) -> Option<Misfit> {
        Misfit::first_along(&self.route.smoothed, &self.robot.footprint, &self.obstacles)
    }

    /// The obstacle that the robot begins too near to, as it was told; `None` where it does not,
    /// and from the cycle on in which it has left.
    pub const fn too_near(&self) -> Option<&StartTooNear> {
        self.too_near.as_ref()
    }

    /// The points that the guide hands out along the route, its end last.
    pub fn guide_points(&self) -> Vec<Point> {
        self.guide.points(&self.route.smoothed)
    }

    /// Where the last cycle drove to, and what was left of the way to the goal. Before the first
    /// cycle: the end of the route, and all of the way.
    pub const fn guidance(&self) -> &Guidance {
        &self.guidance
    }

    /// Cells that hold something which the known map does not show.
    pub const fn sensed(&self) -> &BitGrid {
        self.sensed.sensed()
    }

    /// What moves, as estimated from the scans so far; empty where everything counts as standing
    /// (`controller.movers` of the stack).
    pub fn movers(&self) -> &[Mover] {
        self.tracker.as_ref().map_or(&[], Tracker::movers)
    }

    /// Ground on which movers walk to and fro, and around which the robot goes.
    pub fn gone_around(&self) -> &[Disc] {
        self.walked.avoided()
    }

    /// How the candidates of the last cycle fared.
    pub const fn evaluation(&self) -> &Evaluation {
        &self.evaluation
    }

    /// Why the local planner decided as it did in the last cycle, candidate by candidate; empty
    /// when it was not asked. Costs many times as much as the decision
    /// ([`LocalPlanner::explain`](crate::local::LocalPlanner::explain)).
    pub fn explain(&self) -> Explanation {
        let Some(Asked { pose, velocity, memory }) = &self.asked else {
            return Explanation::default();
        };
        // Nothing of it has changed since the decision.
        self.local.explain(&self.scene(*pose, *velocity), memory)
    }

    /// What the local planner remembers from the last cycle.
    pub const fn memory(&self) -> &DriveMemory {
        &self.memory
    }

    /// Searches for a route, those that found none or the same way again included: the first one;
    /// one each time a scan shows something on the route, or no place of it is in sight; one at
    /// each way-point, and one after each wait where there was no route; and those of the
    /// recoveries. The legs between way-points count as one.
    pub const fn routes_planned(&self) -> u32 {
        self.routes_planned
    }

    /// How many different ways were taken, the first one included: a route that leads the same way
    /// as the one before does not count. So progress can be measured along a way, however often it
    /// is planned.
    pub const fn ways_taken(&self) -> u32 {
        self.ways_taken
    }

    /// How many way-points were passed.
    pub const fn way_points_passed(&self) -> usize {
        self.passed
    }

    /// What was tried so far because the robot got no farther.
    pub const fn recoveries(&self) -> RecoveryCounts {
        self.recovery.counts
    }

    /// Why the stop rule changed the command of the last cycle; `None` when it did not, or there is
    /// none (`controller.safe` of the stack).
    pub const fn refusal(&self) -> Option<&Refusal> {
        self.guard.refusal()
    }

    /// How many commands the stop rule has changed, by reason; `None` when there is none.
    pub fn refusals(&self) -> Option<RefusalCounts> {
        self.guard.counts()
    }

    /// One control cycle: from where the robot is, how it moves and what it sees to what it is to
    /// do.
    ///
    /// For a robot with an [`Robot::actuation_delay_s`] the command is chosen for where the robot
    /// will be when it acts. It is taken to be given: whoever gives another one makes that
    /// prediction wrong. Whatever velocity is told, the command is within the robot's limits of
    /// speed.
    pub fn step(&mut self, pose: Pose, velocity: Velocity, scan: &Scan) -> Step {
        let step = self.stepped(pose, velocity, scan);
        // Whoever decided may brake from a velocity beyond the limits, as odometry may show one.
        let command = self.robot.limits.clamped(step.command());
        self.under_way.give(command);
        step.commanding(command)
    }

    fn stepped(&mut self, pose: Pose, velocity: Velocity, scan: &Scan) -> Step {
        self.asked = None;
        self.guard.pause();
        self.look.wait(self.robot.cycle_s);
        if let Some(field) = self.unbelievable(pose, velocity) {
            return Step::Blocked { command: Velocity::ZERO, why: Blocked::BadInput(field) };
        }
        let (pose_then, velocity_then) = self.under_way.predicted(pose, velocity);
        let outside = |pose: &Pose| self.known.frame().cell_from_world(pose.point()).is_none();
        if let Some(pose) = [pose, pose_then].iter().find(|&pose| outside(pose)) {
            let command = self.robot.limits.braked(velocity_then, self.robot.cycle_s);
            return Step::Blocked { command, why: Blocked::OffTheMap(pose.point()) };
        }
        if self.too_near.is_some() {
            let known = self.router.layers.obstacles().clearance();
            self.too_near.take_if(|_| !touches(&self.robot.footprint, pose, &known));
        }
        self.take_in(pose, scan);
        // A robot that stands at its goal need not see it.
        let silence = self.silence().filter(|_| !self.has_arrived(pose_then, velocity_then));
        if let Some(why) = silence {
            let command = self.robot.limits.braked(velocity_then, self.robot.cycle_s);
            return Step::Blocked { command, why };
        }
        let step = self.decided(pose_then, velocity_then);
        if step == Step::Arrived && !self.under_way.is_at_rest(&self.robot, velocity) {
            return Step::Drive(Velocity::ZERO);
        }
        self.guarded(step, pose_then, velocity_then)
    }

    /// What is to be done, before the stop rule is asked.
    fn decided(&mut self, pose: Pose, velocity: Velocity) -> Step {
        self.track.note(pose.point());
        self.pass_way_point(pose.point());
        if let Some(step) = self.arrive(pose, velocity) {
            return step;
        }
        self.look_after_route(pose, velocity);
        if let Some((kind, command)) = self.go_on_recovering(pose, velocity) {
            return Step::Blocked { command, why: Blocked::Recovering(kind) };
        }
        if let Some(command) = self.turn_first(pose, velocity) {
            return Step::Drive(command);
        }
        let driven = self.drive(pose, velocity);
        if let Ok(command) = driven {
            self.turn_before(pose, velocity, command);
            if let Some(command) = self.turn_first(pose, velocity) {
                return Step::Drive(command);
            }
        }
        match (self.no_route.clone(), driven) {
            (None, Ok(command)) if self.can_only_stand(command) => {
                Step::Blocked { command, why: Blocked::NothingDrives(self.evaluation.clone()) }
            }
            (None, Ok(command)) => Step::Drive(command),
            (None, Err(why)) => {
                Step::Blocked { command: why.fallback, why: Blocked::NothingAdmissible(why) }
            }
            // On along the old route, as far as is safe: the robot sees better when it is nearer.
            (Some(why), driven) => {
                self.wait_s -= self.robot.cycle_s;
                let braked = self.robot.limits.braked(velocity, self.robot.cycle_s);
                let command =
                    if self.is_lost { braked } else { driven.unwrap_or_else(|why| why.fallback) };
                Step::Blocked { command, why: Blocked::NoRoute(why) }
            }
        }
    }

    /// Whether the robot stands because no other velocity was admissible.
    fn can_only_stand(&self, command: Velocity) -> bool {
        let Evaluation { candidates, driving, .. } = self.evaluation;
        self.robot.stands(command) && candidates > 0 && driving == 0
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

    fn next_stop(&self) -> Point {
        self.stops[self.passed].0
    }

    /// Length of the legs after the present one \[m\].
    fn later_m(&self) -> f64 {
        self.stops[self.passed + 1..].iter().map(|(_, length_m)| length_m).sum()
    }
}

/// The legs of a route, each with where it ends.
fn plan_legs(
    router: &mut Router,
    known: &OccupancyGrid,
    start: Point,
    way_points: &[Point],
    goal: Point,
) -> Result<Vec<(Point, Route)>, NavigateError> {
    let mut from = start;
    let mut legs = Vec::with_capacity(way_points.len() + 1);
    for (index, &to) in way_points.iter().chain([&goal]).enumerate() {
        let leg = router.first(known, from, to);
        let is_way_point = index < way_points.len();
        let named = |why| {
            if is_way_point {
                NavigateError::WayPoint { number: index + 1, why: Box::new(why) }
            } else {
                why
            }
        };
        legs.push((to, leg.map_err(named)?));
        from = to;
    }
    Ok(legs)
}
