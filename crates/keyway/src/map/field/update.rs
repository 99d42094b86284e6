//! Updates of the field after changes in a window, limited to the affected cells.
//!
//! Every cell whose distance changes was nearest to an obstacle that has vanished, or is nearest
//! to one that has appeared. All such cells lie in a rectangle around these obstacles
//! ([`DistanceField::touched`]). Changes far apart have rectangles of their own; rectangles that
//! meet are joined. In each, distances are lowered to the new obstacles, or recomputed if some
//! have vanished or many are new.

use super::columns::ColumnRows;
use super::envelope::Envelope;
use super::followed_obstacles::RowScratch;
use super::touched::sources_beside;
use super::{CellWindow, DistanceField};
use crate::map::{BitGrid, Cell};

/// Side of the blocks by which changed cells are grouped \[cells\].
const BLOCK_CELLS: i32 = 64;
/// Number of columns beyond which recomputing distances is faster than lowering them; counts the
/// columns in which runs of new obstacles begin.
const FEW_COLUMNS: usize = 40;
/// Number of rows of a rectangle that are computed together.
const BAND_ROWS: usize = 64;

/// Obstacles that appear or vanish near each other, and the cells that they may change.
struct Change {
    cells: Vec<Cell>,
    /// The smallest window that holds them.
    window: CellWindow,
    /// Every cell whose distance may change.
    touched: CellWindow,
}

impl DistanceField {
    /// Copies the cells of a window from `obstacles`, and corrects every distance that they
    /// change, inside and outside the window: the field then equals one built from scratch.
    ///
    /// Returns a window outside which no cell has changed; `None` if no obstacle has changed.
    /// Cost: a few nanoseconds for each cell of that window. In open areas it is large; a
    /// [`FieldConfig::reach_m`](super::FieldConfig::reach_m) limits it.
    ///
    /// # Panics
    /// Panics if the grids differ in size.
    pub fn update(&mut self, obstacles: &BitGrid, window: CellWindow) -> Option<CellWindow> {
        self.assert_same_size(obstacles);
        let groups = groups(self.changed_cells(obstacles, window));
        let changes = groups.into_iter().map(|cells| self.change(cells));
        let changes = joined(changes.collect());
        for cell in changes.iter().flat_map(|change| &change.cells) {
            self.obstacles.set(*cell, obstacles.get(*cell));
        }
        for change in &changes {
            let is_new = |&cell| obstacles.get(cell);
            if change.cells.iter().all(is_new) && first_columns(&change.cells) <= FEW_COLUMNS {
                self.lower(change);
            } else {
                self.renew(change);
            }
        }
        changes.into_iter().map(|change| change.touched).reduce(|all, one| all.union(&one))
    }

    /// The cells of a window that differ from the field's obstacles.
    fn changed_cells(&self, obstacles: &BitGrid, window: CellWindow) -> Vec<Cell> {
        let mut cells = Vec::new();
        let map = self.map_window();
        let (from, to) = (window.low.x.max(0), window.high.x.min(map.high.x));
        if from > to {
            return cells;
        }
        for y in window.low.y.max(0)..=window.high.y.min(map.high.y) {
            // Column x is bit x + 1.
            for word in (from + 1) as usize / 64..=(to + 1) as usize / 64 {
                let mut changed = self.obstacles.row(y)[word] ^ obstacles.row(y)[word];
                while changed != 0 {
                    let x = (64 * word as u32 + changed.trailing_zeros()) as i32 - 1;
                    changed &= changed - 1;
                    if (from..=to).contains(&x) {
                        cells.push(Cell::new(x, y));
                    }
                }
            }
        }
        cells
    }

    fn change(&self, cells: Vec<Cell>) -> Change {
        let window = bounds(&cells);
        Change { touched: self.touched(&window), window, cells }
    }

