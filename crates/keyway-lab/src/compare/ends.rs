//! Start and goal of a query.

use keyway::geometry::Point;
use keyway::map::{Cell, GridFrame};

/// A start and a goal, and their cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// Start \[m\].
    pub start: Point,
    /// Goal \[m\].
    pub goal: Point,
    /// Cell of the start.
    pub start_cell: Cell,
    /// Cell of the goal.
    pub goal_cell: Cell,
    /// Line of the query in its file, from 1.
    pub line: Option<usize>,
}

impl Ends {
    /// Creates the start and goal of two cells.
    pub fn of_cells(
        frame: &GridFrame,
        [start_cell, goal_cell]: [Cell; 2],
        line: Option<usize>,
    ) -> Self {
        let [start, goal] = [start_cell, goal_cell].map(|cell| frame.world_from_cell(cell));
        Self { start, goal, start_cell, goal_cell, line }
    }

    /// Creates the start and goal at two positions; `None` if one is outside the map.
    pub fn of_points(
        frame: &GridFrame,
        (start, goal): (Point, Point),
        line: usize,
    ) -> Option<Self> {
        let [start_cell, goal_cell] = [start, goal].map(|end| frame.cell_from_world(end));
        let (start_cell, goal_cell) = start_cell.zip(goal_cell)?;
        Some(Self { start, goal, start_cell, goal_cell, line: Some(line) })
    }
}
