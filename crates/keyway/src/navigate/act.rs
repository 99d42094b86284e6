//! Single acts: a rotation on the spot, a straight drive.

use super::recovery::{Moment, Motion, MotionStep, MotionUnderWay};
use super::{Blocked, Step};
use crate::geometry::Shift;
use crate::map::DistanceField;
use serde::{Deserialize, Serialize};

/// A motion requested on its own, with a time limit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Act {
    motion: MotionUnderWay,
    /// Remaining time \[s\].
    left_s: f64,
    is_done: bool,
}

impl Act {
    pub(super) const fn new(motion: Motion, allowance_s: f64) -> Self {
        Self { motion: MotionUnderWay::new(motion), left_s: allowance_s, is_done: false }
    }

    /// Continues the motion among stationary obstacles. If the rest of it would touch one, the
    /// robot brakes and tries again in the next cycle.
    pub(super) fn step(&mut self, moment: &Moment<'_>, obstacles: &DistanceField) -> Step {
        let &Moment { robot, velocity, elapsed_s, .. } = moment;
        let braked = robot.limits.braked(velocity, robot.cycle_s);
        if self.is_done {
            return if moment.stands() { Step::Arrived } else { Step::Drive(braked) };
        }
        self.left_s -= elapsed_s;
        if self.left_s < 0.0 {
            return Step::Blocked { command: braked, why: Blocked::OutOfTime };
        }
        match self.motion.step(moment, obstacles) {
            MotionStep::Moving(command) => Step::Drive(command),
            MotionStep::Refused => Step::Blocked { command: braked, why: Blocked::NoRoomForAct },
            MotionStep::Done => {
                self.is_done = true;
                Step::Arrived
            }
        }
    }

    /// Counts time in which it cannot continue.
    pub(super) fn wait(&mut self, elapsed_s: f64) {
        self.left_s -= elapsed_s;
    }

    /// Moves it along with a correction of the robot's pose.
    pub(super) fn shift(&mut self, shift: &Shift) {
        self.motion.shift(shift);
    }
}
