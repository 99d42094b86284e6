//! Clearances in spite of rounding: lines and arcs that just keep one, on turned maps.
#![allow(clippy::unwrap_used)]

use keyway::geometry::{Arc, Point, Pose, Segment};
use keyway::map::{CellState, Clearance, GridFrame, OccupancyGrid};
use std::f64::consts::PI;

/// One obstacle cell, (20, 12), on a map of 30 x 25 cells.
fn one_obstacle(resolution_m: f64, yaw: f64) -> OccupancyGrid {
    let frame = GridFrame::new(30, 25, resolution_m, Pose::new(-3.1, 2.7, yaw)).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        if (cell.x, cell.y) == (20, 12) { CellState::Occupied } else { CellState::Free }
    })
}

#[test]
fn whole_cells_of_clearance_are_kept_by_lines_that_are_so_far_away() {
    for (i, resolution_m) in [0.05, 0.1, 0.2, 0.3, 0.7, 1.0].into_iter().enumerate() {
        let grid = one_obstacle(resolution_m, 0.37 * i as f64);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let world = |x: f64, y: f64| grid.frame().world_from_grid(Point::new(x, y));
        for cells in 1..=9 {
            let cells = f64::from(cells);
            let asked_m = cells * resolution_m;
            // Beside the obstacle, and beside the map's border.
            let lines = [
                Segment::new(world(20.0 - cells, 12.0), world(20.0 - cells, 13.0)),
                Segment::new(world(cells, 24.0 - cells), world(9.0, 25.0 - cells)),
            ];
            for line in lines {
                assert!(clearance.is_clear(line, asked_m), "{line:?}, {asked_m} m");
                let nearer_m = asked_m + 1e-6 * resolution_m;
                assert!(!clearance.is_clear(line, nearer_m), "{line:?}, {nearer_m} m");
            }
        }
    }
}

#[test]
fn the_border_of_a_turned_map_can_be_touched() {
    for turn in 0..40 {
        let grid = one_obstacle(0.1, 0.16 * f64::from(turn));
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let world = |x: f64, y: f64| grid.frame().world_from_grid(Point::new(x, y));
        let corners = [world(0.0, 0.0), world(30.0, 0.0), world(30.0, 25.0), world(0.0, 25.0)];
        for (k, &corner) in corners.iter().enumerate() {
            let along = Segment::new(corner, corners[(k + 1) % 4]);
            assert!(clearance.is_clear(along, 0.0), "{along:?}");
        }
    }
}

#[test]
fn an_arc_that_is_as_good_as_straight_does_not_slip_along_a_joint() {
    let grid = OccupancyGrid::from_ascii(&["...", ".#.", ".#."]);
    let clearance = Clearance::new(grid.frame(), grid.occupied());
    // Of 1 m and 10 micrometres long: 1e-11 m from its chord, to the left along the joint y = 1, at
    // x = 1.5.
    let short = |y: f64| Arc::new(Point::new(1.5, y - 1.0), 1.0, 0.5 * PI, 1e-5);
    assert!(!clearance.is_clear_arc(short(1.0), 0.0), "along the joint");
    assert!(clearance.is_clear_arc(short(2.0), 0.0), "along the upper edge");
    assert!(!clearance.is_clear_arc(short(1.9), 0.0), "inside");
}
