//! Doings of a robot that has a goal.

use super::recovery::{MotionUnderWay, RecoveryUnderWay};
use super::{NavigateError, RecoveryKind};
use crate::geometry::{Disc, Point, Shift};
use crate::plan::PlanError;
use crate::search::SearchStatistics;
use serde::{Deserialize, Serialize};

/// Activity of a robot with a goal. It is in one mode at a time.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) enum Mode {
    /// It follows its route.
    #[default]
    Following,
    /// It turns towards its guide point, before it enters ground on which it cannot turn.
    TurningFirst(MotionUnderWay),
    /// It brakes, to begin a recovery where it then stands: what that can do there is not known
    /// before.
    StoppingFor(RecoveryKind),
    /// It got no farther, and tries something.
    Recovering(RecoveryUnderWay),
    /// There is no route, and the next attempt has to wait. It goes on along the last route as far
    /// as is safe.
    Waiting {
        /// The reason why the last attempt failed. Not stored: another attempt says it again.
        #[serde(skip, default = "no_path")]
        why: NavigateError,
        /// Until the next one \[s\].
        left_s: f64,
    },
    /// It drives to a place beside the way of somebody who wants past, and stands there until they
    /// have passed.
    MakingWay {
        /// The end of its route.
        place: Point,
        /// The other one, at the place where it was when the robot began to make way.
        other: Disc,
        /// Since it stands there \[s\].
        stood_s: f64,
    },
    /// It is at its goal: it brakes, then turns to the heading there.
    Arriving(Option<MotionUnderWay>),
}

/// There is no path, as far as anybody remembers.
pub(super) fn no_path() -> NavigateError {
    PlanError::NoPath { statistics: SearchStatistics::default() }.into()
}

impl Mode {
    /// Moves what is under way with the robot. The heading at the goal is that of the map, and so is
    /// a place beside somebody's way.
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
