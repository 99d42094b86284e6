//! Shapes and maps for tests.

use keyway::geometry::Point;
use keyway::map::{CellState, GridFrame, OccupancyGrid};

/// Vertices of a star around a point: each radius in turn, at equal angles.
pub(super) fn star(radii: &[f64], around: (f64, f64)) -> Vec<Point> {
    let step_rad = std::f64::consts::TAU / radii.len() as f64;
    let vertex = |(i, &radius): (usize, &f64)| {
        let (sin, cos) = (step_rad * i as f64).sin_cos();
        Point::new(around.0 + radius * cos, around.1 + radius * sin)
    };
    radii.iter().enumerate().map(vertex).collect()
}

/// A grid with the given occupied cells, row by row from the bottom; the others are free.
pub(super) fn grid_of(frame: GridFrame, occupied: &[bool]) -> OccupancyGrid {
    let mut each = occupied.iter();
    OccupancyGrid::from_fn(frame, |_| match each.next() {
        Some(true) => CellState::Occupied,
        _ => CellState::Free,
    })
}
