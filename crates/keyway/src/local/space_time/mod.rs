//! Keyway's own local planner: it looks for the course through space and time that brings the robot
//! to the end of its route soonest, and begins to drive it.
//!
//! # The method
//! In every cycle, from everything that is known and sensed:
//!
//! 1. **Cost to go.** What is left of the way to where the route leaves the surroundings is
//!    computed for every place around the robot, on ground that is weighed by the room on it
//!    (`cost_to_go.rs`). Ground on which movers walk, and around which the route leads, is blocked.
//!    Where the robot cannot turn around everywhere on that way, so is what its heading costs, by
//!    place and heading (`pose_cost.rs`): it turns before a narrow place, backs into a bay, and
//!    leaves one that it cannot turn in.
//! 2. **Search.** A course is a velocity at the end of each of K stretches; in between it changes
//!    linearly. The W most promising courses are followed from stretch to stretch, as in a beam
//!    search: each goes on with every pair of a few speeds and turn rates, and of those that lead
//!    to nearly the same state only the best one is kept (`search.rs`). States from which the robot
//!    could not brake along its arc are left out, and ways backwards over ground that it has not
//!    seen.
//! 3. **Polish.** The velocities of the best course are changed by small steps, one by one, as long
//!    as that makes it better (`polish.rs`).
//! 4. **Go on.** Where nothing moves, what is left of the last course, polished in the same way, is
//!    taken unless the new one is better; by 0.3 s, where it passes something on the other side
//!    (`commitment.rs`). So a side that was taken is kept.
//! 5. **Command.** What the first cycle of the course asks for goes through the [stop
//!    rule](StopRule) for what stands. When that refuses it, the search is made again among the
//!    beginnings that it lets pass.
//!
//! A course is worth the time until its end, the time to go from there, and what it costs on the
//! way (`course.rs`, `meeting.rs`):
//!
//! | symbol | meaning | parameter | unit |
//! |---|---|---|---|
//! | H, K, W | horizon, stretches, courses that are followed (W / 2 where nothing moves) | `horizon_s`, `stretches`, `width` | s |
//! | T | time of the course, and the time to go from its end | | s |
//! | r, m | room around the footprint, and what the robot likes to have | `comfortable_m` | m |
//! | q | clearance: q times the integral of ((1 - r / m)² + 8 (1 - 5 r / m)²) abs(v) / `v_max`, where r < m, the second term where r < m / 5 | `discomfort` | |
//! | u | steering: u times the integral of what the accelerations are of their limits, squared | `steering` | |
//! | j | jerk: j times a stretch and the squared change of the acceleration, in parts of its limit, from that with which the last course goes on | `jerk` | |
//! | n, p, a | movers: room, weight of a contact, what they accelerate (but by no more than their own speed) | `mover_room_m`, `contact`, `mover_acceleration_mps2` | m, , m/s² |
//!
//! The second term of q counts only as far as it is more than with the room that the robot has now,
//! or, where it is slow, may use now: a tight place does not become wider because the robot stays
//! in it.
//!
//! So there are no weights of heading, speed and distance to balance: what turns away from the way,
//! drives slowly or takes a detour takes longer, and everything else is given as the time that it
//! is worth.
//!
//! # Source
//! The parts are known: an exact cost to go inside of a dynamic window is that of \[Brock1999\]; a
//! search through states and time that grows by short motions that the robot can drive, that of
//! \[Fraichard1993\]; the beam is that of \[Lowerre1976\]. What is not theirs: all of it in every
//! cycle, with the time to go in place of weights.
//!
//! # What follows from it
//! - **No contact with what stands and is seen**, with ideal motion: every command has passed the
//!   stop rule, or is what that rule puts in its place. See there for the proof.
//! - **No contact with what stands beyond what is seen**: it never drives faster than it can stop
//!   within what it has seen free. On open ground that is [`Robot::sight_mps`]; where that is below
//!   the robot's top speed, it is the top speed.
//! - It does not stand in a narrow way because of how narrow it is: that of where it is costs
//!   nothing.
//! - It waits, makes way, backs up, turns around and passes behind something that moves where that
//!   is the fastest way on; none of it is a rule of its own.
//! - Nothing is promised about movers. They are expected to go on as they do, up to the next wall.
//!
//! # Where it is not exact
//! Room is that of points on the outline between the points of a grid (`room.rs`): exact at flat
//! sides, to less than half a cell beside corners, and where the footprint is nearly too near to
//! something its true distance. Only the first cycle, and how the robot would stop after it, are
//! always judged exactly, by the stop rule.
//!
//! # Errors / cost
//! [`ConfigError`]; [`NoCommand`] when no course is free. Per cycle the surroundings, of `v_max` H
//! to each side, are filled once. About W K 15 stretches are proposed; those that may be among the
//! best are driven, or all where none leads on. Allocates nothing once the scratch is warm. The
//! same scene gives the same command on any machine: nothing is random, and nothing depends on
//! time.

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

/// The planner.
#[derive(Clone, Debug)]
pub struct SpaceTime {
    config: SpaceTimeConfig,
    robot: Arc<Robot>,
    outline: Outline,
    rear: Rear,
    gate: StopRule,
}

/// What a decision works in.
#[derive(Debug, Default)]
struct Work {
    around: Around,
    beam: Beam,
    /// What is left of the last course.
    rest: Vec<Velocity>,
}

/// A course would touch something.
const CONTACT: &str = "contact";

