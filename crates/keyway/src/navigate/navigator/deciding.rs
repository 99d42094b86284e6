//! One decision, from the world and the task.

use super::Record;
use super::slowing::{Slow, slowed};
use crate::geometry::{Pose, Velocity};
use crate::guide::Guide;
use crate::local::{Evaluation, LocalPlanner};
use crate::navigate::mode::Mode;
use crate::navigate::recovery::Moment;
use crate::navigate::start::touches;
use crate::navigate::task::Task;
use crate::navigate::world::World;
use crate::navigate::{Blocked, RecoveryKind, Stack, Step};
use crate::robot::Robot;

/// Inputs and state of a decision.
pub(super) struct Deciding<'a> {
    pub(super) robot: &'a Robot,
    pub(super) stack: &'a Stack,
    pub(super) local: &'a dyn LocalPlanner,
    pub(super) guide: &'a dyn Guide,
    /// The parts for a speed limit, if there is one.
    pub(super) slow: Option<&'a Slow>,
    pub(super) world: &'a mut World,
    pub(super) task: &'a mut Task,
    pub(super) record: &'a mut Record,
    /// Pose of the robot when the command takes effect.
    pub(super) pose: Pose,
    /// Velocity of the robot at that time.
    pub(super) velocity: Velocity,
    /// State of the robot itself; the same, unless its commands are averaged.
    pub(super) robot_then: (Pose, Velocity),
    /// Time since the last decision \[s\].
    pub(super) elapsed_s: f64,
}

impl<'a> Deciding<'a> {
    pub(super) fn moment(&self) -> Moment<'a> {
        let Self { robot, pose, velocity, robot_then, elapsed_s, .. } = *self;
        let least = self.world.motors.least();
        let moves_on = self.world.motors.moves_on(robot);
        Moment { robot, pose, velocity, robot_then, moves_on, elapsed_s, least }
    }

    /// True if the robot is stationary, and no averaged command moves it on.
    pub(super) fn stands(&self) -> bool {
        self.moment().stands()
    }

    /// Records that the robot has left the obstacle that its start was too close to, once an
    /// observed pose shows it.
    pub(super) fn leave(&mut self, pose: Pose) {
        let known = self.world.router.layers.obstacles().clearance();
        self.task.too_near.take_if(|_| !touches(&self.robot.footprint, pose, &known));
    }

    /// A command within the speed limit, on the same arc.
    pub(super) fn slowed(&self, step: Step) -> Step {
        slowed(self.slow, step)
    }

    /// The step before the stop rule is applied.
    pub(super) fn decided(&mut self) -> Step {
        self.pass_way_point();
        let step = self.arrive().unwrap_or_else(|| self.go_on());
        self.world.forget_edits();
        step
    }

    /// The step of a robot that has not arrived.
    fn go_on(&mut self) -> Step {
        self.look_after_route();
        if let Some(step) = self.stand_aside() {
            return step;
        }
        if let Some((kind, command)) = self.go_on_recovering() {
            return Step::Blocked { command, why: Blocked::Recovering(kind) };
        }
        if let Some(command) = self.turn_first() {
            return Step::Drive(command);
        }
        let driven = self.drive();
        if let Ok(command) = driven {
            self.turn_before(command);
            if let Some(command) = self.turn_first() {
                return Step::Drive(command);
            }
        }
        if let Some(command) = driven.as_ref().ok().and_then(|&command| self.led_in(command)) {
            let why = Blocked::Recovering(RecoveryKind::Manoeuvre);
            return Step::Blocked { command, why };
        }
        let braked = self.robot.limits.braked(self.velocity, self.robot.cycle_s);
        if let Mode::Waiting { why, left_s } = &mut self.task.mode {
            // Continue on the old route as far as is safe: the robot senses more from nearby.
            *left_s -= self.elapsed_s;
            let why = Blocked::NoRoute(why.clone());
            let command =
                if self.task.is_lost { braked } else { driven.unwrap_or_else(|why| why.fallback) };
            return Step::Blocked { command, why };
        }
        match driven {
            Ok(command) if self.robot.stands(command) && self.is_at_goal() => {
                Step::Blocked { command, why: Blocked::NoRoomToTurn }
            }
            Ok(command) if self.can_only_stand(command) => {
                let why = Blocked::NothingDrives(self.record.evaluation.clone());
                Step::Blocked { command, why }
            }
            Ok(command) => Step::Drive(command),
            Err(why) => {
                Step::Blocked { command: why.fallback, why: Blocked::NothingAdmissible(why) }
            }
        }
    }

    /// True if the robot is to stay because no other velocity was admissible.
    fn can_only_stand(&self, command: Velocity) -> bool {
        let Evaluation { candidates, driving, .. } = self.record.evaluation;
        self.robot.stands(command) && candidates > 0 && driving == 0
    }
}
