//! The part of a field that may change with some obstacles.

use super::envelope::Envelope;
use super::{CellWindow, DistanceField};
use crate::map::Cell;
use std::ops::Range;

impl DistanceField {
    /// A rectangle around obstacles that contains every cell to which one of them is nearest.
    ///
    /// It grows until every cell of its rim is farther from them than from its nearest obstacle,
    /// by at least one cell. This is enough: along the straight line from an obstacle to a cell
    /// that it is nearest to, it is the nearest one everywhere. At the point where that line
    /// crosses the rim, half a cell from some centre, its distance and the nearest one there
    /// differ by at most twice that half.
    pub(super) fn touched(&self, obstacles: &CellWindow) -> CellWindow {
        let mut touched = *obstacles;
        let mut rims = SIDES.map(|side| Rim { side, far: None });
        loop {
            let before = touched;
            for rim in &mut rims {
                rim.move_out(&mut touched, self, obstacles);
            }
            if touched == before {
                return touched;
            }
        }
    }

    /// Number of cells by which a side of the rectangle must move outwards for the cells of its
    /// rim; 0 if all are far enough. It is half of the distance by which a cell's nearest
    /// obstacle is farther away than the changed ones, because the side moves from these towards
    /// that one. A few more cells save steps.
    fn missing_cells(&self, obstacles: &CellWindow, side: Side, rim: &CellWindow) -> i32 {
        const MORE_CELLS: i32 = 6;
        let CellWindow { low, high } = *obstacles;
        let rows = |part: CellWindow| {
            let rows = if part.is_empty() { 0..0 } else { part.low.y..part.high.y + 1 };
            rows.map(move |y| &self.half_cells_sq[self.part_of_row(y, &part)])
        };
        let mut most = f64::NEG_INFINITY;
        let mut ask = |cell: Cell, nearest: i32| {
            let across = self.to.away_sq(low.y, high.y, cell.y);
            let away = across + self.to.away_sq(low.x, high.x, cell.x);
            most = most.max(f64::from(nearest).sqrt() - f64::from(away).sqrt());
        };
        let [before, beside, after] = side.split(rim, obstacles);
        for part in [before, after] {
            for (y, row) in (part.low.y..).zip(rows(part)) {
                for (x, &nearest) in (part.low.x..).zip(row) {
                    ask(Cell::new(x, y), nearest);
                }
            }
        }
        // All of these are equally far from the changed obstacles.
        if let Some(&nearest) = rows(beside).flatten().max() {
            ask(beside.low, nearest);
        }
        // At most two half cells nearer, plus rounding.
        if most < -2.0 - 1e-6 { 0 } else { (0.25 * most.max(0.0)) as i32 + MORE_CELLS }
    }

