//! Simulated maps of the papers.

use keyway::geometry::Point;
use keyway_sim::worlds::{GeneratedMap, Pattern};

/// A square map with cells of 1 m, as in the papers, with free space around its start and goal.
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
