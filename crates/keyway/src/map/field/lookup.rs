//! Queries of a field: distances at cells, bounds at points.

use super::{DistanceField, DistanceTo};
use crate::geometry::Point;
use crate::map::{Cell, Clearance};
use std::f64::consts::FRAC_1_SQRT_2;

impl DistanceField {
    /// Exact distances from points and lines to the same obstacles.
    pub const fn clearance(&self) -> Clearance<'_> {
        Clearance::new(&self.frame, &self.obstacles)
    }

    /// Distance from a cell's centre to the nearest obstacle \[m\]: 0 in an obstacle cell;
    /// infinite if none lies within [`Self::reach_m`]; `None` outside the map.
    pub fn distance_m(&self, cell: Cell) -> Option<f64> {
        let half_cells_sq = self.half_cells_sq(cell)?;
        Some(self.within_reach_m(half_cells_sq).unwrap_or(f64::INFINITY))
    }

    /// Squared distance of a cell, in half cells: exact. [`Self::limit_half_cells_sq`] if no
    /// obstacle lies within reach; `None` outside the map.
    pub(crate) fn half_cells_sq(&self, cell: Cell) -> Option<u32> {
        self.frame.contains(cell).then(|| self.half_cells_sq[self.index(cell)] as u32)
    }

    /// Squared distances of row `y` in half cells, from left to right, as stored; `None` if the
    /// map has no such row.
    pub(crate) fn row_squares(&self, y: i32) -> Option<&[i32]> {
        let is_there = (0..self.frame.height() as i32).contains(&y);
        is_there.then(|| &self.half_cells_sq[self.row(y)])
    }

    /// The value stored for every distance beyond the reach, in half cells squared.
    pub const fn limit_half_cells_sq(&self) -> u32 {
        self.limit_sq as u32
    }

    /// Distance from which on values are not distinguished \[m\].
    pub fn reach_m(&self) -> f64 {
        self.metres(self.limit_half_cells_sq())
    }

    /// Lower bound of the distance from a point to the nearest obstacle \[m\]: at most a cell's
    /// diagonal less than the true one, and never more than [`Self::reach_m`]. Outside the map,
    /// or for a position that is not finite, it is lower still, and never negative.
    ///
    /// Between two points the distance changes by no more than their distance from each other:
    /// the bound is the nearest centre's distance minus the distance to that centre.
    pub fn lower_bound_m(&self, point: Point) -> f64 {
        self.bounds_on_grid(self.frame.grid_from_world(point)).0 * self.frame.resolution_m()
    }

    /// Upper bound of the distance from a point to the nearest obstacle \[m\]; infinite if none
    /// lies within reach.
    pub fn upper_bound_m(&self, point: Point) -> f64 {
        self.bounds_on_grid(self.frame.grid_from_world(point)).1 * self.frame.resolution_m()
    }

    /// Bounds of the distance from a point to the nearest obstacle *square* \[m\], for either
    /// definition of the field's distances.
    pub(crate) fn square_bounds_m(&self, point: Point) -> (f64, f64) {
        let (lower, upper) = self.square_bounds_on_grid(self.frame.grid_from_world(point));
        (lower * self.frame.resolution_m(), upper * self.frame.resolution_m())
    }

    /// Like [`Self::square_bounds_m`], at a point in grid coordinates \[cells\].
    #[inline]
    pub(crate) fn square_bounds_on_grid(&self, grid: Point) -> (f64, f64) {
        let (lower, upper) = self.bounds_on_grid(grid);
        match self.to {
            DistanceTo::Squares => (lower, upper),
            // No point of a square is farther from its centre than half its diagonal.
            DistanceTo::Centres => ((lower - FRAC_1_SQRT_2).max(0.0), upper),
        }
    }

    /// True only if no obstacle square is nearer than `distance` to a point inside the map, in
    /// grid coordinates \[cells\]: one load and no root. False if one might be.
    #[inline]
    pub(crate) fn is_beyond(&self, grid: Point, distance: f64) -> bool {
        // Largest distance from a cell's centre to its points, and from a square's border to its
        // centre: half a diagonal each.
        let slack = match self.to {
            DistanceTo::Squares => FRAC_1_SQRT_2,
            DistanceTo::Centres => 2.0 * FRAC_1_SQRT_2,
        };
        let least = 2.0 * (distance + (slack + 1e-9));
        f64::from(self.half_cells_sq[self.index(self.nearest_cell(grid))]) >= least * least
    }

    /// The cell that contains a point in grid coordinates, or the one nearest to it.
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
