//! The navigation loop, as a value with `observe` and `step`.

mod arriving;
mod changes;
mod deciding;
mod driving;
mod guarding;
mod making_way;
mod no_return;
mod recovering;
mod replanning;
mod slowing;
mod stored_record;
mod storing;
mod tasks;
mod turning_first;
mod views;

use super::act::Act;
use super::recovery::Moment;
use super::task::Task;
use super::time::Time;
use super::world::{Told, World};
use super::{Blocked, FittedStack, NavigateError, RecoveryCounts, Step};
use crate::geometry::{Pose, Shift, Velocity};
use crate::local::{DriveMemory, Evaluation, JerkLimited, Scratch};
use crate::map::OccupancyGrid;
use crate::robot::{CommandWindow, Robot};
use crate::sense::Observation;
use deciding::Deciding;
use guarding::{Guard, beside_movers};
use serde::{Deserialize, Serialize};
use slowing::Slow;
use std::sync::Arc;
pub(super) use stored_record::StoredRecord;

/// Drives a robot to goals: it plans on the known map, keeps the sensed obstacles, follows the
/// guide points of its route with the local planner, replans when the route is obstructed, and
/// runs its recoveries when it makes no progress.
///
/// It takes measurements ([`Self::observe`]) and returns a command in every cycle
/// ([`Self::step`]). Goals may change while it drives: the sensed obstacles are kept.
///
/// Its only inputs are the known map, poses, velocities and scans, and it reads no clock: the
/// same inputs give the same commands. Frames and units are those of the map: metres, radians,
/// seconds.
pub struct Navigator {
    parts: FittedStack,
    world: World,
    /// The present errand, if there is one.
    errand: Option<Errand>,
    record: Record,
    /// Speed limit \[m/s\].
    speed_limit_mps: Option<f64>,
    /// The parts for a speed limit, if there is one.
    slow: Option<Slow>,
    /// Pose of the robot, as observed or set.
    place: Option<Pose>,
    /// Time of the last step.
    stepped: Option<Time>,
    /// Number of steps since the last accepted observation.
    unobserved: u32,
    /// The last step, as long as nothing has changed since.
    last: Option<Step>,
    /// The last command, from which the robot brakes if its velocity is outdated.
    issued: Velocity,
}

/// A job for the robot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum Errand {
    /// Drive to a goal, or along a path.
    Drive(Box<Task>),
    /// Execute a single motion.
    Act(Act),
}

/// State of decisions that is independent of the goal.
struct Record {
    /// Statistics of the candidates of the last decision.
    evaluation: Evaluation,
    /// The last query to the local planner; `None` if it was not called.
    asked: Option<Asked>,
    guard: Guard,
    counts: Counts,
    /// Not meaningful between decisions.
    scratch: Scratch,
}

/// A query to the local planner, as far as it is not stored elsewhere.
#[derive(Clone, Debug)]
struct Asked {
    pose: Pose,
    velocity: Velocity,
    /// State of the robot itself; the same, unless its commands are averaged.
    robot_then: (Pose, Velocity),
    /// The averaging window at that time, if commands are averaged.
    window: Option<CommandWindow>,
    /// Memory of the local planner before the query.
    memory: DriveMemory,
}

impl Asked {
    fn jerk_limited(&self) -> Option<JerkLimited<'_>> {
        let (window, (pose, velocity)) = (self.window.as_ref()?, self.robot_then);
        Some(JerkLimited { window, pose, velocity })
    }
}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Counts {
    routes_planned: u32,
    ways_taken: u32,
    recoveries: RecoveryCounts,
}

impl Navigator {
    /// A navigator without a goal that knows only the map, of which it takes a copy.
    ///
    /// # Errors
    /// Returns [`NavigateError`] if the layers of the map, or the planner on them, cannot be
    /// built as the stack requires.
    pub fn new(known: &OccupancyGrid, stack: &FittedStack) -> Result<Self, NavigateError> {
        Ok(Self {
            world: World::new(&Arc::new(known.clone()), stack)?,
            errand: None,
            speed_limit_mps: None,
            slow: None,
            record: Record {
                evaluation: Evaluation::default(),
                asked: None,
                guard: Guard::new(stack.stop_rule.clone()),
                counts: Counts::default(),
                scratch: Scratch::default(),
            },
            place: None,
            stepped: None,
            unobserved: 0,
            last: None,
            issued: Velocity::ZERO,
            parts: stack.clone(),
        })
    }

