//! A robot with jerk limits, which lags behind its reference.

use crate::geometry::{Pose, Velocity};
use crate::robot::{CommandWindow, Robot};

/// State of a robot whose commands are averaged ([`CommandWindow`]). Planners decide for its
/// reference; contact is checked for the robot itself.
#[derive(Clone, Copy, Debug)]
pub struct JerkLimited<'a> {
    /// Velocities that are still averaged.
    pub window: &'a CommandWindow,
    /// Pose of the robot itself when its next command acts.
    pub pose: Pose,
    /// Velocity of the robot itself at that instant.
    pub velocity: Velocity,
}

impl JerkLimited<'_> {
    /// Velocities of the robot at the ends of the next cycles, until it is stationary, for those
    /// of its reference, which end at rest. The robot begins with `from`; there is at least one
    /// reference.
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

    /// Largest speed and turn rate of the robot and of the averaged velocities.
    pub(super) fn fastest(&self) -> Velocity {
        self.window.references().fold(self.velocity, |most, one| {
            Velocity::new(most.v.abs().max(one.v.abs()), most.omega.abs().max(one.omega.abs()))
        })
    }

    /// True if any of the averaged velocities satisfies a condition on its forward speed.
    pub(super) fn leads(&self, is_there: impl Fn(f64) -> bool) -> bool {
        self.window.references().any(|velocity| is_there(velocity.v))
    }
}