    pub(super) fn map_window(&self) -> CellWindow {
        let high = Cell::new(self.frame.width() as i32 - 1, self.frame.height() as i32 - 1);
        CellWindow { low: Cell::new(0, 0), high }
    }

    const fn envelope(&self) -> Envelope {
        Envelope { to: self.to, limit_sq: self.limit_sq }
    }

    /// Index range of a window's cells in row `y` of the field.
    pub(super) fn part_of_row(&self, y: i32, window: &CellWindow) -> std::ops::Range<usize> {
        let start = self.row(y).start;
        start + window.low.x as usize..start + window.high.x as usize + 1
    }

    /// Lowers the distances of the touched cells to new obstacles.
    fn lower(&mut self, added: &Change) {
        let Change { window: CellWindow { low, high }, touched, .. } = added;
        let mut grid =
            BitGrid::new((high.x - low.x + 1) as u32, (high.y - low.y + 1) as u32, false);
        for cell in &added.cells {
            grid.set(Cell::new(cell.x - low.x, cell.y - low.y), true);
        }
        // One column more on both sides marks the end of the obstacles.
        let columns = CellWindow {
            low: Cell::new(low.x - 1, touched.low.y),
            high: Cell::new(high.x + 1, touched.high.y),
        };
        let columns = ColumnRows::of_grid(&grid, *low, columns);
        let offset = i64::from(low.x - 1 - touched.low.x);
        let (envelope, mut hull) = (self.envelope(), Vec::new());
        for y in touched.low.y..=touched.high.y {
            let part = self.part_of_row(y, touched);
            envelope.lower(columns.row(y), offset, &mut self.half_cells_sq[part], &mut hull);
        }
    }

    /// Recomputes the distances of the touched cells; those around them are correct.
    fn renew(&mut self, Change { touched, window: changed, .. }: &Change) {
        let sources = self.sources(touched);
        let (obstacles, envelope, stride) = (&self.obstacles, self.envelope(), self.stride);
        let rows = touched.low.y as usize * stride..(touched.high.y as usize + 1) * stride;
        let (mut columns, mut scratch) = (ColumnRows::default(), RowScratch::default());
        // On one thread: starting another one takes longer than most windows do, sometimes by
        // milliseconds.
        for (i, band) in self.half_cells_sq[rows].chunks_mut(BAND_ROWS * stride).enumerate() {
            let low = touched.low.y + (i * BAND_ROWS) as i32;
            let high = low + (band.len() / stride) as i32 - 1;
            let rows = || (low..).zip(band.chunks(stride));
            let own = envelope.may_change(rows(), touched, changed);
            let (left, right) = sources_beside(rows(), &own);
            let window = CellWindow {
                low: Cell::new(sources.low.x.max(left), low),
                high: Cell::new(sources.high.x.min(right), high),
            };
            columns.fill(obstacles, window, sources.low.y, sources.high.y);
            let first = window.low.x as usize;
            scratch.start();
            for (y, row) in (low..).zip(band.chunks_mut(stride)) {
                let seen = own.start - first..own.end - first;
                envelope.row(columns.row(y), seen, &mut row[own.clone()], &mut scratch);
            }
        }
    }
}

/// Number of columns in which runs of cells along a row begin.
fn first_columns(cells: &[Cell]) -> usize {
    let follows = |cell: Cell, before: Cell| (cell.x - 1, cell.y) == (before.x, before.y);
    let begins = |&i: &usize| i == 0 || !follows(cells[i], cells[i - 1]);
    let mut columns: Vec<i32> = (0..cells.len()).filter(begins).map(|i| cells[i].x).collect();
    columns.sort_unstable();
    columns.dedup();
    columns.len()
}

