//! A building for controllers to drive in.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

use keyway::geometry::{Point, Pose};
use keyway::map::{Cell, GridFrame, OccupancyGrid};

/// 0.1 m cells from a drawing of 0.5 m blocks.
pub(crate) fn blocks(rows: &[&str]) -> OccupancyGrid {
    let coarse = OccupancyGrid::from_ascii(rows);
    let (width, height) = (coarse.frame().width(), coarse.frame().height());
    let frame =
        GridFrame::new(u64::from(width) * 5, u64::from(height) * 5, 0.1, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| coarse.state(Cell::new(cell.x / 5, cell.y / 5)).unwrap())
}

/// A corridor with a recess, and a closed room that cannot be seen into.
pub(crate) fn building() -> OccupancyGrid {
    blocks(&[
        "####################",
        "#..............#...#",
        "#..............#...#",
        "#....#####.....#...#",
        "#....#####.....#####",
        "#..................#",
        "#..................#",
        "####################",
    ])
}

pub(crate) const START: Point = Point::new(1.25, 0.95);
pub(crate) const GOAL: Point = Point::new(6.5, 3.0);
