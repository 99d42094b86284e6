//! The world model as the input of a local planner.

use super::World;
use crate::geometry::{Pose, Velocity};
use crate::guide::Guidance;
use crate::local::{JerkLimited, Scene};
use crate::navigate::task::Task;

impl World {
    /// The input of a local planner for a robot with a task.
    pub(in crate::navigate) fn scene<'a>(
        &'a self,
        task: &'a Task,
        (pose, velocity): (Pose, Velocity),
        jerk_limited: Option<JerkLimited<'a>>,
    ) -> Scene<'a> {
        let (obstacles, sensed, movers) =
            (&self.obstacles, self.sensed.sensed(), &self.movers_then[..]);
        let Guidance { point: guide, remaining_m } = task.guidance;
        let (path, seen) = (&task.route.smoothed, self.seen_cells());
        let walked = self.walked.avoided();
        let goal_heading_rad =
            task.goal.heading_rad.filter(|_| task.is_last_leg() && task.is_on_its_way());
        Scene {
            obstacles,
            sensed,
            seen,
            movers,
            walked,
            pose,
            velocity,
            guide,
            path,
            goal_heading_rad,
            remaining_m,
            jerk_limited,
        }
    }

    /// State of the robot itself when its next command takes effect, if its commands are
    /// averaged.
    pub(in crate::navigate) fn jerk_limited(
        &self,
        robot_then: (Pose, Velocity),
    ) -> Option<JerkLimited<'_>> {
        let (window, (pose, velocity)) = (self.motors.window()?, robot_then);
        Some(JerkLimited { window, pose, velocity })
    }
}
