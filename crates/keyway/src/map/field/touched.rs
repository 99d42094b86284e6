//! Which part of a field may change with some obstacles.

use super::envelope::Envelope;
use super::{CellWindow, DistanceField};
use crate::map::Cell;
use std::ops::Range;

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
            let column =
                |x| CellWindow { low: Cell::new(x, low.y - 1), high: Cell::new(x, high.y + 1) };
            let row =
                |y| CellWindow { low: Cell::new(low.x - 1, y), high: Cell::new(high.x + 1, y) };
            let missing = |side| self.missing_cells(obstacles, &side);
            touched.low.x -= missing(column(low.x - 1));
            touched.low.y -= missing(row(low.y - 1));
            touched.high.x += missing(column(high.x + 1));
            touched.high.y += missing(row(high.y + 1));
            touched = touched.clipped(&map);
            if (touched.low, touched.high) == (low, high) {
                return touched;
            }
        }
    }

    /// How far a side of the rectangle moves out: half of what the nearest obstacle of a cell there
    /// is farther away than the changed ones, as the way goes from these towards that one, and a
    /// little more, to be there soon; 0 when the side is far enough.
    fn missing_cells(&self, obstacles: &CellWindow, side: &CellWindow) -> i32 {
        const MORE_CELLS: i32 = 3;
        let side = side.clipped(&self.map_window());
        if side.low.x > side.high.x || side.low.y > side.high.y {
            return 0;
        }
        let mut missing = None;
        for y in side.low.y..=side.high.y {
            let across = self.to.away_sq(obstacles.low.y, obstacles.high.y, y);
            let row = &self.half_cells_sq[self.part_of_row(y, &side)];
            for (x, &nearest) in (side.low.x..).zip(row) {
                let away = across + self.to.away_sq(obstacles.low.x, obstacles.high.x, x);
                let nearest = i64::from(nearest);
                // sqrt(away) <= sqrt(nearest) + 2 half cells.
                let more = away - nearest - 4;
                if more <= 0 || more * more <= 16 * nearest {
                    let half_cells = (nearest as f64).sqrt() - (away as f64).sqrt();
                    missing = missing.max(Some((0.25 * half_cells.max(0.0)) as i32));
                }
            }
        }
        missing.map_or(0, |cells| cells + MORE_CELLS)
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

impl Envelope {
    /// The columns between which, in some rows of the field, cells may be nearest to an obstacle in
    /// `changed`: these are no farther away than what is nearest.
    pub(super) fn may_change<'a>(
        &self,
        rows: impl Iterator<Item = (i32, &'a [i32])>,
        touched: &CellWindow,
        changed: &CellWindow,
    ) -> Range<usize> {
        let (mut from, mut to) = (changed.low.x, changed.high.x + 1);
        for (y, row) in rows {
            let across = self.to.away_sq(changed.low.y, changed.high.y, y);
            let may = |&x: &i32| {
                let away = across + self.to.away_sq(changed.low.x, changed.high.x, x);
                away <= i64::from(row[x as usize])
            };
            from = (touched.low.x..from).find(may).unwrap_or(from);
            to = (to..=touched.high.x).rev().find(may).map_or(to, |x| x + 1);
        }
        from as usize..to as usize
    }
}
