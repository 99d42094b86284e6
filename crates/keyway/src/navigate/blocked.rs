//! What a controller answers, and why a robot makes no progress.

use super::{NavigateError, RecoveryKind};
use crate::geometry::{Point, Velocity};
use crate::given::Computed;
use crate::local::{Evaluation, NoCommand, Refusal};
use crate::plan::PlanError;
use thiserror::Error;

/// What to do until the next cycle.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Drive with this velocity.
    Drive(Velocity),
    /// The goal is reached: stop.
    Arrived,
    /// There is no goal, and the robot stands.
    Idle,
    /// There is no good way on at the moment: drive with `command`, which is safe, and ask again.
    Blocked {
        /// Drives on as far as is safe, brakes along the present arc, or turns on the spot.
        command: Velocity,
        /// What is in the way.
        why: Blocked,
    },
}

impl Step {
    /// What to drive with until the next cycle.
    pub const fn command(&self) -> Velocity {
        match *self {
            Self::Drive(command) | Self::Blocked { command, .. } => command,
            Self::Arrived | Self::Idle => Velocity::ZERO,
        }
    }

    /// Its name: `drive`, `arrived`, `idle` or `blocked`.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Drive(_) => "drive",
            Self::Arrived => "arrived",
            Self::Idle => "idle",
            Self::Blocked { .. } => "blocked",
        }
    }

    /// The reason of a robot that is blocked; otherwise `None`.
    pub const fn why(&self) -> Option<&Blocked> {
        match self {
            Self::Blocked { why, .. } => Some(why),
            Self::Drive(_) | Self::Arrived | Self::Idle => None,
        }
    }

    /// The same with another command; a robot that has arrived, or has no goal, is not given any.
    pub(super) fn commanding(self, command: Velocity) -> Self {
        match self {
            Self::Drive(_) => Self::Drive(command),
            Self::Blocked { why, .. } => Self::Blocked { command, why },
            Self::Arrived | Self::Idle => self,
        }
    }
}

/// Why a robot makes no progress.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Blocked {
    /// The local planner found no admissible velocity.
    #[error(transparent)]
    NothingAdmissible(NoCommand),
    /// The local planner found nothing better than to stand: no velocity that drives is admissible.
    #[error("of {} velocities none lets the robot drive ({})", .0.candidates, .0.rejected)]
    NothingDrives(Evaluation),
    /// With what was sensed, there is no longer a route. The robot goes on along the last one as
    /// far as is safe (it may see a gap when it is nearer), and plans again from time to time.
    #[error("{}", no_route_text(.0))]
    NoRoute(NavigateError),
    /// The robot got no farther, or would not, and tries what this says. Its motions are as safe as
    /// any others.
    #[error("instead of driving on, the robot {0}")]
    Recovering(RecoveryKind),
    /// Somebody wants past where two cannot pass: the robot stands beside their way until they have
    /// gone by.
    #[error("the robot makes way for somebody who comes towards it")]
    MakingWay,
    /// The robot stands at its goal and has no room to turn to the heading there, to either side.
    #[error("there is no room at the goal to turn to its heading")]
    NoRoomToTurn,
    /// The robot is where the map says nothing, which is no place to plan from: its localisation is
    /// wrong, or the map is too small. The command brakes.
    #[error(
        "the pose ({}, {}) is outside the map: correct the localisation, or use a map that holds the place",
        Computed(.0.x), Computed(.0.y)
    )]
    OffTheMap(Point),
    /// No beam of any sensor has said anything for longer than the sensor's time-out
    /// ([`RangeSensor::timeout_s`](crate::robot::RangeSensor::timeout_s)), or ever: the robot sees
    /// nothing. The command brakes, and the robot drives on when it sees again.
    #[error("{}", silence_text(*.silent_s))]
    SensorSilent {
        /// Index of the sensor that said something the last; 0 where none ever has.
        sensor: usize,
        /// Since a beam said something \[s\]; infinite when none ever has.
        silent_s: f64,
    },
    /// The rest of a single act would touch something. The command brakes, and the robot goes on
    /// once there is room.
    #[error("there is no room for what is left of the act")]
    NoRoomForAct,
    /// A single act has taken longer than it may. The command brakes, and the robot stands.
    #[error("the act has taken longer than it may: the robot stands; give it another task")]
    OutOfTime,
    /// The stop rule refuses what was decided, and drives slower or brakes: with what was decided
    /// the robot could no longer stop in time.
    #[error(transparent)]
    Unsafe(Refusal),
    /// A stamp, pose or velocity that cannot be true: where the robot is or how it moves is
    /// unknown. The command is to stop.
    #[error("{0} cannot be true: it is not finite, or far beyond the robot's limits")]
    BadInput(&'static str),
    /// The last observation is older than the one before: nothing of it was taken in. The command
    /// is to stop.
    #[error(
        "the observation of {} s is older than the last one, of {} s: give observations in the order of their stamps; \
         after a change of the clock, say that it begins anew (`restart_clock`)",
        Computed(*.stamp_s), Computed(*.last_s)
    )]
    TimeRunsBack {
        /// Stamp of the observation \[s\].
        stamp_s: f64,
        /// The last stamp before it \[s\].
        last_s: f64,
    },
    /// Nothing has been observed yet: where the robot is is unknown. The command is to stop.
    #[error("nothing has been observed yet: give an observation before the first step")]
    NothingObserved,
    /// The last pose is old: where the robot is is unknown. The command brakes.
    #[error(
        "the last pose is {} s old: the localisation or the odometry is silent, and the robot stands until it is not",
        Computed(*.age_s)
    )]
    PoseStale {
        /// Its age \[s\].
        age_s: f64,
    },
}

impl Blocked {
    /// Its kind as a number, which never changes and which no other stop or error has
    /// ([`NavigateError::kind`]): for programs that do not read texts.
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
        "no beam of a sensor has said anything {since}: the robot sees nothing, and stands until it does"
    )
}

/// The route would begin at the robot, not at the start.
fn no_route_text(why: &NavigateError) -> String {
    match why {
        NavigateError::Plan(PlanError::NoPath { .. }) => {
            "what the robot has seen leaves no path to the goal".to_owned()
        }
        why => format!("what the robot has seen leaves no route to the goal ({why})"),
    }
}
