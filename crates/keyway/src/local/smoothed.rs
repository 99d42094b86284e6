//! A robot with limits of jerk, behind its reference.

use crate::geometry::{Pose, Velocity};
use crate::robot::{CommandWindow, Robot};

/// The state of a robot whose commands are averaged ([`CommandWindow`]). Whoever decides, decides
/// for its reference; what it touches is a matter of the robot itself.
#[derive(Clone, Copy, Debug)]
pub struct Smoothed<'a> {
    /// The velocities that are still averaged.
    pub window: &'a CommandWindow,
    /// Pose of the robot itself when its next command acts.
    pub pose: Pose,
    /// Its velocity then.
    pub velocity: Velocity,
}

impl Smoothed<'_> {
    /// The velocities of the robot at the ends of the next cycles, until it stands, for those of
    /// its reference, which end at rest. It begins with `from`, and has at least one.
    pub(super) fn velocities<I>(
        &self,
        from: Velocity,
        references: I,
        robot: &Robot,
    ) -> impl Iterator<Item = Velocity>
    where
        I: Iterator<Item = Velocity> + Clone,
    {
        let mut commands = self.window.commands(references).fuse();
        let mut velocity = from;
        std::iter::from_fn(move || {
            let command = commands.next();
            if command.is_none() && velocity == Velocity::ZERO {
                return None;
            }
            // The motors follow a command as far as they can within a cycle.
            let command = command.unwrap_or(Velocity::ZERO);
            velocity = robot.limits.reached(velocity, command, robot.cycle_s);
            Some(velocity)
        })
    }

    /// The largest speed and turn rate of the robot and of what is averaged.
    pub(super) fn fastest(&self) -> Velocity {
        self.window.references().fold(self.velocity, |most, one| {
            Velocity::new(most.v.abs().max(one.v.abs()), most.omega.abs().max(one.omega.abs()))
        })
    }

    /// True if any of what is averaged leads ahead, or back.
    pub(super) fn leads(&self, is_there: impl Fn(f64) -> bool) -> bool {
        self.window.references().any(|velocity| is_there(velocity.v))
    }
}
