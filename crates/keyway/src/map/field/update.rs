//! What a changed window changes in the field, and nothing else.
//!
//! Removed obstacles first: the cells that were nearest to one of them get their distance anew. Then
//! new obstacles: distances are lowered to theirs. In both cases all such cells lie in a rectangle
//! around the obstacles whose rim none of them reaches; see [`DistanceField::touched`].

use super::bands::step;
use super::envelope::{Envelope, FAR_ROWS, Parabola};
use super::{CellWindow, DistanceField};
use crate::map::{BitGrid, Cell};
use std::ops::RangeInclusive;

/// Obstacles that appear or vanish together.
struct Change {
    /// The smallest window that holds them.
    window: CellWindow,
    /// The obstacles; cell (0, 0) is the window's lower left one.
    cells: BitGrid,
}

/// Cells of one row, both ends included.
struct Run {
    y: i32,
    first: i32,
    last: i32,
}

/// For every cell of a rectangle, rows to the nearest obstacle of its column, at most [`FAR_ROWS`].
struct ColumnRows {
    window: CellWindow,
    rows: Vec<i16>,
}

impl DistanceField {
    /// Takes over the cells of a window from `obstacles`, and corrects every distance that they
    /// change, inside and outside the window: the field is then the same as one computed anew.
    ///
    /// Tells a window of cells outside of which nothing has changed; `None` when no obstacle has
    /// changed. Cost: a few nanoseconds for each cell of that window. On open ground it is large; a
    /// [`FieldConfig::reach_m`](super::FieldConfig::reach_m) limits it.
    ///
    /// # Panics
    /// When the grids differ in size.
    pub fn update(&mut self, obstacles: &BitGrid, window: CellWindow) -> Option<CellWindow> {
        self.assert_same_size(obstacles);
        let (added, removed) = self.changes(obstacles, window);
        let mut touched: Vec<CellWindow> = Vec::new();
        let mut hull = Vec::new();
        for removed in Change::groups(removed) {
            touched.push(self.touched(&removed.window));
            removed.write(&mut self.obstacles, false);
            self.raise(&removed, &touched[touched.len() - 1], &mut hull);
        }
        for added in Change::groups(added) {
            touched.push(self.touched(&added.window));
            added.write(&mut self.obstacles, true);
            self.lower(&added, &touched[touched.len() - 1], &mut hull);
        }
        touched.into_iter().reduce(|all, one| all.union(&one))
    }

    /// Obstacles that `obstacles` has more and less than the field, within a window.
    fn changes(&self, obstacles: &BitGrid, window: CellWindow) -> (Vec<Cell>, Vec<Cell>) {
        let (mut added, mut removed) = (Vec::new(), Vec::new());
        let map = self.map_window();
        let (from, to) = (window.low.x.max(0), window.high.x.min(map.high.x));
        if from > to {
            return (added, removed);
        }
        for y in window.low.y.max(0)..=window.high.y.min(map.high.y) {
            // Column x is bit x + 1.
            for word in (from + 1) as usize / 64..=(to + 1) as usize / 64 {
                let now = obstacles.row(y)[word];
                let mut changed = self.obstacles.row(y)[word] ^ now;
                while changed != 0 {
                    let bit = changed.trailing_zeros();
                    changed &= changed - 1;
                    let x = (64 * word as u32 + bit) as i32 - 1;
                    if (from..=to).contains(&x) {
                        let list = if now >> bit & 1 == 1 { &mut added } else { &mut removed };
                        list.push(Cell::new(x, y));
                    }
                }
            }
        }
        (added, removed)
    }

    fn map_window(&self) -> CellWindow {
        let high = Cell::new(self.frame.width() as i32 - 1, self.frame.height() as i32 - 1);
        CellWindow { low: Cell::new(0, 0), high }
    }

