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
            Self::Arrived => Velocity::ZERO,
        }
    }

    /// The same with another command; who has arrived is not given any.
    pub(super) fn commanding(self, command: Velocity) -> Self {
        match self {
            Self::Drive(_) => Self::Drive(command),
            Self::Blocked { why, .. } => Self::Blocked { command, why },
            Self::Arrived => Self::Arrived,
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
    /// The robot got no farther and tries what this says. Its motions are as safe as any others.
    #[error("the robot gets no farther and {0}")]
    Recovering(RecoveryKind),
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
    /// No beam has said anything for longer than the sensor's time-out
    /// ([`RangeSensor::timeout_s`](crate::robot::RangeSensor::timeout_s)), or ever: the robot sees
    /// nothing. The command brakes, and the robot drives on when it sees again.
    #[error("{}", silence_text(*.silent_s))]
    SensorSilent {
        /// Since a beam said something \[s\]; infinite when none ever has.
        silent_s: f64,
    },
    /// The stop rule refuses what was decided, and drives slower or brakes: with what was decided
    /// the robot could no longer stop in time.
    #[error(transparent)]
    Unsafe(Refusal),
    /// A pose or velocity that cannot be true: where the robot is or how it moves is unknown. The
    /// command is to stop.
    #[error("{0} cannot be true: it is not finite, or far beyond the robot's limits")]
    BadInput(&'static str),
}

fn silence_text(silent_s: f64) -> String {
    let since = if silent_s.is_finite() {
        format!("for {} s", Computed(silent_s))
    } else {
        "yet".to_owned()
    };
    format!(
        "no beam of the sensor has said anything {since}: the robot sees nothing, and stands until it does"
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
