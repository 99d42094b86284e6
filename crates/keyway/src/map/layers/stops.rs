//! The cells at which the scans of a jump point search stop.

use crate::map::{BitGrid, Cell};
use std::ops::{Range, RangeInclusive};

/// Stop bitmaps: for each of the four straight directions the cells at which a scan stops (a
/// blocked cell, or a jump point \[Harabor2011, without corner cutting\]), and the 2 x 2 blocks
/// of cells that no diagonal step can cross.
///
/// Moving east from p to x, x is a jump point iff the cell above p is blocked and the one above x
/// free, or the same below. There is a bit per cell and direction, so a scan is a load, a mask
/// and a count of zeros per 64 cells. North and south are stored in transposed rows (x and y
/// exchanged). The padding is set: every scan ends at the map's border.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct StopBitmaps {
    /// Scans towards larger columns, by rows.
    pub(crate) east: BitGrid,
    /// Scans towards smaller columns, by rows.
    pub(crate) west: BitGrid,
    /// Scans towards larger rows, by columns.
    pub(crate) north: BitGrid,
    /// Scans towards smaller rows, by columns.
    pub(crate) south: BitGrid,
    /// By rows: a bit is set if a cell, its eastern or northern neighbour, or the one between
    /// them is blocked. If it is clear, both diagonal steps across these 2 x 2 cells are
    /// possible.
    pub(crate) cramped: BitGrid,
}

impl StopBitmaps {
    pub(in crate::map) fn new(blocked: &BitGrid, transposed: &BitGrid) -> Self {
        let mut stops = Self {
            east: blocked.clone(),
            west: blocked.clone(),
            north: transposed.clone(),
            south: transposed.clone(),
            cramped: blocked.clone(),
        };
        let (width, height) = (blocked.width() as i32, blocked.height() as i32);
        stops.update(blocked, transposed, Cell::new(0, 0), Cell::new(width - 1, height - 1));
        stops
    }

    /// Updates the stops after blocked cells from `low` to `high` have changed.
    pub(in crate::map) fn update(
        &mut self,
        blocked: &BitGrid,
        transposed: &BitGrid,
        low: Cell,
        high: Cell,
    ) {
        update_rows(&mut self.east, &mut self.west, blocked, low, high);
        update_cramped(&mut self.cramped, blocked, low, high);
        let exchanged = |cell: Cell| Cell::new(cell.y, cell.x);
        let (low, high) = (exchanged(low), exchanged(high));
        update_rows(&mut self.north, &mut self.south, transposed, low, high);
    }
}

/// Recomputes the words of both directions along the rows that changed cells can influence: one
/// row and one column more on each side.
fn update_rows(up: &mut BitGrid, down: &mut BitGrid, blocked: &BitGrid, low: Cell, high: Cell) {
    let (rows, words) = influenced(blocked, low, high);
    for y in rows {
        let (below, own, above) = (blocked.row(y - 1), blocked.row(y), blocked.row(y + 1));
        for word in words.clone() {
            let own = own[word];
            let turns_up = opened_upwards(above, word) | opened_upwards(below, word);
            let turns_down = opened_downwards(above, word) | opened_downwards(below, word);
            up.set_word(y, word, own | turns_up);
            down.set_word(y, word, own | turns_down);
        }
    }
}

/// Like [`update_rows`], for the 2 x 2 cells.
fn update_cramped(cramped: &mut BitGrid, blocked: &BitGrid, low: Cell, high: Cell) {
    let (rows, words) = influenced(blocked, low, high);
    for y in rows {
        let (own, above) = (blocked.row(y), blocked.row(y + 1));
        for word in words.clone() {
            let either = |word: usize| own[word] | above[word];
            let next = if word + 1 < own.len() { either(word + 1) } else { 1 };
            cramped.set_word(y, word, either(word) | either(word) >> 1 | next << 63);
        }
    }
}

/// The rows, and the words in each, that changed cells can influence.
fn influenced(blocked: &BitGrid, low: Cell, high: Cell) -> (RangeInclusive<i32>, Range<usize>) {
    let rows = (low.y - 1).max(0)..=(high.y + 1).min(blocked.height() as i32 - 1);
    // Column x is bit x + 1, so the columns low - 1 and high + 1 are bits low and high + 2.
    let first = low.x.max(0) as usize / 64;
    let last = ((high.x + 2).max(0) as usize / 64).min(blocked.row(0).len() - 1);
    (rows, first..last + 1)
}

/// Bits of free cells whose neighbour one bit lower is blocked.
fn opened_upwards(row: &[u64], word: usize) -> u64 {
    lower_neighbours(row, word) & !row[word]
}

/// Bits of free cells whose neighbour one bit higher is blocked.
fn opened_downwards(row: &[u64], word: usize) -> u64 {
    higher_neighbours(row, word) & !row[word]
}

/// For each bit of a word, the bit before it in the row; that before the first one is set.
pub(super) fn lower_neighbours(row: &[u64], word: usize) -> u64 {
    row[word] << 1 | if word == 0 { 1 } else { row[word - 1] >> 63 }
}

/// For each bit of a word, the bit after it in the row; that after the last one is set.
pub(super) fn higher_neighbours(row: &[u64], word: usize) -> u64 {
    row[word] >> 1 | row.get(word + 1).map_or(1, |next| next & 1) << 63
}

#[cfg(test)]
mod tests {
    use crate::map::{Cell, CellState, Edit, LayerConfig, OccupancyGrid, SearchMap};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn stops_follow_the_rule(width in 1i32..140, occupied in prop::collection::vec((0i32..140, 0i32..4), 0..60),
                                 edits in prop::collection::vec((0i32..140, 0i32..4, any::<bool>()), 0..20)) {
            let frame = crate::map::GridFrame::new(width as u64, 4, 1.0, crate::geometry::Pose::default()).unwrap();
            let grid = OccupancyGrid::from_fn(frame, |cell| {
                if occupied.contains(&(cell.x, cell.y)) { CellState::Occupied } else { CellState::Free }
            });
            let mut map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
            let edits: Vec<Edit> = edits.into_iter().map(|(x, y, set)| Edit {
                cell: Cell::new(x, y),
                state: if set { CellState::Occupied } else { CellState::Free },
            }).collect();
            map.apply(&edits);
            let blocked = |x, y| !map.is_free(Cell::new(x, y));
            let opens = |x: i32, y: i32, dx: i32, dy: i32, sx: i32, sy: i32| {
                blocked(x - dx + sx, y - dy + sy) && !blocked(x + sx, y + sy)
            };
            for cell in frame.cells() {
                let Cell { x, y } = cell;
                let along = |dx, dy, sx, sy| {
                    blocked(x, y) || opens(x, y, dx, dy, sx, sy) || opens(x, y, dx, dy, -sx, -sy)
                };
                let stops = map.stops();
                let block = [(0, 0), (1, 0), (0, 1), (1, 1)];
                let cramped = block.iter().any(|&(dx, dy)| blocked(x + dx, y + dy));
                prop_assert_eq!(stops.cramped.get(cell), cramped, "cramped {}", cell);
                let turned = Cell::new(y, x);
                prop_assert_eq!(stops.east.get(cell), along(1, 0, 0, 1), "east {}", cell);
                prop_assert_eq!(stops.west.get(cell), along(-1, 0, 0, 1), "west {}", cell);
                prop_assert_eq!(stops.north.get(turned), along(0, 1, 1, 0), "north {}", cell);
                prop_assert_eq!(stops.south.get(turned), along(0, -1, 1, 0), "south {}", cell);
            }
        }
    }
}
