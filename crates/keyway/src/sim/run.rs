//! What is recorded of a run.

use super::Obstacle;
use crate::geometry::{Pose, Velocity};
use serde::{Deserialize, Serialize};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Outcome {
    /// The centre came within the goal tolerance, and what else the rules ask for.
    Reached,
    /// The footprint touched something.
    Collided {
        /// Pose of the robot at the contact.
        pose: Pose,
        /// What it touched.
        with: Obstacle,
        /// Whether the robot neither drove nor turned at the contact: something that moves ran into it, or
        /// it began in contact.
        robot_stood: bool,
        /// Whether what the robot touched had jumped within the last cycle: the robot could not have known
        /// ([`Motion::last_jump_s`](super::Motion::last_jump_s)).
        jumped_onto: bool,
    },
    /// The time limit passed.
    Timeout,
    /// No progress for the stuck window.
    Stuck,
}

/// State of the robot at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Time since the start \[s\].
    pub t_s: f64,
    /// Pose in the world frame.
    pub pose: Pose,
    /// Velocity driven at this instant.
    pub velocity: Velocity,
}

/// What happened in a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// How it ended.
    pub outcome: Outcome,
    /// The start, the end of every cycle, and the contact if there was one.
    pub samples: Vec<Sample>,
    /// Arc length driven \[m\].
    pub length_m: f64,
    /// The footprint's smallest clearance from an obstacle or another robot over the whole motion, to
    /// 0.1 mm \[m\]; 0 after a contact with one, `None` alone in a world without obstacles.
    pub min_clearance_m: Option<f64>,
    /// The same from obstacles that stand; `None` without any.
    pub min_standing_clearance_m: Option<f64>,
    /// The same from obstacles that move ([`World::movers`](super::World::movers)); `None` without any.
    pub min_mover_clearance_m: Option<f64>,
    /// The same from other robots; `None` without any.
    pub min_robot_clearance_m: Option<f64>,
    /// Cycles begun.
    pub cycles: u64,
}