    /// Takes in an observation. It is discarded if its stamp, its pose or its velocity is
    /// implausible, or if it is older than the observation before; the next step then stops the
    /// robot and reports the reason.
    ///
    /// A pose that the robot cannot have reached by driving is a correction, as by
    /// [`Self::relocate`]. [`Self::doubts`] reports this and other contradictions.
    ///
    /// May be called any number of times between two steps, as measurements arrive. A scan is
    /// placed at the pose of the robot at the time of the scan; one that is no newer than the
    /// last of its sensor is ignored.
    pub fn observe(&mut self, observation: &Observation<'_>) {
        self.forget_last();
        let before = self.world.told().map(|told| told.time).ok();
        let shift = self.world.observe(&self.parts, observation);
        if let Ok(told) = self.world.told() {
            let is_first = self.place.is_none();
            self.place = Some(told.pose);
            // A repeated pose carries no information on the present one.
            if before.is_none_or(|before| told.time > before) {
                self.unobserved = 0;
            }
            if is_first && self.errand.is_some() {
                self.plan_again();
            }
        }
        if let Some(shift) = shift {
            self.shift_errand(&shift);
            self.plan_again();
        }
    }

    /// Discards the last result because an input has changed.
    fn forget_last(&mut self) {
        (self.last, self.record.asked) = (None, None);
    }

    /// Moves the activity along with a correction of the robot's pose: a correction is no motion.
    fn shift_errand(&mut self, shift: &Shift) {
        match &mut self.errand {
            Some(Errand::Act(act)) => act.shift(shift),
            Some(Errand::Drive(task)) => {
                task.mode.shift(shift);
                task.met.shift(shift);
            }
            None => {}
        }
    }

    /// Runs one control cycle: returns the step for the present observations. It accounts for the
    /// time by the stamps since the last step, the first one for one cycle of the robot. Called
    /// again before any input has changed, it returns the same step, which counts once.
    ///
    /// For a robot with an [`Robot::actuation_delay_s`], the command is chosen for the state in
    /// which it takes effect. The command is assumed to be executed: a caller that gives another
    /// one must report it ([`Self::note_override`]), or the prediction is wrong. The navigator
    /// learns delays that differ from the description, and commands that are too small to move
    /// the robot ([`Self::doubts`]). For any reported velocity, the command is within the robot's
    /// speed limits.
    pub fn step(&mut self) -> Step {
        self.unobserved = self.unobserved.saturating_add(1);
        let told = match self.world.told() {
            Ok(told) => told,
            Err(why) => return self.stop(why),
        };
        let now = self.world.now().unwrap_or(told.time);
        let staleness = self.staleness(&told, now);
        if let Some(last) = self.last.as_ref().filter(|_| staleness.is_none()) {
            return last.clone();
        }
        self.record.asked = None;
        self.record.guard.pause();
        let step = self.stepped(&told, now, staleness);
        // The decision may be to brake from a velocity beyond the limits, as odometry may report
        // one.
        let command = self.parts.robot.limits.clamped(step.command());
        let command = self.world.motors.smoothed(now, command);
        self.world.motors.give(told.time, now, command);
        let step = step.commanding(command);
        (self.issued, self.last) = (command, Some(step.clone()));
        step
    }

    /// Like [`Self::step`], at a time that may be later than all stamps so far \[s\], by the
    /// clock of the stamps: the measurements age accordingly, and a pose that is too old stops
    /// the robot. An earlier time, or one that is not finite, is ignored.
    pub fn step_at(&mut self, now_s: f64) -> Step {
        if self.world.pass_time(now_s) {
            self.forget_last();
        }
        self.step()
    }

    /// Stops at once, without a known pose; within its jerk limits, if it has any.
    fn stop(&mut self, why: Blocked) -> Step {
        self.record.asked = None;
        self.record.guard.pause();
        self.stepped = None;
        let command = self.world.motors.stopping();
        self.issued = command;
        if let Some(now) = self.world.now() {
            self.world.motors.give(now, now, command);
        }
        Step::Blocked { command, why }
    }

    /// Longest time that a step accounts for, or three cycles: a caller that has paused for
    /// longer has not waited \[s\].
    const LONGEST_S: f64 = 1.0;

