//! Keyway's own local planner. It searches for the space-time trajectory that brings the robot to
//! the end of its route soonest, and executes the beginning of it.
//!
//! # The method
//! In every cycle, from the map and the sensor data:
//!
//! 1. **Cost to go.** The remaining path length to the point where the route leaves the local
//!    window is computed from every position around the robot, on ground that is weighted by its
//!    clearance (`cost_to_go.rs`). Ground on which moving obstacles walk, and around which the
//!    route leads, is blocked. If the robot cannot turn around everywhere along that path, the
//!    cost of its heading is computed as well, by position and heading (`pose_cost.rs`): it turns
//!    before a narrow passage, backs into a bay, and leaves one that it cannot turn in.
//! 2. **Search.** A trajectory is given by the velocity at the end of each of K stretches; in
//!    between the velocity changes linearly. The W most promising trajectories are extended from
//!    stretch to stretch, as in a beam search: each is extended with every pair of a few speeds
//!    and turn rates, and of those that lead to nearly the same state only the best one is kept
//!    (`search.rs`). States from which the robot could not brake along its arc are pruned, and so
//!    are backward motions over ground that it has not observed.
//! 3. **Polish.** The velocities of the best trajectory are changed by small steps, one by one,
//!    as long as that improves it (`polish.rs`).
//! 4. **Continue.** If nothing moves, the rest of the last trajectory, polished in the same way,
//!    is taken unless the new one is better; by 0.3 s, if the new one passes an obstacle on the
//!    other side (`commitment.rs`). So the robot keeps to a side once chosen.
//! 5. **Command.** The command of the first cycle of the trajectory passes the [stop
//!    rule](StopRule) for stationary obstacles. If that refuses it, the search is repeated among
//!    the beginnings that it admits.
//!
//! The cost of a trajectory is its duration, the time to go from its end, and the penalties along
//! it (`course.rs`, `meeting.rs`):
//!
//! | symbol | meaning | parameter | unit |
//! |---|---|---|---|
//! | H, K, W | horizon, stretches, trajectories that are extended (W / 2 if nothing moves) | `horizon_s`, `stretches`, `width` | s |
//! | T | duration of the trajectory, and the time to go from its end | | s |
//! | r, m | clearance around the footprint, and the preferred clearance | `comfortable_m` | m |
//! | q | clearance: q times the integral of ((1 - r / m)² + 8 (1 - 5 r / m)²) abs(v) / `v_max`, where r < m, the second term where r < m / 5 | `discomfort` | |
//! | u | steering: u times the integral of the squared accelerations, in parts of their limits, a quarter of it for the linear one | `steering` | |
//! | j | jerk: j times a stretch and the squared change of the acceleration from that of the last trajectory, in parts of its limit, a quarter of it for the linear one | `jerk` | |
//! | n, p, a | moving obstacles: clearance, weight of a contact, acceleration (limited by their own speed) | `mover_room_m`, `contact`, `mover_acceleration_mps2` | m, , m/s² |
//!
//! The second term of q counts only by its excess over the value at the robot's present clearance
//! or, if the robot is slow, at the clearance that it may use now: a tight passage does not
//! become wider because the robot stays in it.
//!
//! So there are no weights of heading, speed and distance to balance: a trajectory that turns
//! away from the route, is slow or takes a detour takes longer, and everything else is expressed
//! in seconds.
//!
//! # Source
//! The parts are known: an exact cost to go inside of a dynamic window is from \[Brock1999\]; a
//! search through states and time that grows by short feasible motions, from \[Fraichard1993\];
//! the beam is from \[Lowerre1976\]. New here: all of it in every cycle, with the time to go in
//! place of weights.
//!
//! # Properties
//! - **No contact with observed stationary obstacles**, with ideal motion: every command has
//!   passed the stop rule, or is the rule's substitute. See there for the proof.
//! - **No contact with stationary obstacles beyond the observed space**: the robot never drives
//!   faster than it can stop within observed free space. On open ground that speed is
//!   [`Robot::sight_mps`]; if it is below the robot's top speed, it is the top speed.
//! - The robot does not stop in a narrow passage because it is narrow: the clearance at its
//!   present pose costs nothing.
//! - It waits, gives way, backs up, turns around and passes behind a moving obstacle if that is
//!   the fastest way to proceed; there is no special rule for any of these.
//! - Nothing is guaranteed about moving obstacles. They are predicted to continue as they move,
//!   up to the next wall.
//!
//! # Approximations
//! Clearance is evaluated at points on the outline, interpolated between the points of a grid
//! (`room.rs`): it is exact at flat sides and to less than half a cell beside corners, and the
//! true distance is used if the footprint is nearly too close to an obstacle. Only the first
//! cycle, and the braking after it, are always checked exactly, by the stop rule.
//!
//! # Errors / cost
//! [`ConfigError`]; [`NoCommand`] if no trajectory is free. Per cycle the local window, of
//! `v_max` H to each side, is filled once. About W K 15 stretches are proposed; those that may be
//! among the best are simulated, or all if none of them is free. Allocates nothing once the
//! scratch is warm. The same scene gives the same command on any machine: nothing is random, and
//! nothing depends on wall-clock time.

