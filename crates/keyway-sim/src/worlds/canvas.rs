//! Canvas for patterns.

use keyway::geometry::Point;
use keyway::map::{BitGrid, Cell, CellState, GridFrame, OccupancyGrid};

/// Cells of a map, addressed in metres from its lower left corner.
pub(super) struct Canvas {
    frame: GridFrame,
    occupied: BitGrid,
}

impl Canvas {
    /// An empty canvas.
    pub(super) fn new(frame: GridFrame) -> Self {
        Self { occupied: BitGrid::new(frame.width(), frame.height(), false), frame }
    }

    /// Width and height \[m\].
    pub(super) fn size_m(&self) -> [f64; 2] {
        [self.frame.width(), self.frame.height()].map(|n| f64::from(n) * self.frame.resolution_m())
    }

    /// Side of a cell \[m\].
    pub(super) const fn cell_m(&self) -> f64 {
        self.frame.resolution_m()
    }

    /// Occupies the cells whose centres lie in a box.
    pub(super) fn fill_box(&mut self, low: Point, high: Point) {
        self.set_cells(low, high, true, |_| true);
    }

    /// Frees the cells whose centres lie in a box.
    pub(super) fn clear_box(&mut self, low: Point, high: Point) {
        self.set_cells(low, high, false, |_| true);
    }

    /// Occupies a rectangle of cells, given by its lower left cell; returns the number of cells
    /// that were free. Cells outside the map are ignored.
    pub(super) fn fill_cells(&mut self, low: Cell, width: i32, height: i32) -> u64 {
        let right = (low.x + width).min(self.frame.width() as i32);
        let top = (low.y + height).min(self.frame.height() as i32);
        let cells = (low.y..top).flat_map(|y| (low.x..right).map(move |x| Cell::new(x, y)));
        let mut filled = 0;
        for cell in cells {
            filled += u64::from(!self.occupied.get(cell));
            self.occupied.set(cell, true);
        }
        filled
    }

    /// Width and height \[cells\].
    pub(super) const fn size_cells(&self) -> [u32; 2] {
        [self.frame.width(), self.frame.height()]
    }

    /// Occupies the cells whose centres lie in a disc.
    pub(super) fn fill_disc(&mut self, centre: Point, radius_m: f64) {
        self.set_disc(centre, radius_m, true);
    }

    /// Frees the cells that are closer than a radius to a position.
    pub(super) fn clear_disc(&mut self, centre: Point, radius_m: f64) {
        let half_diagonal_m = std::f64::consts::FRAC_1_SQRT_2 * self.cell_m();
        self.set_disc(centre, radius_m + half_diagonal_m, false);
    }

    /// Occupies the cells whose centres satisfy a rule.
    pub(super) fn fill_where(&mut self, is_occupied: impl Fn(Point) -> bool) {
        let [width_m, height_m] = self.size_m();
        self.set_cells(Point::default(), Point::new(width_m, height_m), true, is_occupied);
    }

    pub(super) fn into_grid(self) -> OccupancyGrid {
        OccupancyGrid::from_fn(self.frame, |cell| {
            if self.occupied.get(cell) { CellState::Occupied } else { CellState::Free }
        })
    }

    fn set_disc(&mut self, centre: Point, radius_m: f64, value: bool) {
        let reach = Point::new(radius_m, radius_m);
        let is_inside = |at: Point| at.distance(centre) <= radius_m;
        self.set_cells(centre - reach, centre + reach, value, is_inside);
    }

    fn set_cells(&mut self, low: Point, high: Point, value: bool, is_in: impl Fn(Point) -> bool) {
        let cell_m = self.cell_m();
        // The centre of a cell is half a cell from its lower left corner.
        let first = |at_m: f64| (at_m / cell_m - 0.5 - 1e-9).ceil().max(0.0) as i32;
        let last = |at_m: f64, count: u32| {
            (at_m / cell_m - 0.5 + 1e-9).floor().min(f64::from(count) - 1.0) as i32
        };
        for y in first(low.y)..=last(high.y, self.frame.height()) {
            for x in first(low.x)..=last(high.x, self.frame.width()) {
                let centre = Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5) * cell_m;
                if is_in(centre) {
                    self.occupied.set(Cell::new(x, y), value);
                }
            }
        }
    }
}
