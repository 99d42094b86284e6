//! Map cells in a colour.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::{ABSENT, BLOCKED, OBSTACLE, Rgb, SENSED};
use crate::legend::{LegendEntry, LegendMark};
use keyway::map::{BitGrid, Cell, CellState};

/// The set cells of a grid, in one colour. Cells outside the map are not drawn.
#[derive(Clone, Debug)]
pub struct CellTint<'a> {
    cells: Cells<'a>,
    color: Rgb,
    label: String,
    depth: Depth,
    free_only: bool,
}

/// A set of cells.
#[derive(Clone, Copy, Debug)]
enum Cells<'a> {
    Grid(&'a BitGrid),
    /// Cells in ascending order.
    List(&'a [Cell]),
}

impl Cells<'_> {
    fn has(self, cell: Cell) -> bool {
        match self {
            // The grid may be smaller than the map, and its padding is not drawn.
            Self::Grid(grid) => {
                cell.x < grid.width() as i32 && cell.y < grid.height() as i32 && grid.get(cell)
            }
            Self::List(cells) => cells.binary_search(&cell).is_ok(),
        }
    }
}

impl<'a> CellTint<'a> {
    /// Creates cells in a colour, behind obstacles and paths.
    pub fn new(cells: &'a BitGrid, label: impl Into<String>, color: Rgb) -> Self {
        Self::of(Cells::Grid(cells), label, color)
    }

    fn of(cells: Cells<'a>, label: impl Into<String>, color: Rgb) -> Self {
        Self { cells, color, label: label.into(), depth: Depth::Cells, free_only: false }
    }

    /// Creates the inflation layer: cells that a search must not enter although they are free on
    /// the map. Cells that are not free on the map may be set; they are left out.
    pub fn blocked(cells: &'a BitGrid) -> Self {
        let tint = Self::new(cells, "free, too close for the robot", BLOCKED);
        Self { depth: Depth::Tint, free_only: true, ..tint }
    }

    /// Creates the cells in which the sensor has detected something.
    pub fn sensed(cells: &'a BitGrid) -> Self {
        Self::new(cells, "sensed", SENSED)
    }

    /// Creates the same from a list in ascending order: a small one, for one of many pictures.
    pub fn sensed_list(cells: &'a [Cell]) -> Self {
        Self::of(Cells::List(cells), "sensed", SENSED)
    }

    /// Creates the cells that are occupied but not on the map, in ascending order.
    pub fn unknown_obstacles(cells: &'a [Cell]) -> Self {
        let tint = Self::of(Cells::List(cells), "unknown obstacle (cells)", OBSTACLE);
        Self { depth: Depth::Obstacles, ..tint }
    }

    /// Creates the cells that are occupied on the map but free in the world, in ascending order.
    pub fn absent(cells: &'a [Cell]) -> Self {
        Self::of(Cells::List(cells), "on the map, but not there", ABSENT)
    }

    /// Sets another colour.
    #[must_use]
    pub fn color(self, color: Rgb) -> Self {
        Self { color, ..self }
    }

    /// Sets the text in the legend.
    #[must_use]
    pub fn label(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }
}

impl Layer for CellTint<'_> {
    fn depth(&self) -> Depth {
        self.depth
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let (map, cells) = (canvas.map(), self.cells);
        let wanted =
            |cell| cells.has(cell) && (!self.free_only || map.state(cell) == Some(CellState::Free));
        if canvas.cells(self.color, wanted) {
            canvas.explain(LegendEntry::new(self.label.clone(), LegendMark::Area(self.color)));
        }
    }
}
