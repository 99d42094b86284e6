//! Errors of goals, paths and maps.

use super::{HeadingRange, Misfit};
use crate::ConfigError;
use crate::geometry::{Point, degrees};
use crate::given::{Computed, Given};
use crate::map::{Hindrance, Separation};
use crate::plan::{PathEnd, PlanError};
use crate::robot::Footprint;
use thiserror::Error;

/// Reason why a robot cannot be sent to a goal.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NavigateError {
    /// A value of the robot or the stack cannot be used; for a value of the robot, the path
    /// starts with `robot`.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The footprint does not fit at the start or goal.
    #[error(
        "{end} ({}, {}) has too little clearance for a radius of {} m: {why}{}",
        Computed(.position.x), Computed(.position.y), Computed(*.radius_m),
        nearest_text(.nearest.as_ref())
    )]
    NoRoom {
        /// Start or goal.
        end: PathEnd,
        /// Requested position \[m\].
        position: Point,
        /// The robot's radius \[m\].
        radius_m: f64,
        /// The nearest hindrance.
        why: Hindrance,
        /// Nearest position with enough clearance \[m\], if there is one.
        nearest: Option<Point>,
    },
    /// The robot would start in contact with an obstacle.
    #[error(
        "at the start ({}, {}){} the robot ({footprint}) touches something{} ({why}); move the start away from it{}",
        Computed(.position.x), Computed(.position.y),
        .heading_rad.map_or_else(String::new, |yaw_rad| format!(" with a yaw of {} deg", Computed(degrees(yaw_rad)))),
        every_heading_text(.footprint, .heading_rad.as_ref()),
        if .heading_rad.is_some() && matches!(.footprint, Footprint::Polygon(_)) { ", or choose another yaw" } else { "" }
    )]
    StartTouches {
        /// The start \[m\].
        position: Point,
        /// Heading at the start \[rad\]; `None`: it touches something at every heading.
        heading_rad: Option<f64>,
        /// The robot.
        footprint: Footprint,
        /// The hindrance nearest to the start.
        why: Hindrance,
    },
    /// The footprint does not fit at the goal with the goal heading.
    #[error(
        "at the goal ({}, {}) the robot ({footprint}) does not fit with a yaw of {} deg; {}",
        Computed(.position.x), Computed(.position.y), Computed(degrees(*.heading_rad)), headings_text(.fits)
    )]
    GoalHeading {
        /// The goal \[m\].
        position: Point,
        /// Goal heading \[rad\].
        heading_rad: f64,
        /// The robot.
        footprint: Footprint,
        /// The headings at which it fits there.
        fits: Vec<HeadingRange>,
    },
    /// A start or goal whose coordinates are not finite.
    #[error(
        "{end} ({}, {}) is not a valid position: both coordinates must be finite numbers; check \
         the localisation, or the file that contains the {end}",
        Given(.position.x), Given(.position.y)
    )]
    NotFinite {
        /// Start or goal.
        end: PathEnd,
        /// Requested position.
        position: Point,
    },
    /// No path exists on the known map.
    #[error("{}{why}", margin_text(.why))]
    NoWay {
        /// The clearance at which a path would exist, or the separation of start and goal.
        why: Separation,
    },
    /// A path to be followed has fewer than two points, or points that are not finite.
    #[error("a path to be followed needs two points or more, all of them finite")]
    NoPathToFollow,
    /// A path to be followed starts too far from the robot.
    #[error(
        "the path begins {} m from the robot, and at most {} m are allowed: drive to its beginning first",
        Computed(*.away_m), Computed(*.most_m)
    )]
    PathFarAway {
        /// Distance of its start from the robot \[m\].
        away_m: f64,
        /// Largest such distance that is accepted \[m\].
        most_m: f64,
    },
    /// The robot does not fit along a path that it is to follow.
    #[error("the robot does not fit along the path: {0}")]
    Misfit(Misfit),
    /// The pose of the robot has not been given.
    #[error(
        "the pose of the robot is unknown: give an observation or call `relocate` before setting a goal"
    )]
    PlaceUnknown,
    /// No route exists.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// No route exists to a way-point, or on from the one before it.
    #[error("way-point {number}: {why}")]
    WayPoint {
        /// Number of the way-point, from 1.
        number: usize,
        /// The reason.
        why: Box<NavigateError>,
    },
}

impl NavigateError {
    /// True if the goal cannot be reached for a reason other than the start.
    pub(super) const fn is_of_goal(&self) -> bool {
        matches!(
            self,
            Self::NoRoom { end: PathEnd::Goal, .. }
                | Self::NoWay { .. }
                | Self::Plan(
                    PlanError::NoPath { .. }
                        | PlanError::Missed { .. }
                        | PlanError::Blocked { end: PathEnd::Goal, .. }
                        | PlanError::OutsideMap { end: PathEnd::Goal, .. }
                )
        )
    }

    /// A number that identifies the kind, for programs that do not parse messages. It never
    /// changes, and no other error or stop has it ([`Blocked::kind`](super::Blocked::kind)).
    pub const fn kind(&self) -> u16 {
        match self {
            Self::Config(_) => 201,
            Self::NoRoom { end: PathEnd::Start, .. } => 202,
            Self::NoRoom { end: PathEnd::Goal, .. } => 203,
            Self::StartTouches { .. } => 204,
            Self::GoalHeading { .. } => 205,
            Self::NotFinite { .. } => 206,
            Self::NoWay { .. } => 207,
            Self::Plan(_) => 208,
            Self::WayPoint { .. } => 209,
            Self::PlaceUnknown => 210,
            Self::NoPathToFollow => 211,
            Self::Misfit(_) => 212,
            Self::PathFarAway { .. } => 213,
        }
    }
}

/// Prefix that names the radius of a separation.
const fn margin_text(why: &Separation) -> &'static str {
    match why {
        Separation::TooNarrow { .. } => "with the safety margin around the robot, ",
        Separation::Apart { .. } => "",
    }
}

const fn every_heading_text(footprint: &Footprint, heading_rad: Option<&f64>) -> &'static str {
    match (footprint, heading_rad) {
        (Footprint::Polygon(_), None) => " at every heading",
        _ => "",
    }
}

fn headings_text(fits: &[HeadingRange]) -> String {
    if fits.is_empty() {
        return "it fits with no other yaw either: move the goal".to_owned();
    }
    let ranges: Vec<String> = fits.iter().map(|range| format!("{range} deg")).collect();
    format!("it fits there with a yaw of {}", ranges.join(", "))
}

fn nearest_text(nearest: Option<&Point>) -> String {
    nearest.map_or_else(
        || "; no other position on this map has enough clearance either".to_owned(),
        |p| format!("; the nearest position with enough clearance is ({:.3}, {:.3})", p.x, p.y),
    )
}
