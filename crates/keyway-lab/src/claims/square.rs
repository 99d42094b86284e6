//! The papers' simulated maps.

use keyway::geometry::Point;
use keyway_sim::worlds::{GeneratedMap, Pattern};

/// A square in cells of 1 m, as the papers have it; around its ends there is room.
pub(super) const fn square(side_m: f64, free_ends_m: f64, obstacles: Pattern) -> GeneratedMap {
    GeneratedMap {
        width_m: side_m,
        height_m: side_m,
        resolution_m: 1.0,
        origin: Point::new(0.0, 0.0),
        free_ends_m,
        obstacles,
    }
}
