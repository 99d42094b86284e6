//! The cells where a walk along a diagonal has something to do.

use crate::map::{BitGrid, Cell, SearchMap};

/// For each of the four diagonal directions the cells from which a scan to one of its two sides
/// finds a jump point, and those from which no further diagonal step is free.
///
/// The bits of a diagonal lie side by side, in the order of the rows or, on a map that is taller
/// than wide, of the columns, so that a walk passes 64 cells without such a find at a time. The
/// four grids take at most a byte per cell together, more only where a map is narrower than 64
/// cells.
#[derive(Clone, Debug)]
pub(super) struct Diagonals {
    /// Towards north-east, north-west, south-west, south-east.
    stops: [BitGrid; 4],
    height: i32,
    is_tall: bool,
}

impl Diagonals {
    pub(super) fn new(map: &SearchMap) -> Self {
        let (width, height) = (map.frame().width(), map.frame().height());
        let empty = || BitGrid::new(width.min(height), width + height - 1, true);
        let mut diagonals = Self {
            stops: [empty(), empty(), empty(), empty()],
            height: height as i32,
            is_tall: height > width,
        };
        let finds = Finds::new(map);
        for cell in map.frame().cells() {
            for quarter in 0..4 {
                if finds.any_beside(cell, quarter) || !is_diagonal_free(map, cell, quarter) {
                    let place = Cell::new(diagonals.along(cell), diagonals.line(cell, quarter));
                    diagonals.stops[quarter].set(place, true);
                }
            }
        }
        diagonals
    }

    /// The number of steps to the next cell of a diagonal at which there is something to do. The
    /// first step must be free.
    pub(super) fn steps_to_stop(&self, from: Cell, quarter: usize) -> i32 {
        let row = self.stops[quarter].row(self.line(from, quarter));
        let at = (self.along(from) + 1) as usize;
        let is_up = if self.is_tall { quarter == 0 || quarter == 3 } else { quarter < 2 };
        let stop = super::sight::scan(row, at, is_up);
        stop.abs_diff(at) as i32
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.stops.iter().map(BitGrid::memory_bytes).sum()
    }

    /// The place of a cell on its diagonal.
    const fn along(&self, cell: Cell) -> i32 {
        if self.is_tall { cell.x } else { cell.y }
    }

    /// Which diagonal a cell lies on.
    fn line(&self, cell: Cell, quarter: usize) -> i32 {
        if quarter.is_multiple_of(2) { cell.x - cell.y + self.height - 1 } else { cell.x + cell.y }
    }
}

/// True if the 2 x 2 block of a diagonal step is free.
fn is_diagonal_free(map: &SearchMap, cell: Cell, quarter: usize) -> bool {
    let west = i32::from(quarter == 1 || quarter == 2);
    let south = i32::from(quarter >= 2);
    let low = Cell::new(cell.x - west, cell.y - south);
    // Beside the map all is blocked.
    low.x >= 0 && low.y >= 0 && !map.stops().cramped.get(low)
}

/// From which cells a straight scan finds a jump point, towards east, north, west, south.
struct Finds([BitGrid; 4]);

impl Finds {
    fn new(map: &SearchMap) -> Self {
        let stops = map.stops();
        let (rows, columns) = (map.blocked(), map.blocked_transposed());
        Self([
            finds(&stops.east, rows, true),
            finds(&stops.north, columns, true),
            finds(&stops.west, rows, false),
            finds(&stops.south, columns, false),
        ])
    }

    fn any_beside(&self, cell: Cell, quarter: usize) -> bool {
        [quarter, (quarter + 1) % 4].into_iter().any(|direction| {
            let is_row = direction.is_multiple_of(2);
            self.0[direction].get(if is_row { cell } else { Cell::new(cell.y, cell.x) })
        })
    }
}

/// For each cell whether the next stop in its row, towards larger columns or smaller ones, is free.
fn finds(stops: &BitGrid, blocked: &BitGrid, is_up: bool) -> BitGrid {
    let mut finds = BitGrid::new(stops.width(), stops.height(), false);
    let last = stops.width() as i32 - 1;
    for y in 0..stops.height() as i32 {
        let mut is_free = false;
        for i in 0..=last {
            let cell = Cell::new(if is_up { last - i } else { i }, y);
            if is_free {
                finds.set(cell, true);
            }
            if stops.get(cell) {
                is_free = !blocked.get(cell);
            }
        }
    }
    finds
}