    /// A rectangle around obstacles that holds every cell to which one of them is nearest.
    ///
    /// It grows until its rim holds no cell nearer to them, by less than one cell, than to what is
    /// nearest: on the way from an obstacle to a cell that it is nearest to it is nearest everywhere,
    /// and where that way crosses the rim, half a cell from some centre, its distance and the
    /// nearest one there differ by at most twice that half.
    fn touched(&self, obstacles: &CellWindow) -> CellWindow {
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

    const fn envelope(&self) -> Envelope {
        Envelope { to: self.to, limit_sq: self.limit_sq }
    }

    /// Some columns of row `y` of the field.
    fn part_of_row(&self, y: i32, columns: RangeInclusive<i32>) -> std::ops::Range<usize> {
        let start = self.row(y).start;
        start + *columns.start() as usize..start + *columns.end() as usize + 1
    }

    /// Lowers the distances of the touched cells to the new obstacles.
    fn lower(&mut self, added: &Change, touched: &CellWindow, hull: &mut Vec<Parabola>) {
        let rows = ColumnRows::of_change(added, touched);
        let offset = i64::from(rows.window.low.x - touched.low.x);
        let envelope = self.envelope();
        for y in touched.low.y..=touched.high.y {
            let part = self.part_of_row(y, touched.low.x..=touched.high.x);
            envelope.lower(rows.row(y), offset, &mut self.half_cells_sq[part], hull);
        }
    }

    /// Computes the distances anew of the touched cells to which a removed obstacle was nearest.
    fn raise(&mut self, removed: &Change, touched: &CellWindow, hull: &mut Vec<Parabola>) {
        let runs = self.nearest_to(removed, touched, hull);
        let windows = runs.iter().map(|run| self.sources(run));
        let Some(sources) = windows.reduce(|all, one| all.union(&one)) else {
            return;
        };
        let sources = sources.clipped(&self.map_window());
        let rows = ColumnRows::new(&self.obstacles, Cell::new(0, 0), sources);
        let envelope = self.envelope();
        for run in &runs {
            let part = self.part_of_row(run.y, run.first..=run.last);
            let out = &mut self.half_cells_sq[part];
            let first = (run.first - sources.low.x) as usize;
            let own = first..first + out.len();
            envelope.lower_part(rows.row(run.y), own, out, hull);
        }
    }

    /// The touched cells to which one of some obstacles is nearest, as one run for each row.
    fn nearest_to(
        &self,
        obstacles: &Change,
        touched: &CellWindow,
        hull: &mut Vec<Parabola>,
    ) -> Vec<Run> {
        let rows = ColumnRows::of_change(obstacles, touched);
        let offset = i64::from(rows.window.low.x - touched.low.x);
        let mut distances = vec![0; (touched.high.x - touched.low.x + 1) as usize];
        let runs = (touched.low.y..=touched.high.y).filter_map(|y| {
            distances.fill(self.limit_sq);
            self.envelope().lower(rows.row(y), offset, &mut distances, hull);
            let part = self.part_of_row(y, touched.low.x..=touched.high.x);
            let is_nearest = |(now, own): (&i32, &i32)| now == own && *now < self.limit_sq;
            let mut pairs = self.half_cells_sq[part].iter().zip(&distances);
            let first = pairs.position(is_nearest)? as i32;
            let last = pairs.rposition(is_nearest).map_or(first, |n| first + 1 + n as i32);
            Some(Run { y, first: touched.low.x + first, last: touched.low.x + last })
        });
        runs.collect()
    }

    /// A rectangle that holds the nearest obstacles of a run whose neighbours keep their distances:
    /// no distance differs from another's by more than the way between them.
    fn sources(&self, run: &Run) -> CellWindow {
        // Half a cell more to an obstacle's centre, and one for rounding.
        let cells = |half_cells_sq: i32| (0.5 * f64::from(half_cells_sq).sqrt()) as i32 + 2;
        let limit = cells(self.limit_sq);
        let neighbour = |x: i32| {
            let cell = Cell::new(x, run.y);
            self.frame.contains(cell).then(|| cells(self.half_cells_sq[self.index(cell)]))
        };
        let (left, right) = (neighbour(run.first - 1), neighbour(run.last + 1));
        let length = run.last - run.first + 2;
        let across = match (left, right) {
            (Some(left), Some(right)) => (left + right + length) / 2 + 1,
            (Some(one), None) | (None, Some(one)) => one + length,
            (None, None) => limit,
        };
        let across = across.min(limit);
        CellWindow {
            low: Cell::new(run.first - left.unwrap_or(0) - 1, run.y - across),
            high: Cell::new(run.last + right.unwrap_or(0) + 1, run.y + across),
        }
    }
}

impl Change {
    /// Cells of blocks of this side are taken together: what changes in two places of a window is
    /// mostly nothing to each other.
    const BLOCK_CELLS: i32 = 64;
    /// More cells than this are one change: much that stands between them is part of it.
    const MANY_CELLS: usize = 512;

