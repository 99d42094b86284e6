//! Simulation of one or several robots in one world with their controllers, and their reports.

use super::task::Task;
use super::{
    Cycle, Episode, EpisodeError, EpisodeObserver, EpisodeOutcome, EpisodeRobot, RobotReport,
};
use crate::metrics::{CommandJerk, Mrpb};
use crate::report::{
    Clock, Controlled, RunPart, SmoothedPart, WayPointPart, timed, trajectory_row,
};
use crate::sim::{
    Action, Control, MovingObstacle, Obstacle, Outcome, Participant, Run, RunRules, World,
    WorldError, simulate_on,
};
use keyway::ConfigError;
use keyway::geometry::{Point, Pose};
use keyway::map::{BitGrid, OccupancyGrid, UnknownPolicy};
use keyway::navigate::{Blocked, Doubt, FittedStack, Goal, Misfit, NavigateError, Navigator, Step};
use keyway::route::Route;
use keyway::sense::Observation;
use std::mem::discriminant;

/// Problems within this time before a contact are part of its reason \[s\].
const BEFORE_CONTACT_S: f64 = 1.0;

/// A robot about to drive.
pub(super) struct Entry<'a> {
    pub(super) task: Task<'a>,
    pub(super) stack: FittedStack,
    pub(super) observer: &'a mut dyn EpisodeObserver,
}

/// A robot after its run, or without a route.
pub(super) struct Ended {
    pub(super) report: RobotReport,
    /// Smallest distance from another robot \[m\].
    pub(super) min_robot_clearance_m: Option<f64>,
}

