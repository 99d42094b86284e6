//! Record of a run.

use super::{KeyFrame, KeyFrames, MovingObstacle, Obstacle, ObstacleMotion, World};
use keyway::geometry::{Pose, Velocity};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Outcome {
    /// The centre came within the goal tolerance, and the additional conditions of the rules
    /// hold.
    Reached,
    /// The footprint touched something.
    Collided {
        /// Pose of the robot at the contact.
        pose: Pose,
        /// Object that it touched.
        with: Obstacle,
        /// True if the covered area did not change at the contact, because the robot was
        /// stationary or, as a disc, turned on the spot: a moving object ran into it, or the run
        /// began in contact.
        robot_stood: bool,
        /// True if the touched obstacle had jumped within the last cycle, so that the robot could
        /// not have known ([`ObstacleMotion::last_jump_s`](super::ObstacleMotion::last_jump_s)).
        jumped_onto: bool,
        /// Speed of a touched moving obstacle at the contact \[m/s\]; a speed above
        /// [`MovingObstacle::DART_MPS`](super::MovingObstacle::DART_MPS) counts as darting.
        mover_speed_mps: Option<f64>,
    },
    /// The time limit passed.
    Timeout,
    /// No progress for the stuck window.
    Stuck,
}

/// State of the robot at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrajectoryPoint {
    /// Time since the start \[s\].
    pub t_s: f64,
    /// Pose in the world frame.
    pub pose: Pose,
    /// Velocity driven at this instant.
    pub velocity: Velocity,
}

/// Pose and velocity of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotState {
    /// Time at which they were measured \[s\].
    pub stamp_s: f64,
    /// Pose in the world frame.
    pub pose: Pose,
    /// Velocity.
    pub velocity: Velocity,
}

impl Run {
    /// Returns the world of the run, with the obstacles that give way on their recorded paths.
    pub fn world<'a>(&self, given: &'a World) -> Cow<'a, World> {
        let mut world = Cow::Borrowed(given);
        for way in &self.movers {
            if let Some(mover) = given.movers().get(way.index) {
                world.to_mut().movers_mut()[way.index] = way.mover(mover);
            }
        }
        world
    }
}

/// Recorded path of an obstacle that gives way during a run
/// ([`ObstacleMotion::GivesWay`](super::ObstacleMotion::GivesWay)).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MoverWay {
    /// Index in [`World::movers`](super::World::movers).
    pub index: usize,
    /// Positions at the beginning and at the end of every cycle. In between the obstacle moved in
    /// a straight line.
    pub key_frames: Vec<KeyFrame>,
}

impl MoverWay {
    /// Returns the obstacle on this path, without giving way.
    pub fn mover(&self, of: &MovingObstacle) -> MovingObstacle {
        of.moving(ObstacleMotion::KeyFrames(KeyFrames::in_order(self.key_frames.clone())))
    }

    /// Returns the part of the path up to the end of a cycle.
    pub(super) fn until(&self, cycles: u64) -> Self {
        let Self { index, key_frames } = self;
        let count = key_frames.len().min(cycles as usize + 1);
        Self { index: *index, key_frames: key_frames[..count].to_vec() }
    }
}

/// Result of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Outcome of the run.
    pub outcome: Outcome,
    /// The start, the end of every cycle, and the contact if there was one.
    pub samples: Vec<TrajectoryPoint>,
    /// Arc length driven \[m\].
    pub length_m: f64,
    /// Smallest clearance of the footprint from an obstacle or another robot over the whole
    /// motion, to 0.1 mm \[m\]; 0 after a contact, `None` for a single robot in a world without
    /// obstacles.
    pub min_clearance_m: Option<f64>,
    /// Smallest clearance from static obstacles \[m\]; `None` without any.
    pub min_standing_clearance_m: Option<f64>,
    /// Smallest clearance from moving obstacles ([`World::movers`](super::World::movers)) \[m\];
    /// `None` without any.
    pub min_mover_clearance_m: Option<f64>,
    /// Smallest clearance from other robots \[m\]; `None` without any.
    pub min_robot_clearance_m: Option<f64>,
    /// Recorded paths of the obstacles that give way; obstacles with other motions are not
    /// listed.
    pub movers: Vec<MoverWay>,
    /// Number of cycles begun.
    pub cycles: u64,
}