    /// The changes of a list of cells.
    fn groups(mut cells: Vec<Cell>) -> Vec<Self> {
        let many = cells.len() > Self::MANY_CELLS;
        let block = |cell: &Cell| {
            let along = |n: i32| if many { 0 } else { n.div_euclid(Self::BLOCK_CELLS) };
            (along(cell.y), along(cell.x))
        };
        cells.sort_by_key(block);
        cells.chunk_by(|a, b| block(a) == block(b)).map(Self::new).collect()
    }

    fn new(cells: &[Cell]) -> Self {
        let none =
            CellWindow { low: Cell::new(i32::MAX, i32::MAX), high: Cell::new(i32::MIN, i32::MIN) };
        let windows = cells.iter().map(|&cell| CellWindow { low: cell, high: cell });
        let window = windows.fold(none, |all, one| all.union(&one));
        let CellWindow { low, high } = window;
        let (width, height) = (high.x - low.x + 1, high.y - low.y + 1);
        let mut grid = BitGrid::new(width as u32, height as u32, false);
        for cell in cells {
            grid.set(Cell::new(cell.x - low.x, cell.y - low.y), true);
        }
        Self { window, cells: grid }
    }

    fn write(&self, obstacles: &mut BitGrid, value: bool) {
        for y in 0..self.cells.height() as i32 {
            for x in self.cells.ones_in_span(y, 0, i32::MAX) {
                let low = self.window.low;
                obstacles.set(Cell::new(low.x + x, low.y + y), value);
            }
        }
    }
}

impl ColumnRows {
    /// Rows to changed obstacles, for the touched rows and the obstacles' columns; one column more
    /// on both sides tells that they end there.
    fn of_change(change: &Change, touched: &CellWindow) -> Self {
        let window = CellWindow {
            low: Cell::new(change.window.low.x - 1, touched.low.y),
            high: Cell::new(change.window.high.x + 1, touched.high.y),
        };
        Self::new(&change.cells, change.window.low, window)
    }

    /// Rows to the obstacles of a grid whose cell (0, 0) is `origin`, seen from a window.
    fn new(grid: &BitGrid, origin: Cell, window: CellWindow) -> Self {
        let width = (window.high.x - window.low.x + 1) as usize;
        let first = window.low.x - origin.x;
        let mut rows = vec![0; width * (window.high.y - window.low.y + 1) as usize];
        let mut nearest = vec![FAR_ROWS; width];
        for (y, row) in (window.low.y - origin.y..).zip(rows.chunks_mut(width)) {
            step(&mut nearest);
            for x in grid.ones_in_span(y, first, first + width as i32 - 1) {
                nearest[(x - first) as usize] = 0;
            }
            row.copy_from_slice(&nearest);
        }
        nearest.fill(FAR_ROWS);
        for row in rows.chunks_mut(width).rev() {
            step(&mut nearest);
            for (rows, nearest) in row.iter_mut().zip(&mut nearest) {
                *nearest = (*nearest).min(*rows);
                *rows = *nearest;
            }
        }
        Self { window, rows }
    }

    fn row(&self, y: i32) -> &[i16] {
        let width = (self.window.high.x - self.window.low.x + 1) as usize;
        let start = (y - self.window.low.y) as usize * width;
        &self.rows[start..start + width]
    }
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
    }
}
