//! Outcomes of actions, with the numbers that Nav2 gives to errors.

use keyway::map::Hindrance;
use keyway::navigate::NavigateError;
use keyway::plan::{PathEnd, PlanError};

/// The end of an action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Ended {
    Succeeded,
    /// By whoever asked for it, or by the next one.
    Canceled,
    Failed {
        code: Code,
        why: String,
    },
}

impl Ended {
    /// Its number, 0 without an error, and its text.
    pub(crate) fn code(&self) -> (u16, &str) {
        match self {
            Self::Succeeded | Self::Canceled => (0, ""),
            Self::Failed { code, why } => (*code as u16, why),
        }
    }

    pub(crate) fn failed(code: Code, why: impl Into<String>) -> Self {
        Self::Failed { code, why: why.into() }
    }
}

/// Numbers of errors, as the definitions of Nav2's actions have them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub(crate) enum Code {
    InvalidPath = 103,
    FailedToMakeProgress = 105,
    PlannerUnknown = 200,
    PlannerTransform = 202,
    StartOutsideMap = 203,
    GoalOutsideMap = 204,
    StartOccupied = 205,
    GoalOccupied = 206,
    NoValidPath = 208,
}

impl Code {
    /// For the reason why a robot cannot be sent to a goal, or no way is found.
    pub(crate) fn of(error: &NavigateError) -> Self {
        match error {
            NavigateError::NotFinite { end, .. }
            | NavigateError::NoRoom { end, why: Hindrance::Outside, .. } => Self::outside(*end),
            NavigateError::NoRoom { end, .. } => Self::occupied(*end),
            NavigateError::StartTouches { .. } => Self::StartOccupied,
            NavigateError::GoalHeading { .. } => Self::GoalOccupied,
            NavigateError::NoWay { .. } => Self::NoValidPath,
            NavigateError::PlaceUnknown => Self::PlannerTransform,
            NavigateError::NoPathToFollow
            | NavigateError::PathFarAway { .. }
            | NavigateError::Misfit(_) => Self::InvalidPath,
            NavigateError::WayPoint { why, .. } => Self::of(why),
            NavigateError::Plan(error) => match error {
                PlanError::OutsideMap { end, .. } => Self::outside(*end),
                PlanError::Blocked { end, .. } => Self::occupied(*end),
                PlanError::NoPath { .. } | PlanError::Missed { .. } => Self::NoValidPath,
                _ => Self::PlannerUnknown,
            },
            _ => Self::PlannerUnknown,
        }
    }

    const fn occupied(end: PathEnd) -> Self {
        match end {
            PathEnd::Start => Self::StartOccupied,
            PathEnd::Goal => Self::GoalOccupied,
        }
    }

    const fn outside(end: PathEnd) -> Self {
        match end {
            PathEnd::Start => Self::StartOutsideMap,
            PathEnd::Goal => Self::GoalOutsideMap,
        }
    }
}
