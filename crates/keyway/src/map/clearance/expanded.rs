//! Test of lines against the expanded cells around obstacles.

use crate::geometry::{Point, Segment, Square};
use crate::map::Clearance;
use crate::map::clearance::TOUCH_TOLERANCE_CELLS;

impl Clearance<'_> {
    /// True if the segment touches an obstacle cell, or one that is at most `expansion_cells`
    /// rows and columns away from an obstacle cell. Touching a cell's corner is enough.
    pub(crate) fn touches_expanded(&self, segment: Segment, expansion_cells: u32) -> bool {
        let to_grid = |point| self.frame.grid_from_world(point);
        let grid = Segment::new(to_grid(segment.a), to_grid(segment.b));
        let reach = f64::from(expansion_cells) + TOUCH_TOLERANCE_CELLS;
        // Cells that are equally far away in rows and columns are the farthest.
        let farthest = reach * std::f64::consts::SQRT_2;
        !self.scan(grid, farthest, |square| !meets_expanded(grid, square, reach))
    }
}

/// True if the segment touches the square with `reach` added on all sides.
fn meets_expanded(segment: Segment, square: Square, reach: f64) -> bool {
    // Tested on coordinates scaled so that the larger square is the unit square.
    let corner = square.corner - Point::new(reach, reach);
    let scale = |point: Point| (point - corner) * (1.0 / (1.0 + 2.0 * reach));
    let unit = Square { corner: Point::default() };
    Segment::new(scale(segment.a), scale(segment.b)).meets(unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Cell, OccupancyGrid};
    use proptest::prelude::*;

    #[test]
    fn touching_by_hand() {
        // One cell around the obstacle (3, 3): the square from (2, 2) to (5, 5).
        let grid = OccupancyGrid::from_ascii(&["...#...", ".......", ".......", "......."]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let touches = |a: [f64; 2], b: [f64; 2], cells| {
            clearance.touches_expanded(Segment::new(a.into(), b.into()), cells)
        };
        assert!(touches([1.5, 2.5], [2.5, 1.5], 1), "its corner (2, 2)");
        assert!(!touches([1.4, 2.5], [2.4, 1.5], 1));
        assert!(touches([0.5, 2.0], [6.5, 2.0], 1), "its lower edge");
        assert!(!touches([0.5, 1.99], [6.5, 1.99], 1));
        assert!(touches([0.5, 3.0], [6.5, 3.0], 0) && !touches([0.5, 2.5], [6.5, 2.5], 0));
        assert!(touches([0.5, 0.5], [0.5, 0.5], 3), "three columns and three rows away");
    }

    proptest! {
        #[test]
        fn agrees_with_every_square(occupied in prop::collection::vec(0..99i32, 0..6), cells in 0..3u32,
                                    ends in prop::array::uniform4(0.1..9.9f64)) {
            let frame = crate::map::GridFrame::new(10, 10, 1.0, crate::geometry::Pose::default()).unwrap();
            let is_occupied = |cell: Cell| occupied.contains(&(cell.y * 10 + cell.x));
            let grid = OccupancyGrid::from_fn(frame, |cell| {
                if is_occupied(cell) { crate::map::CellState::Occupied } else { crate::map::CellState::Free }
            });
            let segment = Segment::new(Point::new(ends[0], ends[1]), Point::new(ends[2], ends[3]));
            let n = cells as i32;
            let is_expanded = |cell: Cell| {
                (-n..=n).any(|dx| (-n..=n).any(|dy| {
                    let near = Cell::new(cell.x + dx, cell.y + dy);
                    (0..10).contains(&near.x) && (0..10).contains(&near.y) && is_occupied(near)
                }))
            };
            let touched = (-3..13).flat_map(|y| (-3..13).map(move |x| Cell::new(x, y)))
                .filter(|&cell| is_expanded(cell))
                .any(|cell| segment.meets(Square { corner: Point::new(cell.x.into(), cell.y.into()) }));
            let clearance = Clearance::new(grid.frame(), grid.occupied());
            prop_assert_eq!(clearance.touches_expanded(segment, cells), touched);
        }
    }
}
