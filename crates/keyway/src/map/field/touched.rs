//! Which part of a field may change with some obstacles.

use super::envelope::FAR_ROWS;
use super::{CellWindow, DistanceField};
use crate::map::Cell;

impl DistanceField {
    /// A rectangle around obstacles that holds every cell to which one of them is nearest.
    ///
    /// It grows until its rim holds no cell nearer to them, by less than one cell, than to what is
    /// nearest: on the way from an obstacle to a cell that it is nearest to it is nearest everywhere,
    /// and where that way crosses the rim, half a cell from some centre, its distance and the
    /// nearest one there differ by at most twice that half.
    pub(super) fn touched(&self, obstacles: &CellWindow) -> CellWindow {
        let map = self.map_window();
        let mut touched = *obstacles;
        loop {
            let CellWindow { low, high } = touched;
            let (columns, rows) = (low.x - 1..=high.x + 1, low.y - 1..=high.y + 1);
            let column = |x| rows.clone().map(move |y| Cell::new(x, y));
            let row = |y| columns.clone().map(move |x| Cell::new(x, y));
            let slack = [
                self.slack_cells(obstacles, column(low.x - 1)),
                self.slack_cells(obstacles, column(high.x + 1)),
                self.slack_cells(obstacles, row(low.y - 1)),
                self.slack_cells(obstacles, row(high.y + 1)),
            ];
            touched.low = Cell::new(low.x - slack[0], low.y - slack[2]);
            touched.high = Cell::new(high.x + slack[1], high.y + slack[3]);
            touched = touched.clipped(&map);
            if (touched.low, touched.high) == (low, high) {
                return touched;
            }
        }
    }

    /// How far at least a side of the rectangle must move out: half of what the nearest obstacle of
    /// a cell there is farther away than the changed ones, as the way goes from these towards that
    /// one; 0 when the side is far enough.
    fn slack_cells(&self, obstacles: &CellWindow, side: impl Iterator<Item = Cell>) -> i32 {
        let mut slack = -1.0_f64;
        for cell in side.filter(|&cell| self.frame.contains(cell)) {
            let nearest = f64::from(self.half_cells_sq[self.index(cell)]);
            let away = f64::from(self.half_cells_sq_to(obstacles, cell));
            // sqrt(away) <= sqrt(nearest) + 2 half cells.
            if away <= nearest + 4.0 || (away - nearest - 4.0).powi(2) <= 16.0 * nearest {
                slack = slack.max(nearest.sqrt() - away.sqrt()).max(0.0);
            }
        }
        // From half cells of difference to cells of half of it.
        if slack < 0.0 { 0 } else { 1 + (0.25 * slack) as i32 }
    }

    /// Squared distance from a cell to the nearest cell of a window, in half cells.
    fn half_cells_sq_to(&self, window: &CellWindow, cell: Cell) -> i32 {
        let along = |low: i32, high: i32, at: i32| {
            let cells = (low - at).max(at - high).max(0);
            self.to.half_cells_sq(cells.min(i32::from(FAR_ROWS)) as i16)
        };
        along(window.low.x, window.high.x, cell.x) + along(window.low.y, window.high.y, cell.y)
    }

    /// A rectangle that holds a nearest obstacle of every cell of another one, around which the
    /// distances are right.
    ///
    /// On the way from a cell to its nearest obstacle that one is the nearest everywhere. Where the
    /// way crosses the row or column of cells around the rectangle, half a cell from some centre, it
    /// is at most one cell farther from that centre than what is nearest there.
    pub(super) fn sources(&self, touched: &CellWindow) -> CellWindow {
        let CellWindow { low, high } = *touched;
        let map = self.map_window();
        let mut sources = *touched;
        let mut reach = |cell: Cell| {
            if map.contains(cell) {
                // Half a cell from the obstacle's edge to its centre, one as above, and rounding.
                let half_cells = f64::from(self.half_cells_sq[self.index(cell)]).sqrt();
                let cells = (0.5 * half_cells) as i32 + 2;
                sources = sources.union(&CellWindow {
                    low: Cell::new(cell.x - cells, cell.y - cells),
                    high: Cell::new(cell.x + cells, cell.y + cells),
                });
            }
        };
        for x in low.x - 1..=high.x + 1 {
            reach(Cell::new(x, low.y - 1));
            reach(Cell::new(x, high.y + 1));
        }
        for y in low.y..=high.y {
            reach(Cell::new(low.x - 1, y));
            reach(Cell::new(high.x + 1, y));
        }
        sources.clipped(&map)
    }
}