/// Groups cells that are near each other; one group if they are everywhere.
fn groups(cells: Vec<Cell>) -> Vec<Vec<Cell>> {
    if cells.is_empty() {
        return Vec::new();
    }
    let block = |cell: &Cell| (cell.x.div_euclid(BLOCK_CELLS), cell.y.div_euclid(BLOCK_CELLS));
    let CellWindow { low, high } = bounds(&cells);
    let (low, high) = (block(&low), block(&high));
    let (width, height) = ((high.0 - low.0 + 1) as usize, (high.1 - low.1 + 1) as usize);
    let place = |cell: &Cell| {
        let (x, y) = block(cell);
        (y - low.1) as usize * width + (x - low.0) as usize
    };
    let mut counts = vec![0_usize; width * height];
    for cell in &cells {
        counts[place(cell)] += 1;
    }
    if 2 * counts.iter().filter(|&&count| count > 0).count() > counts.len() {
        return vec![cells];
    }
    let mut groups: Vec<Vec<Cell>> = counts.into_iter().map(Vec::with_capacity).collect();
    for cell in cells {
        groups[place(&cell)].push(cell);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// The smallest window that holds the given cells, of which there is at least one.
fn bounds(cells: &[Cell]) -> CellWindow {
    let none =
        CellWindow { low: Cell::new(i32::MAX, i32::MAX), high: Cell::new(i32::MIN, i32::MIN) };
    let windows = cells.iter().map(|&cell| CellWindow { low: cell, high: cell });
    windows.fold(none, |all, one| all.union(&one))
}

/// Joins changes whose rectangles overlap or touch: around the resulting rectangles no distance
/// changes.
fn joined(changes: Vec<Change>) -> Vec<Change> {
    let mut apart: Vec<Change> = Vec::new();
    for mut change in changes {
        while let Some(i) = apart.iter().position(|other| meet(&other.touched, &change.touched)) {
            let other = apart.swap_remove(i);
            change.cells.extend(other.cells);
            change.window = change.window.union(&other.window);
            change.touched = change.touched.union(&other.touched);
        }
        apart.push(change);
    }
    apart
}

/// True if two rectangles share cells or have adjacent ones.
const fn meet(a: &CellWindow, b: &CellWindow) -> bool {
    a.low.x <= b.high.x + 1
        && b.low.x <= a.high.x + 1
        && a.low.y <= b.high.y + 1
        && b.low.y <= a.high.y + 1
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Random, config, frame, grids};
    use super::super::{DistanceTo, FieldConfig};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_new_obstacle_and_its_removal_by_hand() {
        // One row: # . . . . . #, then with an obstacle in the middle.
        let mut obstacles = BitGrid::new(7, 1, false);
        obstacles.set(Cell::new(0, 0), true);
        obstacles.set(Cell::new(6, 0), true);
        let mut field = DistanceField::new(&frame(7, 1), &obstacles, &FieldConfig::default());
        let before = field.clone();
        assert_eq!(field.half_cells_sq, [0, 1, 9, 25, 9, 1, 0]);
        let window = CellWindow { low: Cell::new(-3, -1), high: Cell::new(4, 9) };
        obstacles.set(Cell::new(3, 0), true);
        let changed = field.update(&obstacles, window);
        assert_eq!(field.half_cells_sq, [0, 1, 1, 0, 1, 1, 0]);
        assert!(changed.is_some_and(|window| window.contains(Cell::new(2, 0))));
        assert_eq!(field.update(&obstacles, window), None);
        obstacles.set(Cell::new(3, 0), false);
        field.update(&obstacles, window);
        assert!(field == before);
    }

    #[test]
    fn cells_outside_the_window_wait_for_theirs() {
        let empty = BitGrid::new(70, 9, false);
        let mut field = DistanceField::new(&frame(70, 9), &empty, &FieldConfig::default());
        let mut obstacles = empty.clone();
        obstacles.set(Cell::new(65, 8), true);
        obstacles.set(Cell::new(3, 1), true);
        let window = CellWindow { low: Cell::new(0, 0), high: Cell::new(64, 8) };
        field.update(&obstacles, window);
        assert!(field.obstacles().get(Cell::new(3, 1)) && !field.obstacles().get(Cell::new(65, 8)));
        assert_eq!(field.distance_m(Cell::new(69, 1)), Some(65.5));
    }

    #[test]
    fn what_vanishes_with_its_neighbour_leaves_the_next_one_nearest() {
        // Each of the two is the only obstacle near the other's part of the row.
        let mut obstacles = BitGrid::new(400, 1, false);
        for x in [10, 200, 399] {
            obstacles.set(Cell::new(x, 0), true);
        }
        let mut field = DistanceField::new(&frame(400, 1), &obstacles, &FieldConfig::default());
        for x in [10, 200] {
            obstacles.set(Cell::new(x, 0), false);
        }
        field.update(&obstacles, field.map_window());
        assert_eq!(field.distance_m(Cell::new(0, 0)), Some(398.5));
        assert_eq!(field.distance_m(Cell::new(110, 0)), Some(288.5));
    }

    proptest! {
        #[test]
        fn an_update_is_a_full_recomputation(obstacles in grids(), seed: u64, centres: bool,
                                             reach_m in prop_oneof![Just(f64::INFINITY), 0.0..30.0f64],
                                             density in 0.0..1.0f64) {
            let to = if centres { DistanceTo::Centres } else { DistanceTo::Squares };
            let frame = frame(obstacles.width(), obstacles.height());
            let config = config(to, reach_m);
            let mut field = DistanceField::new(&frame, &obstacles, &config);
            let (mut obstacles, mut random) = (obstacles, Random(seed | 1));
            for round in 0..6 {
                let before = field.clone();
                let window = random.window(&obstacles);
                let value = random.fraction() < 0.5;
                let share = density * [1.0, 0.1, 0.01][round % 3];
                for y in window.low.y..=window.high.y {
                    for x in window.low.x..=window.high.x {
                        if random.fraction() < share {
                            obstacles.set(Cell::new(x, y), value);
                        }
                    }
                }
                let changed = field.update(&obstacles, window);
                let anew = DistanceField::new(&frame, &obstacles, &config);
                prop_assert!(field == anew, "{:?} {:?}", window, changed);
                for cell in frame.cells() {
                    let inside = changed.is_some_and(|window| window.contains(cell));
                    prop_assert!(inside || field.half_cells_sq(cell) == before.half_cells_sq(cell));
                }
            }
        }

        #[test]
        fn changes_in_several_places_are_a_full_recomputation(
            seed: u64, scattered in 0..60, places in 2..5, spread in 20..200,
            reach_m in prop_oneof![Just(f64::INFINITY), 5.0..60.0f64],
        ) {
            let (frame, mut random) = (frame(330, 300), Random(seed | 1));
            let mut obstacles = BitGrid::new(330, 300, false);
            let mut at = |low: Cell, side: i32| {
                let along = |fraction: f64| (fraction * f64::from(side)) as i32;
                Cell::new(low.x + along(random.fraction()), low.y + along(random.fraction()))
            };
            for _ in 0..scattered {
                obstacles.set(at(Cell::new(0, 0), 330), true);
            }
            let config = config(DistanceTo::Squares, reach_m);
            let mut field = DistanceField::new(&frame, &obstacles, &config);
            let all = CellWindow { low: Cell::new(0, 0), high: Cell::new(329, 299) };
            let low = at(Cell::new(0, 0), 200);
            // Obstacles that have appeared vanish when other cells appear.
            let mut standing: Vec<Cell> = Vec::new();
            for _ in 0..3 {
                for cell in std::mem::take(&mut standing) {
                    obstacles.set(cell, false);
                }
                for _ in 0..places {
                    let cell = at(low, spread);
                    obstacles.set(cell, true);
                    standing.push(cell);
                }
                field.update(&obstacles, all);
                let anew = DistanceField::new(&frame, &obstacles, &config);
                prop_assert!(field == anew);
            }
        }
    }
}