/// The stop rule does not let its first cycle pass.
const STOP_RULE: &str = "stop-rule";

const RULES: [(&str, &str); 3] = [
    (CONTACT, "touch something or lead backwards where the robot has not looked"),
    (STOP_RULE, "lead where the robot could not stop in time"),
    (Rejections::MOVER, "lead near something that moves"),
];

impl SpaceTime {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "space-time";

    /// Beside something a robot that is slower than the second part of its top speed may come nearer
    /// by the first: it could not turn away otherwise.
    const NEARER: [f64; 2] = [0.5, 0.2];

    /// A heading that costs less is right \[s\].
    const TURNED_S: f64 = 0.3;

    /// A planner for a robot.
    ///
    /// # Errors
    /// When a value of the robot or the config cannot be used, or the two do not fit together; the
    /// error names the field.
    pub fn new(config: SpaceTimeConfig, robot: impl Into<Arc<Robot>>) -> Result<Self, ConfigError> {
        let robot = robot.into();
        let gate = StopRule::for_any_brakes(StopRuleConfig::for_robot(&robot), Arc::clone(&robot))?;
        config.check(&robot)?;
        let rear = Rear::of(&robot.footprint, Outline::SPACING);
        let robot = within_sight(robot);
        Ok(Self { outline: Outline::of(&robot), rear, config, robot, gate })
    }

    /// The robot that it drives.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// As far as a course leads \[m\].
    fn reach_m(&self) -> f64 {
        self.robot.limits.v_max_mps * self.config.horizon_s
    }

    /// What the first cycle of a course asks for.
    fn command(&self, scene: &Scene<'_>, first: Velocity, judge: &Judge<'_>) -> Velocity {
        let Robot { limits, cycle_s, .. } = &*self.robot;
        let asked = scene.velocity.lerp(first, cycle_s / judge.stretch_s);
        let stoppable = limits.stoppable_mps(scene.velocity.v, judge.remaining_m, *cycle_s);
        let asked = Velocity::new(asked.v.clamp(-stoppable, stoppable), asked.omega);
        limits.reached(scene.velocity, asked, *cycle_s)
    }

    /// How far and how wide it searches.
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

    /// True if the stop rule lets the first cycle of a course pass.
    fn passes(
        &self,
        scene: &Scene<'_>,
        first: Velocity,
        judge: &Judge<'_>,
        scratch: &mut Scratch,
    ) -> bool {
        let command = self.command(scene, first, judge);
        // What its rear may be on is asked of every course.
        let seen = SeenCells { behind: None, ..scene.seen };
        let around = Surroundings { seen, ..Surroundings::standing(scene) };
        self.gate.lets_pass(&around, command, scratch)
    }

    /// The best course whose first cycle the stop rule lets pass; empty when there is none. What is
    /// left of the last course competes with what is found anew.
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
        // Movers do other things than they are expected to do: what was best a moment ago is not
        // any more.
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

    /// No course lasts longer, however its stretches are rounded \[s\].
    fn farthest_s(&self) -> f64 {
        1.001 * self.config.horizon_s
    }

    fn meeting<'a>(&self, around: &'a Around) -> Meeting<'a> {
        let SpaceTimeConfig { mover_room_m, contact, .. } = self.config;
        let horizon_s = self.farthest_s();
        Meeting { movers: &around.movers, comfortable_m: mover_room_m, contact, horizon_s }
    }

    /// Where courses begin, and what they are judged by.
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
        let (margin_m, around_m) = (self.robot.safety_margin_m(), (&around.room, exact));
        let now_m = self.outline.exact_room_m(around_m, (at, ahead), (margin_m, comfortable_m));
        let [nearer, slow] = Self::NEARER;
        let is_slow = scene.velocity.v.abs() <= slow * self.robot.limits.v_max_mps;
        // Who stands nearer may turn away, by which its tail comes nearer; who touches something
        // has less than no room.
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
        // Who has to turn elsewhere may have to leave the end of its way once more.
        if around.pose_cost.of(at, ahead).is_some_and(|heading_s| heading_s > Self::TURNED_S) {
            judge.remaining_m = f64::INFINITY;
        }
        // No course need be longer than the way: near the end, stretches become finer.
        let shorter_s = judge.time_to_go_s(&start) / f64::from(self.config.stretches);
        let whole_s = judge.stretch_s;
        judge.stretch_s = shorter_s.clamp(self.robot.cycle_s, whole_s);
        // There the robot must be able to correct itself at once.
        if judge.stretch_s < whole_s {
            judge.jerk = 0.0;
        }
        (start, judge)
    }

    /// The command, and the evidence for it.
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

/// The same robot, no faster than it can stop within what its sensor surely sees, ahead and back.
/// One that surely sees no farther than its own front creeps.
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

/// What is known of the stretches that were tried, and of the course that was chosen, which may
/// begin with standing.
fn evaluation(tally: Tally, chosen: Option<&Total>, stands: bool) -> Evaluation {
    let comes_near = |total: &Total| total.cost.movers_s > Beam::MEETING_S;
    let near_mover = tally.meets && chosen.is_some_and(comes_near);
    // To come near to something that moves takes time, and is not forbidden. Where the best course
    // stands because of it, all that lead on are not driven because of it.
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

/// What a course costs, by reason; less is better.
fn shares(total: &Total) -> Shares {
    // Of 0 that is 0, without a sign.
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
