//! Checks that a footprint fits along a route: straight along each segment, with a rotation on
//! the spot between two segments.
//!
//! Routes are planned for a disc. If that is smaller than the robot, a route may lead to where
//! the robot does not fit, which it would otherwise notice only there.

use crate::geometry::{Point, Polyline, Pose, wrap_angle};
use crate::map::DistanceField;
use crate::robot::Footprint;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::fmt::{Display, Formatter, Result};

/// The first part of a route at which the footprint does not fit. A robot that drives curves may
/// still pass there, and its recoveries may find a way through; but it may also get stuck.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Misfit {
    /// The robot touches an obstacle along this straight segment.
    Straight {
        /// Start of the segment \[m\].
        from: Point,
        /// End of the segment \[m\].
        to: Point,
    },
    /// There is no space to rotate on the spot at this corner, in either direction.
    Turn {
        /// Position of the corner \[m\].
        at: Point,
        /// Heading before the rotation, counter-clockwise from the x axis \[deg\].
        from_deg: f64,
        /// Heading after the rotation \[deg\].
        to_deg: f64,
    },
}

impl Misfit {
    /// The first misfit along a path; `None` if a robot of this footprint can drive it with
    /// rotations on the spot at its corners. Costs a few look-ups per segment in open space.
    pub(crate) fn first_along(
        path: &Polyline,
        footprint: &Footprint,
        obstacles: &DistanceField,
    ) -> Option<Self> {
        let mut before: Option<f64> = None;
        for segment in path.segments() {
            let (from, to) = (segment.a, segment.b);
            let heading = (to - from).heading();
            if let Some(before) = before.replace(heading) {
                let turn = wrap_angle(heading - before);
                let other_way = turn - TAU.copysign(turn);
                let fits = |turn| footprint.is_free_turn(from, before, turn, obstacles);
                if !fits(turn) && !fits(other_way) {
                    let (from_deg, to_deg) = (before.to_degrees(), heading.to_degrees());
                    return Some(Self::Turn { at: from, from_deg, to_deg });
                }
            }
            let pose = Pose::new(from.x, from.y, heading);
            if !footprint.is_free_drive(pose, segment.length(), obstacles) {
                return Some(Self::Straight { from, to });
            }
        }
        None
    }
}

/// Completes a sentence that starts with "the robot": "has no space to turn from 0 to 90 deg at
/// (1.000, 2.000)".
impl Display for Misfit {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match *self {
            Self::Straight { from, to } => write!(
                f,
                "touches something on the straight segment from ({:.3}, {:.3}) to ({:.3}, {:.3})",
                from.x, from.y, to.x, to.y
            ),
            Self::Turn { at, from_deg, to_deg } => write!(
                f,
                "has no space to turn from {from_deg:.0} to {to_deg:.0} deg at ({:.3}, {:.3})",
                at.x, at.y
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{FieldConfig, OccupancyGrid};

    #[test]
    fn a_lane_and_a_corner_by_hand() {
        // A lane of 1 m that turns into another one.
        let grid = OccupancyGrid::from_ascii(&["#####.#", "#####.#", "......#", "#######"]);
        let field = DistanceField::new(grid.frame(), grid.occupied(), &FieldConfig::default());
        let along = |points: &[[f64; 2]], length_m, width_m| {
            let path = Polyline::new(points.iter().map(|&point| point.into()).collect());
            let footprint = Footprint::rectangle(length_m, width_m).unwrap();
            Misfit::first_along(&path, &footprint, &field)
        };
        let around = [[1.0, 1.5], [5.5, 1.5], [5.5, 3.3]];
        // The diagonal of the square is 0.99 m: it rotates within the lane. The rectangle is 1.08
        // m from corner to corner.
        assert_eq!(along(&around, 0.7, 0.7), None);
        let at = Point::new(5.5, 1.5);
        let turn = Misfit::Turn { at, from_deg: 0.0, to_deg: 90.0 };
        assert_eq!(along(&around, 0.9, 0.6), Some(turn));
        assert_eq!(turn.to_string(), "has no space to turn from 0 to 90 deg at (5.500, 1.500)");
        let straight = along(&[[1.0, 1.5], [4.0, 1.5]], 1.2, 0.98);
        assert_eq!(straight, None);
        let aslant = along(&[[1.0, 1.5], [4.0, 1.7]], 0.9, 0.6).unwrap();
        assert!(
            aslant
                .to_string()
                .starts_with("touches something on the straight segment from (1.000, 1.500)")
        );
        assert_eq!(along(&[[1.0, 1.5]], 9.0, 9.0), None, "nothing to drive");
    }
}
