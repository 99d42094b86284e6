//! What is recorded of a run.

use super::{KeyFrame, KeyFrames, Motion, Mover, Obstacle, World};
use keyway::geometry::{Pose, Velocity};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

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
        /// Whether the footprint covered no other ground at the contact, because the robot stood or, as a disc,
        /// turned on the spot: something that moves ran into it, or it began in contact.
        robot_stood: bool,
        /// Whether what the robot touched had jumped within the last cycle: the robot could not have known
        /// ([`Motion::last_jump_s`](super::Motion::last_jump_s)).
        jumped_onto: bool,
        /// How fast it moved then, where it was an obstacle that moves \[m/s\]: faster than
        /// [`Mover::DART_MPS`](super::Mover::DART_MPS) is a dart.
        mover_speed_mps: Option<f64>,
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

impl Run {
    /// The world in which the run was made, with the obstacles that give way where they were.
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

/// Where an obstacle that gives way ([`Motion::GivesWay`](super::Motion::GivesWay)) was during a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MoverWay {
    /// Its index in [`World::movers`](super::World::movers).
    pub index: usize,
    /// Its places at the beginning and at the end of every cycle. In between it went straight on.
    pub key_frames: Vec<KeyFrame>,
}

impl MoverWay {
    /// The obstacle, as one that goes this way whatever it meets.
    pub fn mover(&self, of: &Mover) -> Mover {
        of.moving(Motion::KeyFrames(KeyFrames::in_order(self.key_frames.clone())))
    }

    /// The part of it up to the end of a cycle.
    pub(super) fn until(&self, cycles: u64) -> Self {
        let Self { index, key_frames } = self;
        let count = key_frames.len().min(cycles as usize + 1);
        Self { index: *index, key_frames: key_frames[..count].to_vec() }
    }
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
    /// Where the obstacles that give way were; those of other motions are not listed.
    pub movers: Vec<MoverWay>,
    /// Cycles begun.
    pub cycles: u64,
}