/// Drives the robots of an episode, and returns a report of each.
pub(super) fn run_all<'a>(
    entries: Vec<Entry<'a>>,
    clock: Clock<'a>,
    threads: usize,
) -> Result<Vec<Ended>, EpisodeError> {
    let tasks: Vec<Task<'_>> = entries.iter().map(|entry| entry.task).collect();
    let world = world_of(&tasks).map_err(EpisodeError::of_all)?;
    let mut robots = Vec::with_capacity(entries.len());
    for entry in entries {
        robots.push(Ready::new(entry, &world, clock)?);
    }
    let runs = simulated(threads, &world, &tasks, &mut robots)?;
    let ended = |((index, task), robot): ((usize, Task<'_>), Ready<'_>)| {
        let ended = robot.ended(runs.get(index), &world)?;
        Some(ended.map_err(|error| task.blame(error)))
    };
    tasks.into_iter().enumerate().zip(robots).filter_map(ended).collect()
}

/// Returns the true obstacles: mapped, unmapped and moving ones. Unknown cells are obstacles if
/// all robots plan around them.
pub(super) fn world_of(tasks: &[Task<'_>]) -> Result<World, WorldError> {
    let Episode { known, obstacles, polygons, hidden_cells, elusive, movers, .. } =
        tasks[0].episode;
    let frame = *known.frame();
    let through_unknown =
        tasks.iter().find(|task| task.robot.stack.map.unknown != UnknownPolicy::Blocked);
    let mut squares = through_unknown.unwrap_or(&tasks[0]).known_squares();
    for &cell in tasks[0].episode.absent_cells.iter().filter(|&&cell| frame.contains(cell)) {
        squares.set(cell, false);
    }
    let mut world = World::new(frame, squares, obstacles.clone())?;
    if !hidden_cells.is_empty() {
        let mut hidden = BitGrid::new(frame.width(), frame.height(), false);
        for &cell in hidden_cells {
            if !frame.contains(cell) {
                let (width, height) = (frame.width(), frame.height());
                return Err(WorldError::Cell { cell, width, height });
            }
            hidden.set(cell, true);
        }
        world = world.with_hidden(&hidden)?;
    }
    let world = world.with_polygons(polygons.clone()).with_elusive(elusive.clone());
    Ok(world.with_movers(movers.clone()))
}

/// Simulates the runs of all robots; returns none if no robot has a route.
fn simulated(
    threads: usize,
    world: &World,
    tasks: &[Task<'_>],
    robots: &mut [Ready<'_>],
) -> Result<Vec<Run>, EpisodeError> {
    // A robot that waits for another one may take as long as the other one.
    let limits_s = robots.iter().filter_map(|robot| Some(robot.driver()?.rules.time_limit_s));
    let Some(time_limit_s) = limits_s.reduce(f64::max) else {
        return Ok(Vec::new());
    };
    for driver in robots.iter_mut().filter_map(Ready::driver_mut) {
        driver.rules.time_limit_s = time_limit_s;
    }
    let places: Vec<(Pose, RunRules)> = robots.iter().map(Ready::place).collect();
    let mut controllers: Vec<Box<Decide<'_>>> = robots.iter_mut().map(Ready::controller).collect();
    let controllers = controllers.iter_mut().map(|controller| controller as &mut Decide<'_>);
    let participants = tasks.iter().zip(places).zip(controllers);
    let mut participants: Vec<Participant<'_>> = participants
        .map(|((task, (start, rules)), controller)| Participant {
            robot: &task.robot.robot,
            start,
            goal: task.robot.goal.position,
            disturbances: task.robot.disturbances.clone(),
            rules,
            controller,
        })
        .collect();
    simulate_on(threads, world, &mut participants).map_err(EpisodeError::of_all)
}

/// A navigator with a goal, and its first route.
pub(super) fn bound_for(
    known: &OccupancyGrid,
    stack: &FittedStack,
    (start, via, goal): (Point, &[Point], Goal),
) -> Result<(Navigator, Route), NavigateError> {
    let mut navigator = Navigator::new(known, stack)?;
    navigator.relocate(Pose { x: start.x, y: start.y, theta: 0.0 });
    navigator.set_goals(via, goal)?;
    let route = navigator.route().cloned().unwrap_or_default();
    Ok((navigator, route))
}

/// Remaining length of the route to the goal \[m\].
pub(super) fn remaining_m(navigator: &Navigator) -> f64 {
    navigator.guidance().map_or(f64::INFINITY, |guidance| guidance.remaining_m)
}

/// Controller of a robot.
type Decide<'a> = dyn FnMut(&Observation<'_>) -> Control + Send + 'a;

/// A robot at its start.
enum Ready<'a> {
    /// A robot with a route.
    Drives(Box<Driver<'a>>),
    /// A robot without a route, which stays at its start as an obstacle for the others.
    Stands { at: Pose, report: Box<RobotReport> },
}

impl<'a> Ready<'a> {
    fn new(entry: Entry<'a>, world: &World, clock: Clock<'a>) -> Result<Self, EpisodeError> {
        let Entry { task, stack, observer } = entry;
        let EpisodeRobot { start, via, goal, .. } = task.robot;
        let known = &task.episode.known;
        let (navigator, route) = match bound_for(known, &stack, (start.position, via, *goal)) {
            Ok(bound) => bound,
            Err(error) => {
                let Some(report) = task.without_route(&error) else {
                    return Err(task.blame(error));
                };
                observer.no_route(&error);
                let Point { x, y } = start.position;
                let at = Pose::new(x, y, start.heading_rad.unwrap_or_default());
                return Ok(Self::Stands { at, report: Box::new(report) });
            }
        };
        let start = task.start_pose(world, &route).map_err(|error| task.blame(error))?;
        observer.started(&navigator);
        let rules = task.run_rules(remaining_m(&navigator));
        Ok(Self::Drives(Box::new(Driver {
            task,
            observer,
            clock,
            start,
            rules,
            route,
            key_points: navigator.guide_points(),
            misfit: navigator.misfit(),
            navigator,
            jerk: CommandJerk::new(task.robot.robot.cycle_s),
            cycles: 0,
            decisions_s: 0.0,
            passed_s: Vec::new(),
            blocked: None,
            arrived_s: None,
            noticed: Vec::new(),
        })))
    }

    fn driver(&self) -> Option<&Driver<'a>> {
        if let Self::Drives(driver) = self { Some(driver) } else { None }
    }

    fn driver_mut(&mut self) -> Option<&mut Driver<'a>> {
        if let Self::Drives(driver) = self { Some(driver) } else { None }
    }

    /// Start pose of the robot, and the rules that end its run.
    fn place(&self) -> (Pose, RunRules) {
        match self {
            Self::Drives(driver) => (driver.start, driver.rules.clone()),
            Self::Stands { at, .. } => (*at, RunRules::default()),
        }
    }

    fn controller(&mut self) -> Box<Decide<'_>> {
        match self {
            Self::Drives(driver) => Box::new(|observation| driver.decide(observation)),
            Self::Stands { .. } => Box::new(|_| Control {
                action: Action::Stop,
                remaining_m: f64::INFINITY,
                route: 0,
                turn_left_rad: 0.0,
            }),
        }
    }

    /// Returns the result; `None` for a driving robot without a run, which does not occur.
    fn ended(self, run: Option<&Run>, world: &World) -> Option<Result<Ended, ConfigError>> {
        let (report, min_robot_clearance_m) = match self {
            Self::Stands { report, .. } => (Ok(*report), None),
            Self::Drives(driver) => (driver.report(run?, world), run?.min_robot_clearance_m),
        };
        Some(report.map(|report| Ended { report, min_robot_clearance_m }))
    }
}

/// Adds doubts to those of a run, keeping the last one of each kind.
fn note_doubts(noticed: &mut Vec<Doubt>, doubts: &[Doubt]) {
    for &doubt in doubts {
        match noticed.iter_mut().find(|known| discriminant(*known) == discriminant(&doubt)) {
            Some(known) => *known = doubt,
            None => noticed.push(doubt),
        }
    }
}

/// A robot during its run.
struct Driver<'a> {
    task: Task<'a>,
    observer: &'a mut dyn EpisodeObserver,
    clock: Clock<'a>,
    start: Pose,
    rules: RunRules,
    /// The first route, with its key points and the position where the footprint does not fit.
    route: Route,
    key_points: Vec<Point>,
    misfit: Option<Misfit>,
    navigator: Navigator,
    /// Jerk of the commands so far.
    jerk: CommandJerk,
    /// Number of decisions so far, and their total wall-clock time \[s\].
    cycles: u64,
    decisions_s: f64,
    /// Pass times of the way-points that were passed so far \[s\].
    passed_s: Vec<f64>,
    /// The last time at which the robot was blocked \[s\], and the reason, if any.
    blocked: Option<(f64, Blocked)>,
    /// The first time at which the navigator reported its arrival, after any problem \[s\].
    arrived_s: Option<f64>,
    /// The doubts of the run, one of each kind.
    noticed: Vec<Doubt>,
}

