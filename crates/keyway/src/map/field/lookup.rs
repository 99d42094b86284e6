//! What a field answers: distances at cells, bounds at points.

use super::{DistanceField, DistanceTo};
use crate::geometry::Point;
use crate::map::{Cell, Clearance};
use std::f64::consts::FRAC_1_SQRT_2;

impl DistanceField {
    /// Exact distances from points and lines to the same obstacles.
    pub const fn clearance(&self) -> Clearance<'_> {
        Clearance::new(&self.frame, &self.obstacles)
    }

    /// Distance from a cell's centre to the nearest obstacle \[m\]: 0 in an obstacle cell; infinite
    /// where none lies within [`Self::reach_m`]; `None` outside the map.
    pub fn distance_m(&self, cell: Cell) -> Option<f64> {
        let half_cells_sq = self.half_cells_sq(cell)?;
        Some(self.within_reach_m(half_cells_sq).unwrap_or(f64::INFINITY))
    }

    /// The square of a cell's distance, in half cells: exact. [`Self::limit_half_cells_sq`] where
    /// no obstacle lies within reach; `None` outside the map.
    pub(crate) fn half_cells_sq(&self, cell: Cell) -> Option<u32> {
        self.frame.contains(cell).then(|| self.half_cells_sq[self.index(cell)] as u32)
    }

    /// The squared distances of row `y` in half cells, from left to right, in memory; `None` where
    /// the map has no such row.
    pub(crate) fn row_squares(&self, y: i32) -> Option<&[i32]> {
        let is_there = (0..self.frame.height() as i32).contains(&y);
        is_there.then(|| &self.half_cells_sq[self.row(y)])
    }

    /// What stands for every distance beyond the reach, in half cells squared.
    pub const fn limit_half_cells_sq(&self) -> u32 {
        self.limit_sq as u32
    }

    /// Distances of this and more are not told apart \[m\].
    pub fn reach_m(&self) -> f64 {
        self.metres(self.limit_half_cells_sq())
    }

    /// A lower bound of the distance from a point to the nearest obstacle \[m\]: at most half a
    /// cell's diagonal less than the true one (and at most [`Self::reach_m`] less that). Outside
    /// the map, or for a position that is not finite, it is lower still, and never negative.
    ///
    /// Between two points the distance changes by no more than the way from one to the other: this
    /// is the nearest centre's distance less the way to that centre.
    pub fn lower_bound_m(&self, point: Point) -> f64 {
        self.bounds_on_grid(self.frame.grid_from_world(point)).0 * self.frame.resolution_m()
    }

    /// An upper bound of the distance from a point to the nearest obstacle \[m\]; infinite where
    /// none lies within reach.
    pub fn upper_bound_m(&self, point: Point) -> f64 {
        self.bounds_on_grid(self.frame.grid_from_world(point)).1 * self.frame.resolution_m()
    }

    /// Bounds of the distance from a point to the nearest obstacle *square* \[m\], whatever the
    /// field's distances are measured to.
    pub(crate) fn square_bounds_m(&self, point: Point) -> (f64, f64) {
        let (lower, upper) = self.square_bounds_on_grid(self.frame.grid_from_world(point));
        (lower * self.frame.resolution_m(), upper * self.frame.resolution_m())
    }

    /// The same at a point in grid coordinates \[cells\].
    #[inline]
    pub(crate) fn square_bounds_on_grid(&self, grid: Point) -> (f64, f64) {
        let (lower, upper) = self.bounds_on_grid(grid);
        match self.to {
            DistanceTo::Squares => (lower, upper),
            // No point of a square is farther from its centre than half its diagonal.
            DistanceTo::Centres => ((lower - FRAC_1_SQRT_2).max(0.0), upper),
        }
    }

    /// True only when no obstacle square is nearer than `distance` to a point inside the map, in
    /// grid coordinates \[cells\]: one load and no root. False where it might be.
    #[inline]
    pub(crate) fn is_beyond(&self, grid: Point, distance: f64) -> bool {
        // No point of a cell is farther from its centre than half a diagonal, nor a square's centre
        // from its border.
        let slack = match self.to {
            DistanceTo::Squares => FRAC_1_SQRT_2,
            DistanceTo::Centres => 2.0 * FRAC_1_SQRT_2,
        };
        let least = 2.0 * (distance + (slack + 1e-9));
        f64::from(self.half_cells_sq[self.index(self.nearest_cell(grid))]) >= least * least
    }

    /// The cell that holds a point in grid coordinates, or the one nearest to it.
    #[inline]
    pub(crate) fn nearest_cell(&self, grid: Point) -> Cell {
        let nearest = |value: f64, count: u32| (value as i32).clamp(0, count as i32 - 1);
        Cell::new(nearest(grid.x, self.frame.width()), nearest(grid.y, self.frame.height()))
    }

    /// Both bounds at a point in grid coordinates \[cells\].
    #[inline]
    fn bounds_on_grid(&self, grid: Point) -> (f64, f64) {
        let cell = self.nearest_cell(grid);
        let centre = Point::new(f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5);
        let offset = grid.distance(centre);
        let half_cells_sq = self.half_cells_sq[self.index(cell)];
        let distance = 0.5 * f64::from(half_cells_sq).sqrt();
        let upper = if half_cells_sq < self.limit_sq { distance + offset } else { f64::INFINITY };
        // A NaN fails the comparison and gives 0.
        ((distance - offset).max(0.0), upper)
    }

    fn within_reach_m(&self, half_cells_sq: u32) -> Option<f64> {
        (half_cells_sq < self.limit_half_cells_sq()).then(|| self.metres(half_cells_sq))
    }

    fn metres(&self, half_cells_sq: u32) -> f64 {
        f64::from(half_cells_sq).sqrt() * (0.5 * self.frame.resolution_m())
    }

    pub(super) const fn index(&self, cell: Cell) -> usize {
        cell.y as usize * self.stride + cell.x as usize
    }
}
