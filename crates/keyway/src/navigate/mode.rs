//! Modes of a robot that has a goal.

use super::recovery::{MotionUnderWay, RecoveryUnderWay};
use super::{NavigateError, RecoveryKind};
use crate::geometry::{Disc, Point, Shift};
use crate::plan::PlanError;
use crate::search::SearchStatistics;
use serde::{Deserialize, Serialize};

/// Mode of a robot with a goal. It is in one mode at a time.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) enum Mode {
    /// It follows its route.
    #[default]
    Following,
    /// It rotates towards its guide point before it enters a passage in which it cannot rotate.
    TurningFirst(MotionUnderWay),
    /// It brakes for a recovery, which starts where the robot comes to rest; its options there
    /// are not known before.
    StoppingFor(RecoveryKind),
    /// It made no progress and runs a recovery.
    Recovering(RecoveryUnderWay),
    /// No route exists, and the next attempt has to wait. The robot continues along the last
    /// route as far as is safe.
    Waiting {
        /// Reason why the last attempt failed. Not stored: the next attempt yields it again.
        #[serde(skip, default = "no_path")]
        why: NavigateError,
        /// Time until the next attempt \[s\].
        left_s: f64,
    },
    /// It drives to a position beside the path of a moving obstacle that must pass, and waits
    /// there until the obstacle has passed.
    MakingWay {
        /// End of its route.
        place: Point,
        /// The moving obstacle, at its position when the robot began to make way.
        other: Disc,
        /// Time that the robot has waited there \[s\].
        stood_s: f64,
    },
    /// It is at its goal: it brakes, then turns to the heading there.
    Arriving(Option<MotionUnderWay>),
}

/// The error of a restored navigator without a path.
pub(super) fn no_path() -> NavigateError {
    PlanError::NoPath { statistics: SearchStatistics::default() }.into()
}

impl Mode {
    /// Moves the activity along with a correction of the robot's pose. The goal heading is in the
    /// map frame, and so is the position for making way.
    pub(super) fn shift(&mut self, shift: &Shift) {
        match self {
            Self::TurningFirst(motion) => motion.shift(shift),
            Self::Recovering(recovery) => recovery.shift(shift),
            Self::Arriving(turn) => *turn = None,
            Self::Following
            | Self::StoppingFor(_)
            | Self::Waiting { .. }
            | Self::MakingWay { .. } => {}
        }
    }

    /// True if a recovery is under way, or the robot brakes for one.
    pub(super) const fn is_recovering(&self) -> bool {
        matches!(self, Self::StoppingFor(_) | Self::Recovering(_))
    }
}