mod around;
mod buckets;
mod commitment;
mod config;
mod cost_to_go;
mod course;
mod explain;
mod fitting;
mod free_headings;
mod lattice;
mod meeting;
mod near;
mod polish;
mod pose_cost;
mod pose_times;
mod room;
mod search;
mod targets;
#[cfg(test)]
mod tests;
mod way_ahead;

pub use config::SpaceTimeConfig;

use super::parameters::{BoxedLocalPlanner, LocalParameters};
use super::rear::Rear;
use super::{
    Course, Decision, DriveMemory, Evaluation, Explanation, LocalPlanner, NoCommand, OwnMemory,
    Rejections, Scene, Scratch, Share, Shares, StopRule, StopRuleConfig, Surroundings,
};
use crate::ConfigError;
use crate::geometry::{Point, Velocity};
use crate::map::GridFrame;
use crate::robot::{Limits, Robot};
use crate::sense::SeenCells;
use around::Around;
use commitment::{go_on, going_on, reluctance_s};
use course::{Judge, State};
use meeting::Meeting;
use polish::{FINEST, STEPS, Total, can_stop, polish};
use room::{Exact, Outline};
use search::{Beam, Extent, Tally};
use std::sync::Arc;

/// The space-time planner.
#[derive(Clone, Debug)]
pub struct SpaceTime {
    config: SpaceTimeConfig,
    robot: Arc<Robot>,
    outline: Outline,
    rear: Rear,
    gate: StopRule,
}

/// Working memory of a decision.
#[derive(Debug, Default)]
struct Work {
    around: Around,
    beam: Beam,
    /// Rest of the last trajectory.
    rest: Vec<Velocity>,
}

/// Rejection: the trajectory would touch something.
const CONTACT: &str = "contact";

/// Rejection: the stop rule refuses its first cycle.
const STOP_RULE: &str = "stop-rule";

const RULES: [(&str, &str); 3] = [
    (CONTACT, "touch something or lead backwards over unobserved ground"),
    (STOP_RULE, "could not stop in time"),
    (Rejections::MOVER, "come too near to a moving obstacle"),
];

impl SpaceTime {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "space-time";

    /// Near an obstacle, a robot that is slower than the second fraction of its top speed may
    /// reduce its clearance to the first fraction of the present one: it could not turn away
    /// otherwise.
    const NEARER: [f64; 2] = [0.5, 0.2];

    /// Creates a planner for a robot.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] if a value of the robot or the config is invalid, or the two do
    /// not fit together; the error names the field.
    pub fn new(config: SpaceTimeConfig, robot: impl Into<Arc<Robot>>) -> Result<Self, ConfigError> {
        let robot = robot.into();
        let gate = StopRule::for_any_brakes(StopRuleConfig::for_robot(&robot), Arc::clone(&robot))?;
        config.check(&robot)?;
        let rear = Rear::of(&robot.footprint, Outline::SPACING);
        let robot = within_sight(robot);
        Ok(Self { outline: Outline::of(&robot), rear, config, robot, gate })
    }