impl Driver<'_> {
    /// Decides on one cycle.
    fn decide(&mut self, observation: &Observation<'_>) -> Control {
        let navigator = &mut self.navigator;
        let (step, step_s) = timed(self.clock, || {
            navigator.observe(observation);
            navigator.step()
        });
        self.decisions_s += step_s.unwrap_or_default();
        let navigator = &self.navigator;
        note_doubts(&mut self.noticed, navigator.doubts());
        let index = self.cycles;
        let t_s = index as f64 * self.task.robot.robot.cycle_s;
        let cycle = Cycle { index, t_s, observation, step: &step, navigator };
        self.observer.decided(&cycle);
        self.passed_s.resize(navigator.way_points_passed(), t_s);
        self.cycles += 1;
        self.jerk.note(step.command());
        let remaining_m = remaining_m(navigator);
        let action = match step {
            _ if self.observer.gives_up() => Action::GiveUp,
            Step::Arrived => {
                self.arrived_s.get_or_insert(t_s);
                Action::Arrived
            }
            Step::Idle => Action::Stop,
            // A recovery attempt is not the cause of the blockage.
            Step::Drive(command) | Step::Blocked { command, why: Blocked::Recovering(_) } => {
                Action::Drive(command)
            }
            Step::Blocked { command, why } => {
                (self.blocked, self.arrived_s) = (Some((t_s, why)), None);
                Action::Drive(command)
            }
        };
        let turn_left_rad = navigator.turn_left_rad();
        Control { action, remaining_m, turn_left_rad, route: navigator.ways_taken() }
    }

    /// Returns the report of the run.
    fn report(self, run: &Run, world: &World) -> Result<RobotReport, ConfigError> {
        let Self { task, clock, ref rules, ref route, ref navigator, .. } = self;
        self.observer.ended(run, &self.navigator);
        let map = task.layer_of(route)?;
        let is_measured = clock.is_some() && self.cycles > 0;
        let controlled = Controlled {
            routes_planned: navigator.routes_planned(),
            recoveries: navigator.recoveries(),
            unsafe_commands: navigator.refusals(),
            way_points: self.way_points(),
            max_jerk_mps3: self.jerk.max_mps3(),
            max_angular_jerk_radps3: self.jerk.max_radps3(),
            mean_cycle_us: is_measured.then(|| self.decisions_s * 1e6 / self.cycles as f64),
        };
        let mrpb = Mrpb::of_run(run, world, Mrpb::safe_distance_m(&task.robot.robot));
        Ok(RobotReport {
            schema: RobotReport::SCHEMA,
            outcome: EpisodeOutcome::of(run.outcome),
            reason: self.reason(run),
            plan: task.plan_part(route, &map, clock),
            smoothed: Some(SmoothedPart::of(route, &map, None)),
            key_points_m: Some(self.key_points),
            misfit: self.misfit,
            noticed: Some(self.noticed.iter().map(Doubt::to_string).collect()),
            run: Some(RunPart::of(run, mrpb, controlled)),
            trajectory: Some(run.samples.iter().map(trajectory_row).collect()),
            inputs: task.inputs(Some(rules.time_limit_s)),
        })
    }

    fn way_points(&self) -> Vec<WayPointPart> {
        let skipped = self.navigator.way_points_skipped();
        let part = |(index, &position): (usize, &Point)| WayPointPart {
            position,
            passed_s: self.passed_s.get(index).copied().filter(|_| !skipped.contains(&index)),
        };
        self.task.robot.via.iter().enumerate().map(part).collect()
    }

    /// Reason why the goal was not reached.
    fn reason(&self, run: &Run) -> Option<String> {
        let RunRules { time_limit_s, stuck_window_s, stuck_progress_m, .. } = self.rules;
        let what = match run.outcome {
            Outcome::Reached => return None,
            Outcome::Collided { pose, with, robot_stood, jumped_onto, mover_speed_mps } => {
                let name = match with {
                    Obstacle::Circle(index) => format!("unknown obstacle {index}"),
                    Obstacle::Mover(index) => format!("moving obstacle {index}"),
                    Obstacle::Border => "the border of the map".to_owned(),
                    Obstacle::Square => "an obstacle of the map".to_owned(),
                    Obstacle::HiddenSquare => "an unknown cell".to_owned(),
                    Obstacle::Polygon(index) => format!("unknown polygon {index}"),
                    Obstacle::Elusive(index) => {
                        format!("temporary or hard-to-detect obstacle {index}")
                    }
                    Obstacle::Robot(index) => format!("robot {index}"),
                };
                let turned = run.samples.last().is_some_and(|last| last.velocity.omega != 0.0);
                let stood = match (robot_stood && run.cycles > 0, turned) {
                    (false, _) => "",
                    (true, false) => ", while the robot was stationary",
                    (true, true) => ", while the robot turned on the spot",
                };
                let jumped = match with {
                    _ if !jumped_onto => "",
                    Obstacle::Elusive(_) => ", which had just appeared",
                    _ => ", just after it had jumped",
                };
                let darted =
                    mover_speed_mps.filter(|&speed_mps| speed_mps > MovingObstacle::DART_MPS);
                let darted =
                    darted.map(|speed_mps| format!(", which moved suddenly at {speed_mps:.1} m/s"));
                let darted = darted.unwrap_or_default();
                format!("touched {name} at ({:.3}, {:.3}){stood}{jumped}{darted}", pose.x, pose.y)
            }
            Outcome::Timeout => format!("the time limit of {time_limit_s:.1} s passed"),
            Outcome::Stuck => format!(
                "the remaining path did not become {stuck_progress_m} m shorter within {stuck_window_s} s"
            ),
        };
        let is_contact = matches!(run.outcome, Outcome::Collided { .. });
        if let Some(arrived) = self.arrived(run).filter(|_| !is_contact) {
            return Some(what + &arrived);
        }
        // A contact has nothing to do with a problem long before.
        let end_s = self.cycles as f64 * self.task.robot.robot.cycle_s;
        let is_of_now = |t_s: f64| !is_contact || end_s - t_s <= BEFORE_CONTACT_S;
        let last = self.blocked.as_ref().filter(|&&(t_s, _)| is_of_now(t_s));
        let last = last.map(|(_, why)| format!("; the last problem: {why}"));
        Some(what + &last.unwrap_or_default())
    }

    /// The error of a robot that reported its arrival, but was not near enough to its goal.
    fn arrived(&self, run: &Run) -> Option<String> {
        let arrived_s = self.arrived_s?;
        let then = run.samples.iter().find(|sample| sample.t_s >= arrived_s)?;
        let off_m = then.pose.point().distance(self.task.robot.goal.position);
        let [own_m, allowed_m] =
            [self.task.robot.stack.controller.goal_tolerance_m, self.rules.goal_tolerance_m];
        if off_m > own_m {
            Some(format!(
                "; at {arrived_s:.1} s the robot believed it was at its goal, but it was {off_m:.2} m away from it: its \
                 localisation was wrong"
            ))
        } else if off_m > allowed_m {
            Some(format!(
                "; at {arrived_s:.1} s the robot arrived within its own tolerance of {own_m} m; the scene allows {allowed_m} m"
            ))
        } else {
            None
        }
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
