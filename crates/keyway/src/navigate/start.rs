//! Checks on the start position of a robot.
//!
//! A localisation has a small error, so the reported position may be one at which the robot
//! touches a wall. A start is therefore accepted if the robot fits at any position within that
//! error ([`ControllerConfig::start_error_m`](super::ControllerConfig::start_error_m)). Its route
//! then starts at that position. The local planner and the stop rule let the robot leave the
//! obstacle that is too close, but not approach it.

use crate::geometry::{Point, Pose};
use crate::map::{Clearance, Hindrance};
use crate::robot::Footprint;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use thiserror::Error;

/// A start that is closer to an obstacle than the robot fits.
#[derive(Clone, Debug, PartialEq, Error, Serialize, Deserialize)]
#[error(
    "the reported start is closer to an obstacle than the robot fits ({why}); the robot moves away \
     from it first: the localisation is off by at least {off_m:.3} m, or the map or the footprint \
     is wrong"
)]
#[non_exhaustive]
pub struct StartTooNear {
    /// The obstacle that is too close.
    pub why: Hindrance,
    /// A position at which the robot fits, at which its route starts \[m\].
    pub nearest: Point,
    /// Its distance from the start \[m\].
    pub off_m: f64,
}

/// True if a footprint touches an obstacle or the border of the map, or is beyond it: the contact
/// test of the simulator.
pub fn touches(footprint: &Footprint, pose: Pose, clearance: &Clearance<'_>) -> bool {
    // Beyond this distance, contact is impossible.
    const REACH_M: f64 = 1e-6;
    footprint.to_border_m(pose, clearance) <= 0.0
        || footprint.distance_m(pose, clearance, REACH_M) <= 0.0
}

/// True if a footprint touches an obstacle at every heading. The heading is known to the
/// controller only later, so one heading without contact is enough; they are tried in steps of
/// one degree.
pub(super) fn touches_at_every_heading(
    footprint: &Footprint,
    position: Point,
    clearance: &Clearance<'_>,
) -> bool {
    let headings = match footprint {
        Footprint::Circle(_) => 1,
        Footprint::Polygon(_) => 360,
    };
    let at = |degree: i32| Pose::new(position.x, position.y, f64::from(degree).to_radians());
    (0..headings).all(|degree| touches(footprint, at(degree), clearance))
}

/// The nearest of some positions around the given one, within `within_m`, at which a footprint
/// touches nothing at some heading and keeps its inscribed radius to all obstacles.
pub(super) fn nearest_fitting(
    footprint: &Footprint,
    position: Point,
    within_m: f64,
    clearance: &Clearance<'_>,
) -> Option<Point> {
    const RINGS: u32 = 5;
    const DIRECTIONS: u32 = 16;
    let fits = |place: &Point| {
        clearance.is_clear_point(*place, footprint.inscribed_radius_m())
            && !touches_at_every_heading(footprint, *place, clearance)
    };
    let around = (1..=RINGS).flat_map(|ring| {
        let away_m = within_m * f64::from(ring) / f64::from(RINGS);
        (0..DIRECTIONS).map(move |direction| {
            let (sin, cos) = libm::sincos(TAU * f64::from(direction) / f64::from(DIRECTIONS));
            position + Point::new(cos, sin) * away_m
        })
    });
    let around = if within_m > 0.0 { Some(around) } else { None };
    around.into_iter().flatten().find(fits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::OccupancyGrid;

    #[test]
    fn contacts_by_hand() {
        let grid = OccupancyGrid::from_ascii(&["#####", ".....", "#####"]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let touches = |footprint: &Footprint, x, y| {
            touches_at_every_heading(footprint, Point::new(x, y), &clearance)
        };
        let round = Footprint::circle(0.4).unwrap();
        assert!(!touches(&round, 2.5, 1.401) && !touches(&round, 0.401, 1.5));
        assert!(touches(&round, 2.5, 1.4), "the wall");
        assert!(touches(&round, 0.4, 1.5) && touches(&round, -1.0, 1.5), "the border");
        // It fits along the lane, and at no heading if it is as wide as the lane.
        let along = Footprint::rectangle(2.0, 0.9).unwrap();
        assert!(!touches(&along, 2.5, 1.5));
        let wide = Footprint::rectangle(2.0, 1.0).unwrap();
        assert!(touches(&wide, 2.5, 1.5));
    }

    #[test]
    fn places_beside_a_wall_by_hand() {
        let grid = OccupancyGrid::from_ascii(&["#####", ".....", "#####"]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let place = |footprint: &Footprint, x, y, within_m| {
            nearest_fitting(footprint, Point::new(x, y), within_m, &clearance)
        };
        // It fits from y = 1.4 m to 1.6 m without contact.
        let round = Footprint::circle(0.4).unwrap();
        let found = place(&round, 2.5, 1.35, 0.1).unwrap();
        assert!(found.y > 1.4 && found.distance(Point::new(2.5, 1.35)) <= 0.1, "{found:?}");
        assert_eq!(place(&round, 2.5, 1.35, 0.04), None);
        assert_eq!(place(&round, 2.5, 1.35, 0.0), None);
        // Between two walls whose distance is less than its width.
        assert_eq!(place(&Footprint::circle(0.52).unwrap(), 2.5, 1.5, 0.1), None);
        // In a corner with the border, it gets away from both.
        let found = place(&round, 0.37, 1.37, 0.05).unwrap();
        assert!(found.x > 0.4 && found.y > 1.4, "{found:?}");
        // A rectangle that fits along the lane only.
        let long = Footprint::rectangle(1.2, 0.8).unwrap();
        assert!(place(&long, 2.5, 1.38, 0.05).is_some_and(|place| place.y > 1.4));
    }
}