    fn stepped(&mut self, told: &Told, now: Time, staleness: Option<Blocked>) -> Step {
        let &Told { time, pose, velocity } = told;
        let velocity = self.parts.robot.without_noise(velocity, self.issued);
        let robot_then = self.world.motors.predicted(time, now, (pose, velocity));
        let (pose_then, velocity_then) = self.world.motors.begin(now, robot_then);
        let Robot { limits, cycle_s, .. } = &*self.parts.robot;
        let braked = limits.braked(velocity_then, *cycle_s);
        let outside =
            |pose: &Pose| self.world.known.frame().cell_from_world(pose.point()).is_none();
        let since = self.stepped.take();
        if let Some(pose) = [pose, robot_then.0, pose_then].iter().find(|&pose| outside(pose)) {
            return Step::Blocked { command: braked, why: Blocked::OffTheMap(pose.point()) };
        }
        if let Some(why) = staleness {
            // The velocity is as old as the pose.
            let reference = self.world.motors.window().map(CommandWindow::reference);
            let command = limits.braked(reference.unwrap_or(self.issued), *cycle_s);
            return Step::Blocked { command, why };
        }
        let longest_s = Self::LONGEST_S.max(3.0 * cycle_s);
        let elapsed_s = since.map_or(*cycle_s, |last| now.since_s(last).min(longest_s));
        self.stepped = Some(now);
        let robot = Arc::clone(&self.parts.robot);
        self.world.look_ahead(robot.smoothing_lag_s());
        self.slow_down(pose.point(), velocity_then);
        let silence = self.world.silence(&self.parts);
        let is_at_rest = self.world.motors.is_at_rest(time, now, (&robot, velocity));
        let least = self.world.motors.least();
        let (robot, pose_now, velocity) = (&*robot, pose, velocity_then);
        let (pose, moves_on) = (pose_then, self.world.motors.moves_on(robot));
        let moment = Moment { robot, pose, velocity, robot_then, moves_on, elapsed_s, least };
        let step = match &mut self.errand {
            None if is_at_rest => Step::Idle,
            None => Step::Drive(braked),
            Some(Errand::Act(_)) => self.act(&moment, silence, braked),
            Some(Errand::Drive(_)) => self.drive(pose_now, &moment, silence, braked),
        };
        if matches!(self.errand, None | Some(Errand::Act(_))) {
            // No route uses them.
            self.world.forget_edits();
        }
        match step {
            Step::Arrived if !is_at_rest => Step::Drive(Velocity::ZERO),
            step => step,
        }
    }

    /// The step of a robot that drives to a goal.
    fn drive(
        &mut self,
        told: Pose,
        moment: &Moment<'_>,
        silence: Option<Blocked>,
        braked: Velocity,
    ) -> Step {
        let Some(mut deciding) = self.deciding(moment) else { return Step::Idle };
        deciding.leave(told);
        // A robot that is stationary at its goal needs no sensors.
        if let Some(why) = silence.filter(|_| !deciding.has_arrived()) {
            return Step::Blocked { command: braked, why };
        }
        let step = deciding.decided();
        let step = deciding.world.within_reach(moment.velocity, deciding.slowed(step));
        deciding.guarded(step)
    }

    /// The step of a robot that executes a single act.
    fn act(&mut self, moment: &Moment<'_>, silence: Option<Blocked>, braked: Velocity) -> Step {
        let Some(Errand::Act(act)) = &mut self.errand else { return Step::Idle };
        if let Some(why) = silence {
            act.wait(moment.elapsed_s);
            return Step::Blocked { command: braked, why };
        }
        let step = match act.step(moment, &self.world.obstacles) {
            Step::Drive(command) => Step::Drive(beside_movers(&self.world, moment, command)),
            step => step,
        };
        let step = slowing::slowed(self.slow.as_ref(), step);
        let step = self.world.within_reach(moment.velocity, step);
        self.record.guarded(&self.world, moment, step)
    }

    /// The reason to stop if the last pose is too old.
    fn staleness(&self, told: &Told, now: Time) -> Option<Blocked> {
        const LEAST_S: f64 = 0.5;
        let cycle_s = self.parts.robot.cycle_s;
        let repeated_s = f64::from(self.unobserved.saturating_sub(1)) * cycle_s;
        let age_s = now.since_s(told.time).max(repeated_s);
        let is_stale = age_s > LEAST_S.max(3.0 * cycle_s) * (1.0 + 1e-9);
        is_stale.then_some(Blocked::PoseStale { age_s })
    }

    /// A decision on the present task, if there is one.
    fn deciding<'a>(&'a mut self, moment: &Moment<'a>) -> Option<Deciding<'a>> {
        let FittedStack { robot, stack, local, guide, .. } = &self.parts;
        let Some(Errand::Drive(task)) = &mut self.errand else { return None };
        let slow = self.slow.as_ref();
        let local = slow.map_or(local, |slow| &slow.local);
        let (local, guide) = (&**local, &**guide);
        let (world, record) = (&mut self.world, &mut self.record);
        let &Moment { pose, velocity, robot_then, elapsed_s, .. } = moment;
        Some(Deciding {
            robot,
            stack,
            local,
            guide,
            slow,
            world,
            task,
            record,
            pose,
            velocity,
            robot_then,
            elapsed_s,
        })
    }

    /// Replans the route from the present pose.
    fn plan_again(&mut self) {
        self.forget_last();
        let Some(pose) = self.place.filter(|pose| pose.point().is_finite()) else { return };
        let robot = Arc::clone(&self.parts.robot);
        let (velocity, least) = (Velocity::ZERO, self.world.motors.least());
        let (robot_then, moves_on) = ((pose, velocity), self.world.motors.moves_on(&robot));
        let moment =
            Moment { robot: &robot, pose, velocity, robot_then, moves_on, elapsed_s: 0.0, least };
        if let Some(mut deciding) = self.deciding(&moment) {
            deciding.replan();
        }
    }

    /// The task of driving to a goal, if there is one.
    fn task(&self) -> Option<&Task> {
        match &self.errand {
            Some(Errand::Drive(task)) => Some(task),
            Some(Errand::Act(_)) | None => None,
        }
    }
}
