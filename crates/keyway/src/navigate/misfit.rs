//! True if a footprint fits along a route: straight along each stretch, turning on the spot where
//! two of them meet.
//!
//! Routes are planned for a disc. Where that is smaller than the robot, a route leads where the
//! robot may not fit, and nobody would know before it stands there.

use crate::geometry::{Point, Polyline, Pose, wrap_angle};
use crate::map::DistanceField;
use crate::robot::Footprint;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::fmt::{Display, Formatter, Result};

/// The first place of a route at which the footprint does not fit. A robot that drives curves may
/// pass there all the same, and its recoveries may find a way through; but it may also get stuck.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Misfit {
    /// Along this straight stretch something is touched.
    Straight {
        /// Where the stretch begins \[m\].
        from: Point,
        /// Where it ends \[m\].
        to: Point,
    },
    /// At this corner there is no room to turn on the spot, to either side.
    Turn {
        /// Where \[m\].
        at: Point,
        /// From this heading, counter-clockwise from the x axis \[deg\].
        from_deg: f64,
        /// To this one \[deg\].
        to_deg: f64,
    },
}

impl Misfit {
    /// The first one along a path; none where a robot of this footprint can drive it, turning on
    /// the spot at its corners. Costs a few look-ups per stretch in the open.
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

/// Goes on after "the robot": "has no room to turn from 0 to 90 deg at (1.000, 2.000)".
impl Display for Misfit {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match *self {
            Self::Straight { from, to } => write!(
                f,
                "touches something on its way straight from ({:.3}, {:.3}) to ({:.3}, {:.3})",
                from.x, from.y, to.x, to.y
            ),
            Self::Turn { at, from_deg, to_deg } => write!(
                f,
                "has no room to turn from {from_deg:.0} to {to_deg:.0} deg at ({:.3}, {:.3})",
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
        // The diagonal of the square is 0.99 m: it turns within the lane. The rectangle is 1.08 m
        // from corner to corner.
        assert_eq!(along(&around, 0.7, 0.7), None);
        let at = Point::new(5.5, 1.5);
        let turn = Misfit::Turn { at, from_deg: 0.0, to_deg: 90.0 };
        assert_eq!(along(&around, 0.9, 0.6), Some(turn));
        assert_eq!(turn.to_string(), "has no room to turn from 0 to 90 deg at (5.500, 1.500)");
        let straight = along(&[[1.0, 1.5], [4.0, 1.5]], 1.2, 0.98);
        assert_eq!(straight, None);
        let aslant = along(&[[1.0, 1.5], [4.0, 1.7]], 0.9, 0.6).unwrap();
        assert!(
            aslant
                .to_string()
                .starts_with("touches something on its way straight from (1.000, 1.500)")
        );
        assert_eq!(along(&[[1.0, 1.5]], 9.0, 9.0), None, "nothing to drive");
    }
}