    /// The robot that is driven.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Largest length of a trajectory \[m\].
    fn reach_m(&self) -> f64 {
        self.robot.limits.v_max_mps * self.config.horizon_s
    }

    /// Command of the first cycle of a trajectory.
    fn command(&self, scene: &Scene<'_>, first: Velocity, judge: &Judge<'_>) -> Velocity {
        let Robot { limits, cycle_s, .. } = &*self.robot;
        // A car-like robot that is to stop, often in order to reverse, does so at once: by a part
        // of its speed in every cycle it never would.
        let stops = first == Velocity::ZERO && !limits.turns_in_place();
        let part = if stops { 1.0 } else { cycle_s / judge.stretch_s };
        let asked = scene.velocity.lerp(first, part);
        let stoppable = limits.stoppable_mps(scene.velocity.v, judge.remaining_m, *cycle_s);
        let asked = Velocity::new(asked.v.clamp(-stoppable, stoppable), asked.omega);
        limits.reached(scene.velocity, asked, *cycle_s)
    }

    /// Size and resolution of the search.
    fn extent(&self, scene: &Scene<'_>, judge: &Judge<'_>) -> Extent {
        let SpaceTimeConfig { width, stretches, backwards, .. } = self.config;
        let width = if judge.meeting.movers.is_empty() { width.div_ceil(2) } else { width };
        let bin_m = 0.5 * self.outline.inscribed_m.max(scene.obstacles.frame().resolution_m());
        Extent {
            stretches,
            width: width as usize,
            lowest_mps: if backwards { self.robot.limits.v_min_mps } else { 0.0 },
            bin_m,
            elsewhere_m: 0.5 * bin_m.min(judge.remaining_m),
        }
    }

    /// True if the stop rule lets the first cycle of a trajectory pass.
    fn passes(
        &self,
        scene: &Scene<'_>,
        first: Velocity,
        judge: &Judge<'_>,
        scratch: &mut Scratch,
    ) -> bool {
        let command = self.command(scene, first, judge);
        // The observed space behind the robot is checked for every trajectory already.
        let seen = SeenCells { behind: None, ..scene.seen };
        let around = Surroundings { seen, ..Surroundings::standing(scene) };
        self.gate.lets_pass(&around, command, scratch)
    }

