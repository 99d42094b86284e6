//! Free cells near a given cell.

use crate::map::{Cell, Connectivity, SearchMap};

impl SearchMap {
    /// The free cell whose centre is nearest to `cell`'s centre (ties: lower row, then lower
    /// column); a cell outside the map is replaced by the nearest cell of the map. `None` if
    /// every cell is blocked. The cost is proportional to the number of cells within the
    /// distance.
    pub fn nearest_free(&self, cell: Cell) -> Option<Cell> {
        let (width, height) = (self.frame().width() as i32, self.frame().height() as i32);
        let cell = self.clamped(cell);
        let mut best: Option<(i64, Cell)> = None;
        for ring in 0..width.max(height) {
            if best.is_some_and(|(distance_sq, _)| i64::from(ring).pow(2) > distance_sq) {
                break;
            }
            for candidate in self.ring_cells(cell, ring).filter(|&c| self.is_free(c)) {
                let (dx, dy) = (i64::from(candidate.x - cell.x), i64::from(candidate.y - cell.y));
                let key = (dx * dx + dy * dy, (candidate.y, candidate.x));
                if best.is_none_or(|(d, c)| key < (d, (c.y, c.x))) {
                    best = Some((key.0, candidate));
                }
            }
        }
        best.map(|(_, cell)| cell)
    }

    /// The cells of the map at Chebyshev distance `ring` from one of its cells.
    fn ring_cells(&self, centre: Cell, ring: i32) -> impl Iterator<Item = Cell> {
        let (width, height) = (self.frame().width() as i32, self.frame().height() as i32);
        let sides = move |at: i32, count: i32| {
            let both = [at - ring, at + ring];
            let kept = both.into_iter().take(if ring == 0 { 1 } else { 2 });
            kept.filter(move |&side| side >= 0 && side < count)
        };
        let columns = (centre.x - ring).max(0)..=(centre.x + ring).min(width - 1);
        let rows = (centre.y - ring + 1).max(0)..=(centre.y + ring - 1).min(height - 1);
        let in_rows = sides(centre.y, height)
            .flat_map(move |y| columns.clone().map(move |x| Cell::new(x, y)));
        let in_columns =
            sides(centre.x, width).flat_map(move |x| rows.clone().map(move |y| Cell::new(x, y)));
        in_rows.chain(in_columns)
    }

    /// The number of a free cell's component (see [`Self::components`]); `None` for other cells.
    pub fn component(&self, cell: Cell, connectivity: Connectivity) -> Option<u32> {
        self.is_free(cell).then(|| self.components(connectivity).of_free(cell))
    }

    /// The cell reachable from `from` whose centre is nearest to `to`'s centre (ties: lower row,
    /// then lower column); a cell `to` outside the map is replaced by the nearest cell of the
    /// map. `None` if `from` is blocked. Costs a few operations for each run of free cells within
    /// the distance.
    pub fn nearest_connected(
        &self,
        from: Cell,
        to: Cell,
        connectivity: Connectivity,
    ) -> Option<Cell> {
        let component = self.component(from, connectivity)?;
        self.nearest_of_component(component, to, connectivity)
    }

    /// Like [`Self::nearest_connected`], for a component given by its number; `None` if no
    /// component has that number.
    pub fn nearest_of_component(
        &self,
        component: u32,
        to: Cell,
        connectivity: Connectivity,
    ) -> Option<Cell> {
        let to = self.clamped(to);
        self.components(connectivity).nearest(self.blocked(), component, to)
    }

    /// The cell of the map that is nearest to a cell.
    fn clamped(&self, cell: Cell) -> Cell {
        let (width, height) = (self.frame().width() as i32, self.frame().height() as i32);
        Cell::new(cell.x.clamp(0, width - 1), cell.y.clamp(0, height - 1))
    }
}
