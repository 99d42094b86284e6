//! Results of a controller step, and the reasons why a robot makes no progress.

use super::{NavigateError, RecoveryKind};
use crate::geometry::{Point, Velocity};
use crate::given::Computed;
use crate::local::{Evaluation, NoCommand, Refusal};
use crate::plan::PlanError;
use thiserror::Error;

/// Result of a step, valid until the next cycle.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Drive with this velocity.
    Drive(Velocity),
    /// The goal is reached: stop.
    Arrived,
    /// There is no goal, and the robot is stationary.
    Idle,
    /// The robot cannot proceed at the moment: drive with `command`, which is safe, and step
    /// again.
    Blocked {
        /// Continues as far as is safe, brakes along the present arc, or rotates on the spot.
        command: Velocity,
        /// Reason for the block.
        why: Blocked,
    },
}

impl Step {
    /// The velocity command until the next cycle.
    pub const fn command(&self) -> Velocity {
        match *self {
            Self::Drive(command) | Self::Blocked { command, .. } => command,
            Self::Arrived | Self::Idle => Velocity::ZERO,
        }
    }

    /// The name: `drive`, `arrived`, `idle` or `blocked`.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Drive(_) => "drive",
            Self::Arrived => "arrived",
            Self::Idle => "idle",
            Self::Blocked { .. } => "blocked",
        }
    }

    /// The reason of a blocked robot; otherwise `None`.
    pub const fn why(&self) -> Option<&Blocked> {
        match self {
            Self::Blocked { why, .. } => Some(why),
            Self::Drive(_) | Self::Arrived | Self::Idle => None,
        }
    }

    /// The same step with another command; a robot that has arrived or has no goal gets none.
    pub(super) fn commanding(self, command: Velocity) -> Self {
        match self {
            Self::Drive(_) => Self::Drive(command),
            Self::Blocked { why, .. } => Self::Blocked { command, why },
            Self::Arrived | Self::Idle => self,
        }
    }
}

/// Reason why a robot makes no progress.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Blocked {
    /// The local planner found no admissible velocity.
    #[error(transparent)]
    NothingAdmissible(NoCommand),
    /// The local planner found nothing better than to stay: no velocity that moves the robot is
    /// admissible.
    #[error("none of the {} candidate velocities moves the robot ({})", .0.candidates, .0.rejected)]
    NothingDrives(Evaluation),
    /// With the sensed obstacles, no route exists any more. The robot continues along the last
    /// one as far as is safe (it may see a gap from nearby), and replans from time to time.
    #[error("{}", no_route_text(.0))]
    NoRoute(NavigateError),
    /// The robot made no progress, or would make none, and runs this recovery. Its motions are as
    /// safe as any others.
    #[error("instead of driving on, the robot {0}")]
    Recovering(RecoveryKind),
    /// A moving obstacle needs to pass where there is no space for two: the robot waits beside
    /// its path until it has passed.
    #[error("the robot makes way for an oncoming moving obstacle")]
    MakingWay,
    /// The robot is stationary at its goal and has no space to turn to the goal heading, in
    /// either direction.
    #[error("there is no space at the goal to turn to its heading")]
    NoRoomToTurn,
    /// The robot is outside the map, and nothing can be planned from there: its localisation is
    /// wrong, or the map is too small. The command brakes.
    #[error(
        "the pose ({}, {}) is outside the map: correct the localisation, or use a map that \
         contains this position",
        Computed(.0.x), Computed(.0.y)
    )]
    OffTheMap(Point),
    /// No beam of any sensor has been valid for longer than the sensor's time-out
    /// ([`RangeSensor::timeout_s`](crate::robot::RangeSensor::timeout_s)), or ever: the robot is
    /// blind. The command brakes, and the robot drives on when it senses again.
    #[error("{}", silence_text(*.silent_s))]
    SensorSilent {
        /// Index of the sensor with the latest valid beam; 0 if there was none.
        sensor: usize,
        /// Time since the last valid beam \[s\]; infinite if there was none.
        silent_s: f64,
    },
    /// The rest of a single act would touch something. The command brakes, and the robot
    /// continues once there is space.
    #[error("there is no space for the rest of the act")]
    NoRoomForAct,
    /// A single act has exceeded its time limit. The command brakes, and the robot stays
    /// stationary.
    #[error("the act has exceeded its time limit: the robot is stationary; give it another task")]
    OutOfTime,
    /// The stop rule rejects the command, because the robot could no longer stop in time with it;
    /// the robot drives slower or brakes.
    #[error(transparent)]
    Unsafe(Refusal),
    /// An implausible stamp, pose or velocity: the state of the robot is unknown. The command is
    /// to stop.
    #[error("{0} is implausible: not finite, or far beyond the robot's limits")]
    BadInput(&'static str),
    /// The last observation is older than the one before and was discarded. The command is to
    /// stop.
    #[error(
        "the observation of {} s is older than the last one, of {} s: one of the two stamps is \
         wrong, or they come out of order; after a change of the clock, call `restart_clock`",
        Computed(*.stamp_s), Computed(*.last_s)
    )]
    TimeRunsBack {
        /// Stamp of the observation \[s\].
        stamp_s: f64,
        /// The last stamp before it \[s\].
        last_s: f64,
    },
    /// Nothing has been observed yet: the pose is unknown. The command is to stop.
    #[error("nothing has been observed yet: give an observation before the first step")]
    NothingObserved,
    /// The last pose is old: the pose is unknown. The command brakes.
    #[error(
        "the last pose is {} s old: the localisation or the odometry is silent, and the robot \
         stays stationary until a new pose arrives",
        Computed(*.age_s)
    )]
    PoseStale {
        /// Its age \[s\].
        age_s: f64,
    },
}

impl Blocked {
    /// A number that identifies the kind, for programs that do not parse messages. It never
    /// changes, and no other stop or error has it ([`NavigateError::kind`]).
    pub const fn kind(&self) -> u16 {
        match self {
            Self::NothingAdmissible(_) => 101,
            Self::NothingDrives(_) => 102,
            Self::NoRoute(_) => 103,
            Self::Recovering(_) => 104,
            Self::NoRoomToTurn => 105,
            Self::OffTheMap(_) => 106,
            Self::SensorSilent { .. } => 107,
            Self::Unsafe(_) => 108,
            Self::BadInput(_) => 109,
            Self::TimeRunsBack { .. } => 110,
            Self::NothingObserved => 111,
            Self::PoseStale { .. } => 112,
            Self::NoRoomForAct => 113,
            Self::OutOfTime => 114,
            Self::MakingWay => 115,
        }
    }
}

fn silence_text(silent_s: f64) -> String {
    let since = if silent_s.is_finite() {
        format!("for {} s", Computed(silent_s))
    } else {
        "yet".to_owned()
    };
    format!(
        "no sensor has had a valid beam {since}: the robot is blind and stays stationary until one has"
    )
}

/// Message for a missing route, without a start: the route would start at the robot.
fn no_route_text(why: &NavigateError) -> String {
    match why {
        NavigateError::Plan(PlanError::NoPath { .. }) => {
            "with the sensed obstacles, no path to the goal exists".to_owned()
        }
        why => format!("with the sensed obstacles, no route to the goal exists ({why})"),
    }
}