    /// Finds the best trajectory whose first cycle the stop rule admits; empty if there is none.
    /// The rest of the last trajectory competes with the new one.
    fn search(
        &self,
        scene: &Scene<'_>,
        (start, judge): (&State, &Judge<'_>),
        (beam, rest): (&mut Beam, &mut Vec<Velocity>),
        scratch: &mut Scratch,
    ) -> Tally {
        let extent = self.extent(scene, judge);
        let tally = beam.search(*start, judge, &extent, |_| true);
        let lowest_mps = extent.lowest_mps;
        let found_s = polish(&mut beam.best, start, judge, (&STEPS, lowest_mps));
        // Moving obstacles deviate from their prediction: the trajectory that was best a moment
        // ago is not any more.
        if judge.meeting.movers.is_empty() {
            let rest_s = polish(rest, start, judge, (&FINEST, lowest_mps));
            let is_best = rest_s.is_finite()
                && rest_s <= found_s + reluctance_s(rest, &beam.best, start, judge);
            if is_best && can_stop(start, rest, judge) {
                std::mem::swap(&mut beam.best, rest);
            }
        }
        let mut passes = |first: Velocity| self.passes(scene, first, judge, scratch);
        if beam.best.first().is_none_or(|&first| passes(first)) {
            return tally;
        }
        beam.search(*start, judge, &extent, passes)
    }

    /// Upper limit of the duration of a trajectory, including the rounding of its stretches
    /// \[s\].
    fn farthest_s(&self) -> f64 {
        1.001 * self.config.horizon_s
    }

    fn meeting<'a>(&self, around: &'a Around) -> Meeting<'a> {
        let SpaceTimeConfig { mover_room_m, contact, .. } = self.config;
        let horizon_s = self.farthest_s();
        Meeting { movers: &around.movers, comfortable_m: mover_room_m, contact, horizon_s }
    }

    /// The initial state of trajectories, and the criteria by which they are judged.
    fn judge<'a>(
        &'a self,
        scene: &Scene<'a>,
        around: &'a Around,
        (meeting, last): (&'a Meeting<'a>, Option<&Course>),
        beyond_m: f64,
    ) -> (State, Judge<'a>) {
        let frame = scene.obstacles.frame();
        let (sin, cos) = libm::sincos(scene.pose.theta - frame.origin().theta);
        let (at, ahead) = (local(frame, scene.pose.point()), Point::new(cos, sin));
        let start = State { at, ahead, velocity: scene.velocity, after_s: 0.0 };
        let SpaceTimeConfig { comfortable_m, discomfort, steering, jerk, .. } = self.config;
        let exact = Exact { footprint: &self.robot.footprint, obstacles: scene.obstacles };
        let (margin_m, around_m) = (self.robot.safety_margin_or_default_m(), (&around.room, exact));
        let now_m = self.outline.exact_room_m(around_m, (at, ahead), (margin_m, comfortable_m));
        let [nearer, slow] = Self::NEARER;
        let is_slow = scene.velocity.v.abs() <= slow * self.robot.limits.v_max_mps;
        // A robot inside the margin may turn away, although its tail then comes nearer; one that
        // touches something has a negative clearance.
        let nearest_m = (now_m - 1e-6).min(if is_slow { nearer * now_m } else { now_m });
        let mut judge = Judge {
            limits: &self.robot.limits,
            outline: &self.outline,
            room: &around.room,
            exact,
            seen: scene.seen.behind.map(|cells| self.rear.over(cells, frame)),
            cost_to_go: &around.cost_to_go,
            pose_cost: &around.pose_cost,
            meeting,
            beyond_m,
            comfortable_m,
            least_m: margin_m.min(nearest_m),
            tight_now_sq: Judge::tight_sq(nearest_m, comfortable_m),
            discomfort,
            steering,
            jerk,
            before: going_on(last, scene.velocity, &self.robot),
            stretch_s: self.config.stretch_s(),
            remaining_m: scene.remaining_m,
        };
        // A robot that has to turn elsewhere may have to leave the end of its route once more.
        if around.pose_cost.turns_elsewhere(at, ahead) {
            judge.remaining_m = f64::INFINITY;
        }
        // No trajectory needs to be longer than the route: near the end, stretches become finer.
        let shorter_s = judge.time_to_go_s(&start) / f64::from(self.config.stretches);
        let whole_s = judge.stretch_s;
        judge.stretch_s = shorter_s.clamp(self.robot.cycle_s, whole_s);
        // There the robot must be able to correct itself at once.
        if judge.stretch_s < whole_s {
            judge.jerk = 0.0;
        }
        (start, judge)
    }

    /// The command, and the evaluation behind it.
    fn decided(
        &self,
        scene: &Scene<'_>,
        around: &Around,
        beyond_m: f64,
        (beam, rest): (&mut Beam, &mut Vec<Velocity>),
        (memory, scratch): (&mut DriveMemory, &mut Scratch),
    ) -> Result<Decision, NoCommand> {
        let meeting = self.meeting(around);
        let (start, judge) = self.judge(scene, around, (&meeting, memory.course()), beyond_m);
        let extent = (self.config.stretches, self.robot.cycle_s);
        go_on(rest, memory.course(), &start, &judge, extent);
        memory.own = OwnMemory::Nothing;
        let tally = self.search(scene, (&start, &judge), (beam, rest), scratch);
        let command = beam.best.first().map(|&first| self.command(scene, first, &judge));
        let stands = command.is_some_and(|command| self.robot.stands(command));
        let total = Total::of(&start, &beam.best, &judge);
        let evaluation = evaluation(tally, total.as_ref(), stands);
        let Some(command) = command else {
            let fallback = self.robot.limits.braked(scene.velocity, self.robot.cycle_s);
            return Err(NoCommand { evaluation, fallback });
        };
        let velocities = beam.best.iter().copied().collect();
        memory.own = OwnMemory::Course(Course { stretch_s: judge.stretch_s, velocities });
        Ok(Decision { command, evaluation })
    }
}

