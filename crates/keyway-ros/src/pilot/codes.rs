//! Outcomes of actions, with Nav2's error codes.

use keyway::map::Hindrance;
use keyway::navigate::NavigateError;
use keyway::plan::{PathEnd, PlanError};

/// The outcome of an action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Ended {
    Succeeded,
    /// By its client, or by the next goal.
    Canceled,
    Failed {
        fault: Fault,
        why: String,
    },
}

impl Ended {
    /// Its error code in a family, 0 without an error, and its text.
    pub(crate) fn code(&self, family: Family) -> (u16, &str) {
        match self {
            Self::Succeeded | Self::Canceled => (0, ""),
            Self::Failed { fault, why } => (fault.number(family), why),
        }
    }

    pub(crate) fn failed(fault: Fault, why: impl Into<String>) -> Self {
        Self::Failed { fault, why: why.into() }
    }

    /// A goal that the robot cannot accept, or for which no path is found.
    pub(crate) fn refused(error: &NavigateError) -> Self {
        Self::failed(Fault::of(error), error.to_string())
    }
}

/// A kind of error, independent of the action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    Unknown,
    /// A missing transform or pose.
    Transform,
    StartOutsideMap,
    GoalOutsideMap,
    StartOccupied,
    GoalOccupied,
    NoPath,
    /// A list without goals.
    NoGoals,
    InvalidPath,
    InvalidInput,
    NoProgress,
    Timeout,
    /// An obstacle blocks a single motion.
    NoRoom,
}

/// Actions with the same error codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    Navigate,
    NavigateThrough,
    Plan,
    PlanThrough,
    Follow,
    Smooth,
    Waypoints,
    Spin,
    BackUp,
    DriveOnHeading,
    Wait,
}

impl Fault {
    /// Converts the error of a goal that cannot be accepted, or has no path.
    fn of(error: &NavigateError) -> Self {
        match error {
            NavigateError::NotFinite { end, .. }
            | NavigateError::NoRoom { end, why: Hindrance::Outside, .. } => Self::outside(*end),
            NavigateError::NoRoom { end, .. } => Self::occupied(*end),
            NavigateError::StartTouches { .. } => Self::StartOccupied,
            NavigateError::GoalHeading { .. } => Self::GoalOccupied,
            NavigateError::NoWay { .. } => Self::NoPath,
            NavigateError::PlaceUnknown => Self::Transform,
            NavigateError::NoPathToFollow
            | NavigateError::PathFarAway { .. }
            | NavigateError::Misfit(_) => Self::InvalidPath,
            NavigateError::WayPoint { why, .. } => Self::of(why),
            NavigateError::Plan(error) => match error {
                PlanError::OutsideMap { end, .. } => Self::outside(*end),
                PlanError::Blocked { end, .. } => Self::occupied(*end),
                PlanError::NoPath { .. } | PlanError::Missed { .. } => Self::NoPath,
                _ => Self::Unknown,
            },
            _ => Self::Unknown,
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

    /// Its code among those of a planner, which begin at `first`; `None` if it is not a planning
    /// error.
    const fn of_planner(self, first: u16) -> Option<u16> {
        let number = match self {
            Self::Transform => 2,
            Self::StartOutsideMap => 3,
            Self::GoalOutsideMap => 4,
            Self::StartOccupied => 5,
            Self::GoalOccupied => 6,
            Self::NoPath => 8,
            _ => return None,
        };
        Some(first + number)
    }

    /// Its code among those of a single motion: unnamed errors, timeout, transform, blocked, and
    /// invalid input.
    fn of_motion(self, [unknown, timeout, transform, no_room, invalid]: [u16; 5]) -> u16 {
        match self {
            Self::Timeout => timeout,
            Self::Transform => transform,
            Self::NoRoom => no_room,
            Self::InvalidInput => invalid,
            _ => unknown,
        }
    }

    /// Its code in the definitions of Nav2's actions.
    pub(crate) fn number(self, family: Family) -> u16 {
        let of_controller = match self {
            Self::InvalidPath => Some(103),
            Self::NoProgress => Some(105),
            _ => None,
        };
        match family {
            Family::Navigate => self.of_planner(200).or(of_controller).unwrap_or(9000),
            Family::NavigateThrough => {
                let no_goals = (self == Self::NoGoals).then_some(309);
                self.of_planner(300).or(of_controller).or(no_goals).unwrap_or(9100)
            }
            Family::Plan => self.of_planner(200).unwrap_or(200),
            Family::PlanThrough if self == Self::NoGoals => 309,
            Family::PlanThrough => self.of_planner(300).unwrap_or(300),
            Family::Follow if self == Self::Transform => 102,
            Family::Follow => of_controller.unwrap_or(100),
            Family::Smooth if self == Self::InvalidPath => 505,
            Family::Smooth if self == Self::NoRoom => 503,
            Family::Smooth => 500,
            Family::Waypoints if self == Self::NoGoals => 602,
            Family::Waypoints => 600,
            Family::Spin => self.of_motion([700, 701, 702, 703, 700]),
            Family::BackUp => self.of_motion([710, 711, 712, 714, 713]),
            Family::DriveOnHeading => self.of_motion([720, 721, 722, 723, 724]),
            Family::Wait => self.of_motion([740, 741, 740, 740, 740]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Codes as in the definitions of Kilted.
    #[test]
    fn numbers_are_those_of_nav2() {
        for (fault, family, expected) in [
            (Fault::Transform, Family::Plan, 202),
            (Fault::NoPath, Family::Navigate, 208),
            (Fault::GoalOccupied, Family::PlanThrough, 306),
            (Fault::NoProgress, Family::Navigate, 105),
            (Fault::NoProgress, Family::Plan, 200),
            (Fault::Timeout, Family::Navigate, 9000),
            (Fault::NoGoals, Family::NavigateThrough, 309),
            (Fault::NoGoals, Family::Waypoints, 602),
            (Fault::Transform, Family::Follow, 102),
            (Fault::InvalidPath, Family::Smooth, 505),
            (Fault::NoRoom, Family::BackUp, 714),
            (Fault::InvalidInput, Family::DriveOnHeading, 724),
            (Fault::Timeout, Family::Spin, 701),
            (Fault::Unknown, Family::Wait, 740),
        ] {
            assert_eq!(fault.number(family), expected, "{fault:?} {family:?}");
        }
    }
}
