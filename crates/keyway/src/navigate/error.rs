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
    /// A value of the robot or the stack cannot be used; for the robot's, the path begins with
    /// `robot`.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The footprint does not fit at the start or goal.
    #[error(
        "{end} ({}, {}) leaves no room for a radius of {} m: {why}{}",
        Computed(.position.x), Computed(.position.y), Computed(*.radius_m),
        nearest_text(.nearest.as_ref())
    )]
    NoRoom {
        /// Start or goal.
        end: PathEnd,
        /// The position asked for \[m\].
        position: Point,
        /// The robot's radius \[m\].
        radius_m: f64,
        /// The nearest hindrance.
        why: Hindrance,
        /// The nearest position with room \[m\], unless there is none.
        nearest: Option<Point>,
    },
    /// The robot would begin in contact with something.
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
        /// Its heading \[rad\]; `None`: it touches something at every heading.
        heading_rad: Option<f64>,
        /// The robot.
        footprint: Footprint,
        /// The hindrance nearest to the start.
        why: Hindrance,
    },
    /// The footprint does not fit at the goal with the heading there.
    #[error(
        "at the goal ({}, {}) the robot ({footprint}) does not fit with a yaw of {} deg; {}",
        Computed(.position.x), Computed(.position.y), Computed(degrees(*.heading_rad)), headings_text(.fits)
    )]
    GoalHeading {
        /// The goal \[m\].
        position: Point,
        /// Its heading \[rad\].
        heading_rad: f64,
        /// The robot.
        footprint: Footprint,
        /// The headings at which it fits there.
        fits: Vec<HeadingRange>,
    },
    /// A start or goal that is not a place.
    #[error(
        "{end} ({}, {}) is no place on a map: both coordinates must be finite numbers; \
         check the localisation, or the file that it is from",
        Given(.position.x), Given(.position.y)
    )]
    NotFinite {
        /// Start or goal.
        end: PathEnd,
        /// The position asked for.
        position: Point,
    },
    /// There is no way on the known map.
    #[error("{}{why}", margin_text(.why))]
    NoWay {
        /// The clearance that would leave one, or the way in which start and goal are parted.
        why: Separation,
    },
    /// A path to be followed does not lead anywhere.
    #[error("a path to be followed needs two points or more, all of them finite")]
    NoPathToFollow,
    /// A path to be followed begins too far from the robot.
    #[error(
        "the path begins {} m from the robot, and may begin {} m from it at most: drive to its beginning first",
        Computed(*.away_m), Computed(*.most_m)
    )]
    PathFarAway {
        /// Distance of its beginning from the robot \[m\].
        away_m: f64,
        /// The largest distance from which it is followed \[m\].
        most_m: f64,
    },
    /// The robot does not fit along a path that it is to follow.
    #[error("the robot does not fit along the path: {0}")]
    Misfit(Misfit),
    /// Nobody has said where the robot is.
    #[error(
        "where the robot is is unknown: observe its pose, or tell its place, before it gets a goal"
    )]
    PlaceUnknown,
    /// There is no route.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// There is none to a way-point, or on from the one before it.
    #[error("way-point {number}: {why}")]
    WayPoint {
        /// Its number, from 1.
        number: usize,
        /// The reason.
        why: Box<NavigateError>,
    },
}

impl NavigateError {
    /// True if the goal cannot be reached, and not because of the start.
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

    /// Its kind as a number, which never changes and which no other error or stop has
    /// ([`Blocked::kind`](super::Blocked::kind)): for programs that do not read texts.
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

/// Of which radius it is.
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
        return "nor does it with any other: move the goal".to_owned();
    }
    let ranges: Vec<String> = fits.iter().map(|range| format!("{range} deg")).collect();
    format!("there it fits with one of {}", ranges.join(", "))
}

fn nearest_text(nearest: Option<&Point>) -> String {
    nearest.map_or_else(
        || "; no other place on this map has room either".to_owned(),
        |p| format!("; the nearest position with room is ({:.3}, {:.3})", p.x, p.y),
    )
}