/// The same robot, limited to the speed from which it can stop within the certain range of its
/// sensor, ahead and backwards. If that range ends at its own front, it creeps.
fn within_sight(robot: Arc<Robot>) -> Arc<Robot> {
    const CREEPING_MPS: f64 = 0.02;
    let sight_mps = robot.sight_mps().max(CREEPING_MPS);
    if robot.limits.v_max_mps <= sight_mps {
        return robot;
    }
    let v_min_mps = robot.limits.v_min_mps.max(-sight_mps);
    let limits = Limits { v_max_mps: sight_mps, v_min_mps, ..robot.limits.clone() };
    Arc::new(Robot { limits, ..(*robot).clone() })
}

/// A position along the axes of the map's cells, from the corner of the map at its origin \[m\].
fn local(frame: &GridFrame, point: Point) -> Point {
    frame.grid_from_world(point) * frame.resolution_m()
}

/// The evaluation of the tried stretches and of the chosen trajectory, which may begin at rest.
fn evaluation(tally: Tally, chosen: Option<&Total>, stands: bool) -> Evaluation {
    let comes_near = |total: &Total| total.cost.movers_s > Beam::MEETING_S;
    let near_mover = tally.meets && chosen.is_some_and(comes_near);
    // Coming near to a moving obstacle costs time, and is not forbidden. If the best trajectory
    // waits because of it, all driving ones count as rejected because of it.
    let waiting = if near_mover && stands { tally.driving } else { 0 };
    let mut rejected = Rejections::none_by(&RULES);
    rejected.add_many(CONTACT, tally.touching);
    rejected.add_many(STOP_RULE, tally.refused);
    rejected.add_many(Rejections::MOVER, waiting);
    Evaluation {
        candidates: tally.tried,
        driving: tally.driving - waiting,
        rejected,
        near_mover,
        chosen: chosen.map(shares).unwrap_or_default(),
        runner_up: None,
    }
}

/// Costs of a trajectory by reason; less is better.
fn shares(total: &Total) -> Shares {
    // A raw value of 0 gives 0 without a sign.
    let share =
        |term: &'static str, raw: f64| Share { term: term.into(), raw, weighted: 0.0 - raw };
    Shares::from_iter([
        share("time", total.time_s),
        share("clearance", total.cost.clearance_s),
        share("movers", total.cost.movers_s),
        share("steering", total.cost.steering_s),
    ])
}

impl LocalParameters for SpaceTimeConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self, robot: &Arc<Robot>) -> Result<BoxedLocalPlanner, ConfigError> {
        Ok(Box::new(SpaceTime::new(self.clone(), Arc::clone(robot))?))
    }

    fn stops_within_sight(&self) -> bool {
        true
    }
}

impl LocalPlanner for SpaceTime {
    fn decide(
        &self,
        scene: &Scene<'_>,
        memory: &mut DriveMemory,
        scratch: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        let position = scene.pose.point();
        memory.covered_m = scene.path.nearest_along(position, memory.covered_m, self.reach_m());
        let Work { mut around, mut beam, mut rest } = std::mem::take(scratch.part());
        let beyond_m = self.look(&mut around, scene, memory.covered_m);
        let courses = (&mut beam, &mut rest);
        let decision = self.decided(scene, &around, beyond_m, courses, (memory, scratch));
        *scratch.part() = Work { around, beam, rest };
        decision
    }

    fn explain(&self, scene: &Scene<'_>, memory: &DriveMemory) -> Explanation {
        self.explained(scene, memory)
    }

    fn turns_in_time(&self) -> bool {
        true
    }
}
