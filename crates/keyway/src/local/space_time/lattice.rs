//! A grid of numbers around the robot, with values in between.

use crate::geometry::Point;
use crate::map::{Cell, GridFrame};

/// Points around the robot: the centres of every `stride`-th cell of the map, in every `stride`-th row. Positions are
/// in metres along the axes of the map's cells, from the corner of the map at its origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lattice {
    /// The cell of the first point.
    low: (i32, i32),
    stride: i32,
    /// Side of a cell of the map \[m\].
    cell_m: f64,
    /// Points in a row, and in a column.
    pub(super) side: usize,
    /// One over the distance of two points \[1/m\].
    per_m: f64,
}

impl Lattice {
    /// All points up to `reach_m` from a position, `spacing_m` apart or the next smaller multiple of a cell, at least one.
    pub(super) fn around(frame: &GridFrame, at: Point, reach_m: f64, spacing_m: f64) -> Self {
        let cell_m = frame.resolution_m();
        let stride = ((spacing_m / cell_m) as i32).max(1);
        let spacing_m = f64::from(stride) * cell_m;
        let half = (reach_m / spacing_m).ceil() as i32 + 1;
        let first = |along_m: f64| (along_m / cell_m).floor() as i32 - half * stride;
        let low = (first(at.x), first(at.y));
        Self { low, stride, cell_m, side: (2 * half + 1) as usize, per_m: 1.0 / spacing_m }
    }

    /// How many points there are.
    pub(super) const fn len(&self) -> usize {
        self.side * self.side
    }

    /// Distance of two neighbours \[m\].
    pub(super) fn spacing_m(&self) -> f64 {
        f64::from(self.stride) * self.cell_m
    }

    /// The cell of a point.
    pub(super) const fn cell(&self, x: usize, y: usize) -> Cell {
        Cell::new(self.low.0 + x as i32 * self.stride, self.low.1 + y as i32 * self.stride)
    }

    /// Where a position lies, in points from the first one.
    #[inline]
    pub(super) fn place(&self, at: Point) -> Point {
        let along = |metres: f64, low: i32| {
            (metres - (f64::from(low) + 0.5) * self.cell_m) * self.per_m
        };
        Point::new(along(at.x, self.low.0), along(at.y, self.low.1))
    }

    /// Where a point lies \[m\].
    pub(super) fn position(&self, x: usize, y: usize) -> Point {
        let cell = self.cell(x, y);
        let along_m = |cell: i32| (f64::from(cell) + 0.5) * self.cell_m;
        Point::new(along_m(cell.x), along_m(cell.y))
    }

    /// The point nearest to a position, and the index of its value; `None` beyond the points.
    pub(super) fn nearest(&self, at: Point) -> Option<usize> {
        let place = self.place(at);
        let (x, y) = (place.x.round(), place.y.round());
        let within = |value: f64| (0.0..self.side as f64).contains(&value);
        (within(x) && within(y)).then(|| y as usize * self.side + x as usize)
    }

    /// The value at a position, interpolated between the four points around it; at the edge of the points for positions beyond.
    #[inline]
    pub(super) fn value(&self, values: &[f32], at: Point) -> f32 {
        let place = self.place(at);
        let last = (self.side - 2) as f64;
        let (x, y) = (place.x.clamp(0.0, last + 1.0), place.y.clamp(0.0, last + 1.0));
        let (left, low) = (x.min(last) as usize, y.min(last) as usize);
        let (part_x, part_y) = ((x - left as f64) as f32, (y - low as f64) as f32);
        let below = low * self.side + left;
        let above = below + self.side;
        let lower = values[below] + (values[below + 1] - values[below]) * part_x;
        let upper = values[above] + (values[above + 1] - values[above]) * part_x;
        lower + (upper - lower) * part_y
    }

    /// The slope of the values at a position, per metre.
    pub(super) fn slope(&self, values: &[f32], at: Point) -> Point {
        let step_m = self.spacing_m();
        let difference = |step: Point| {
            f64::from(self.value(values, at + step) - self.value(values, at - step)) / (2.0 * step_m)
        };
        Point::new(difference(Point::new(step_m, 0.0)), difference(Point::new(0.0, step_m)))
    }
}