    /// A rectangle that contains a nearest obstacle of every cell of another one, around which
    /// the distances are correct.
    ///
    /// Along the straight line from a cell to its nearest obstacle, that obstacle is the nearest
    /// one everywhere. At the point where the line crosses the row or column of cells around the
    /// rectangle, half a cell from some centre, it is at most one cell farther from that centre
    /// than the nearest one there.
    pub(super) fn sources(&self, touched: &CellWindow) -> CellWindow {
        let CellWindow { low, high } = *touched;
        let map = self.map_window();
        let mut sources = *touched;
        let mut reach = |cell: Cell| {
            if map.contains(cell) {
                // Half a cell from the obstacle's edge to its centre, one as above, plus
                // rounding.
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

/// A side of a rectangle.
#[derive(Clone, Copy)]
enum Side {
    Left,
    Right,
    Bottom,
    Top,
}

const SIDES: [Side; 4] = [Side::Left, Side::Right, Side::Bottom, Side::Top];

impl Side {
    /// The cells along the outside of this side, and one more at both ends.
    const fn rim(self, CellWindow { low, high }: &CellWindow) -> CellWindow {
        let (mut from, mut to) =
            (Cell::new(low.x - 1, low.y - 1), Cell::new(high.x + 1, high.y + 1));
        match self {
            Self::Left => to.x = from.x,
            Self::Right => from.x = to.x,
            Self::Bottom => to.y = from.y,
            Self::Top => from.y = to.y,
        }
        CellWindow { low: from, high: to }
    }

    /// Splits cells along this side into the parts before a window, beside it and after it.
    fn split(self, cells: &CellWindow, by: &CellWindow) -> [CellWindow; 3] {
        let (mut before, mut beside, mut after) = (*cells, *cells, *cells);
        if matches!(self, Self::Left | Self::Right) {
            before.high.y = cells.high.y.min(by.low.y - 1);
            beside.low.y = cells.low.y.max(by.low.y);
            beside.high.y = cells.high.y.min(by.high.y);
            after.low.y = cells.low.y.max(by.high.y + 1);
        } else {
            before.high.x = cells.high.x.min(by.low.x - 1);
            beside.low.x = cells.low.x.max(by.low.x);
            beside.high.x = cells.high.x.min(by.high.x);
            after.low.x = cells.low.x.max(by.high.x + 1);
        }
        [before, beside, after]
    }

    const fn move_out(self, rectangle: &mut CellWindow, cells: i32) {
        match self {
            Self::Left => rectangle.low.x -= cells,
            Self::Right => rectangle.high.x += cells,
            Self::Bottom => rectangle.low.y -= cells,
            Self::Top => rectangle.high.y += cells,
        }
    }
}

/// The cells along a side of a growing rectangle.
struct Rim {
    side: Side,
    /// Cells known to be far enough away at the side's present position.
    far: Option<CellWindow>,
}

impl Rim {
    /// Moves the side outwards if cells along it require it.
    fn move_out(
        &mut self,
        rectangle: &mut CellWindow,
        field: &DistanceField,
        obstacles: &CellWindow,
    ) {
        let map = field.map_window();
        let rim = self.side.rim(rectangle).clipped(&map);
        let missing = |cells: &CellWindow| {
            if cells.is_empty() { 0 } else { field.missing_cells(obstacles, self.side, cells) }
        };
        let missing = self.far.map_or_else(
            || missing(&rim),
            |far| {
                let [before, _, after] = self.side.split(&rim, &far);
                missing(&before).max(missing(&after))
            },
        );
        self.far = (missing == 0).then_some(rim);
        self.side.move_out(rectangle, missing);
        *rectangle = rectangle.clipped(&map);
    }
}

impl Envelope {
    /// The range of columns in which, in some rows of the field, cells may be nearest to an
    /// obstacle in `changed`: it is no farther away than their nearest obstacle.
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
                let along = self.to.away_sq(changed.low.x, changed.high.x, x);
                across + along <= row[x as usize]
            };
            from = (touched.low.x..from).find(may).unwrap_or(from);
            to = (to..=touched.high.x).rev().find(may).map_or(to, |x| x + 1);
        }
        from as usize..to as usize
    }
}

/// First and last column with a nearest obstacle of some columns of a few rows, outside of which
/// the distances are correct. The nearest obstacle of a cell lies no farther beyond the end of
/// its row than that of the cell just beyond that end.
pub(super) fn sources_beside<'a>(
    rows: impl Iterator<Item = (i32, &'a [i32])>,
    own: &Range<usize>,
) -> (i32, i32) {
    let (mut left, mut right) = (0, 0);
    for (_, row) in rows {
        left = left.max(own.start.checked_sub(1).map_or(0, |before| row[before]));
        right = right.max(row.get(own.end).copied().unwrap_or(0));
    }
    // Half a cell from the obstacle's edge to its centre, the cell beyond the end, plus rounding.
    let cells = |half_cells_sq: i32| (0.5 * f64::from(half_cells_sq).sqrt()) as i32 + 3;
    (own.start as i32 - cells(left), own.end as i32 + cells(right))
}
