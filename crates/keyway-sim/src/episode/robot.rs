//! A robot of an episode.

use super::Start;
use crate::sim::Disturbances;
use keyway::geometry::Point;
use keyway::navigate::{Goal, Stack};
use keyway::robot::Robot;

/// A robot of an [`Episode`](super::Episode): its description, its stack, its start and its goal.
#[derive(Clone, Debug, PartialEq)]
pub struct EpisodeRobot {
    /// The robot.
    pub robot: Robot,
    /// Errors of its sensor, its motors and its localisation. Robots with the same seed draw
    /// different numbers.
    pub disturbances: Disturbances,
    /// Stack that plans and drives.
    pub stack: Stack,
    /// Name of the stack in the report.
    pub stack_name: String,
    /// Start of the robot.
    pub start: Start,
    /// Way-points, in order \[m\].
    pub via: Vec<Point>,
    /// Goal of the robot.
    pub goal: Goal,
}

impl EpisodeRobot {
    /// Creates an ideal robot with its default stack. It starts facing along its path.
    pub fn new(robot: Robot, start: Point, goal: impl Into<Goal>) -> Self {
        Self {
            stack: Stack::keyway(&robot),
            stack_name: Stack::DEFAULT.to_owned(),
            robot,
            disturbances: Disturbances::default(),
            start: Start { position: start, heading_rad: None },
            via: Vec::new(),
            goal: goal.into(),
        }
    }
}
