//! Where a query begins and ends.

use keyway::geometry::Point;
use keyway::map::{Cell, GridFrame};

/// A start and a goal, and the cells in which they lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends {
    pub(super) start: Point,
    pub(super) goal: Point,
    pub(super) start_cell: Cell,
    pub(super) goal_cell: Cell,
    /// The line of the file that asks for them, from 1.
    pub(super) line: Option<usize>,
}

impl Ends {
    /// For two cells.
    pub(super) fn of_cells(
        frame: &GridFrame,
        [start_cell, goal_cell]: [Cell; 2],
        line: Option<usize>,
    ) -> Self {
        let [start, goal] = [start_cell, goal_cell].map(|cell| frame.world_from_cell(cell));
        Self { start, goal, start_cell, goal_cell, line }
    }

    /// For two positions; `None` where one is outside the map.
    pub(super) fn of_points(
        frame: &GridFrame,
        (start, goal): (Point, Point),
        line: usize,
    ) -> Option<Self> {
        let [start_cell, goal_cell] = [start, goal].map(|end| frame.cell_from_world(end));
        let (start_cell, goal_cell) = start_cell.zip(goal_cell)?;
        Some(Self { start, goal, start_cell, goal_cell, line: Some(line) })
    }
}
