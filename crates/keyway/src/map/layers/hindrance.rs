//! The obstacle or border that is nearest to a position.

use crate::geometry::Point;
use crate::map::{Clearance, SearchMap, UnknownPolicy};
use serde::{Deserialize, Serialize};
use std::fmt::{Display, Formatter, Result};

/// The nearest obstacle, unknown cell or border that a footprint may not touch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Hindrance {
    /// The position is outside the map, which no footprint may leave.
    Outside,
    /// The border of the map.
    Border {
        /// Its distance \[m\].
        distance_m: f64,
    },
    /// An obstacle of the map.
    Obstacle {
        /// Its distance \[m\]; 0 inside.
        distance_m: f64,
    },
    /// Unknown space, which counts as an obstacle.
    Unknown {
        /// Its distance \[m\]; 0 inside.
        distance_m: f64,
    },
}

/// A clause of its own, such as "an obstacle is 0.125 m away".
impl Display for Hindrance {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match *self {
            Self::Outside => f.write_str("it is outside the map"),
            Self::Border { distance_m } => {
                write!(f, "the border of the map is {:.3} m away", rounded_down(distance_m))
            }
            Self::Obstacle { distance_m: 0.0 } => f.write_str("it is inside an obstacle"),
            Self::Obstacle { distance_m } => {
                write!(f, "an obstacle is {:.3} m away", rounded_down(distance_m))
            }
            Self::Unknown { distance_m: 0.0 } => {
                f.write_str("it is in unknown space, which counts as an obstacle")
            }
            Self::Unknown { distance_m } => write!(
                f,
                "unknown space, which counts as an obstacle, is {:.3} m away",
                rounded_down(distance_m)
            ),
        }
    }
}

/// Rounds down to whole millimetres, so that a length that is too short does not read like the
/// required one. Less than a nanometre below a whole millimetre counts as rounding.
pub(in crate::map) fn rounded_down(length_m: f64) -> f64 {
    (length_m * 1e3 + 1e-6).floor() / 1e3
}

impl SearchMap {
    /// The nearest obstacle or border, which limits the size of a footprint at a position.
    pub fn hindrance(&self, position: Point) -> Hindrance {
        let frame = self.frame();
        if frame.cell_from_world(position).is_none() {
            return Hindrance::Outside;
        }
        let grid = frame.grid_from_world(position);
        let (width, height) = (f64::from(frame.width()), f64::from(frame.height()));
        let border_cells = grid.x.min(width - grid.x).min(grid.y).min(height - grid.y).max(0.0);
        let border_m = border_cells * frame.resolution_m();
        let distance_m = self.clearance().of_point(position, border_m);
        if distance_m >= border_m {
            return Hindrance::Border { distance_m: border_m };
        }
        let unknown = Clearance::new(frame, self.unknown());
        let counts = self.config().unknown == UnknownPolicy::Blocked;
        if counts && unknown.of_point(position, border_m) <= distance_m {
            return Hindrance::Unknown { distance_m };
        }
        Hindrance::Obstacle { distance_m }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    #[test]
    fn each_by_hand() {
        let grid = OccupancyGrid::from_ascii(&["......", "......", "#....?", "......", "......"]);
        let map = |unknown| {
            SearchMap::new(&grid, LayerConfig { unknown, ..LayerConfig::default() }).unwrap()
        };
        let blocked = map(UnknownPolicy::Blocked);
        let at = |x, y| blocked.hindrance(Point::new(x, y));
        assert_eq!(at(0.5, 2.5), Hindrance::Obstacle { distance_m: 0.0 });
        assert_eq!(at(1.25, 2.5), Hindrance::Obstacle { distance_m: 0.25 });
        assert_eq!(at(4.75, 2.5), Hindrance::Unknown { distance_m: 0.25 });
        assert_eq!(at(5.5, 2.5), Hindrance::Unknown { distance_m: 0.0 });
        assert_eq!(at(3.0, 0.125), Hindrance::Border { distance_m: 0.125 });
        assert_eq!(at(6.5, 2.5), Hindrance::Outside);
        let free = map(UnknownPolicy::Free);
        assert_eq!(free.hindrance(Point::new(5.5, 2.5)), Hindrance::Border { distance_m: 0.5 });
    }

    #[test]
    fn a_distance_that_is_too_short_does_not_look_long_enough() {
        let text = Hindrance::Obstacle { distance_m: 0.17996 }.to_string();
        assert_eq!(text, "an obstacle is 0.179 m away");
        assert_eq!(rounded_down(0.45), 0.45);
        assert_eq!(rounded_down(9.0 * 0.05), 0.45);
    }
}
