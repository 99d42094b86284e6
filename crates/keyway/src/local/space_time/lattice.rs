//! A grid of values around the robot, interpolated in between.

use crate::geometry::Point;
use crate::map::{Cell, GridFrame};
use std::ops::Range;

/// Points around the robot: the centres of every `stride`-th cell of the map, in every `stride`-th
/// row; or, for robots that are small beside a cell, the centres of the `parts` times `parts`
/// squares that each cell is divided into. Positions are in metres along the axes of the map's
/// cells, from the corner of the map at its origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lattice {
    /// Column and row of the first point, in parts of a cell.
    low: (i32, i32),
    /// Its position \[m\].
    first_m: Point,
    /// Number of cells from one point to the next; 1 if cells are divided.
    stride: i32,
    /// Number of points in a cell along each axis; odd, so that its centre is one of them.
    parts: i32,
    /// Number of points in a row, and in a column.
    pub(super) side: usize,
    /// Distance of two neighbours \[m\].
    pub(super) spacing_m: f64,
    /// Points per metre; stored because positions are looked up too often to divide.
    per_m: f64,
}

impl Lattice {
    /// Upper limit of the points to either side: for robots that cover a long distance within a
    /// horizon, points are farther apart.
    const MOST_TO_A_SIDE: f64 = 250.0;

    /// Limit that keeps columns and rows in the range of cell numbers.
    const LARGEST_STRIDE: f64 = 1e6;

    /// Number of points along each axis of a cell that is divided.
    const PARTS: i32 = 3;

    /// All points up to `reach_m` from a position along both axes, and one more. They are
    /// `spacing_m` apart, rounded down to cells, but at least one cell (a third of it if half a
    /// cell is too much), and farther if there would be too many.
    pub(super) fn around(frame: &GridFrame, at: Point, reach_m: f64, spacing_m: f64) -> Self {
        let cell_m = frame.resolution_m();
        let finest_m = reach_m / Self::MOST_TO_A_SIDE;
        let is_divided = 2.0 * spacing_m <= cell_m && f64::from(Self::PARTS) * finest_m <= cell_m;
        let parts = if is_divided { Self::PARTS } else { 1 };
        let (wanted, least) = ((spacing_m / cell_m).floor(), (finest_m / cell_m).ceil());
        let stride = wanted.max(least).clamp(1.0, Self::LARGEST_STRIDE) as i32;
        let part_m = cell_m / f64::from(parts);
        let spacing_m = f64::from(stride) * part_m;
        let half = (reach_m / spacing_m).ceil().min(Self::MOST_TO_A_SIDE) as i32 + 1;
        // The same points for all positions of the robot, so that interpolated values do not
        // change as it moves.
        let first = |along_m: f64| ((along_m / spacing_m).floor() as i32 - half) * stride;
        let low = (first(at.x), first(at.y));
        let along_m = |part: i32| (f64::from(part) + 0.5) * part_m;
        let first_m = Point::new(along_m(low.0), along_m(low.1));
        let (side, per_m) = ((2 * half + 1) as usize, spacing_m.recip());
        Self { low, first_m, stride, parts, side, spacing_m, per_m }
    }

    /// Number of points.
    pub(super) const fn count(&self) -> usize {
        self.side * self.side
    }

    /// True if every point is the centre of a cell.
    pub(super) const fn is_of_centres(&self) -> bool {
        self.parts == 1
    }

    /// Number of cells from one point to the next, if points are centres of cells.
    pub(super) const fn stride(&self) -> usize {
        self.stride as usize
    }

    /// The cell that contains a point; it may lie outside the map.
    pub(super) fn cell(&self, x: usize, y: usize) -> Cell {
        let part = |first: i32, steps: usize| first + steps as i32 * self.stride;
        let along = |first: i32, steps: usize| part(first, steps).div_euclid(self.parts);
        Cell::new(along(self.low.0, x), along(self.low.1, y))
    }

    /// Position of a point \[m\].
    pub(super) fn position(&self, x: usize, y: usize) -> Point {
        self.first_m + Point::new(x as f64, y as f64) * self.spacing_m
    }

    /// Coordinates of a position on the lattice, in points from the first one.
    #[inline]
    pub(super) fn place(&self, at: Point) -> Point {
        (at - self.first_m) * self.per_m
    }

    /// Index of the point nearest to a position; `None` beyond the points.
    pub(super) fn nearest(&self, at: Point) -> Option<usize> {
        let place = self.place(at);
        let (x, y) = (place.x.round(), place.y.round());
        let within = |value: f64| (0.0..self.side as f64).contains(&value);
        (within(x) && within(y)).then(|| y as usize * self.side + x as usize)
    }

    /// Columns and rows of the points within this distance of a place along both axes, in points.
    pub(super) fn within(&self, place: Point, reach: f64) -> [Range<usize>; 2] {
        [place.x, place.y].map(|at| {
            let (low, high) = ((at - reach).ceil().max(0.0), (at + reach).floor() + 1.0);
            low as usize..(high.max(0.0) as usize).min(self.side)
        })
    }

    /// True if everything within this distance of a place, in points from the first one, lies
    /// between the points.
    #[inline]
    pub(super) fn holds(&self, place: Point, within_m: f64) -> bool {
        let within = within_m / self.spacing_m + 1.0;
        let (low, high) = (within, (self.side - 2) as f64 - within);
        place.x >= low && place.y >= low && place.x <= high && place.y <= high
    }

    /// The value at a position, interpolated between the four points around it; beyond the
    /// points, the value at their edge.
    ///
    /// Values are stored as `f32`, and interpolated as `f64`: rounding must not decide between
    /// two trajectories, which would be a different one in a mirrored world.
    #[inline]
    pub(super) fn value(&self, values: &[f32], at: Point) -> f64 {
        self.value_at(values, self.place(at))
    }

    /// The same at a place, in points from the first one.
    #[inline]
    pub(super) fn value_at(&self, values: &[f32], place: Point) -> f64 {
        // The last point is excluded, as the next one after it is read.
        let last = (self.side - 1) as f64 * (1.0 - f64::EPSILON);
        self.value_within(values, Point::new(place.x.clamp(0.0, last), place.y.clamp(0.0, last)))
    }

    /// The same between the points, if the lattice [`Self::holds`] the place.
    #[inline]
    pub(super) fn value_within(&self, values: &[f32], place: Point) -> f64 {
        let (below, parts) = self.corner(place);
        self.between(values, below, parts)
    }

    /// The first of the four points around a place, and the position beyond it as a fraction of
    /// the distance to the next one along both axes.
    #[inline]
    fn corner(&self, place: Point) -> (usize, (f64, f64)) {
        let (left, low) = (place.x as u32, place.y as u32);
        let parts = (place.x - f64::from(left), place.y - f64::from(low));
        (low as usize * self.side + left as usize, parts)
    }

    #[inline]
    fn between(&self, values: &[f32], below: usize, (part_x, part_y): (f64, f64)) -> f64 {
        let above = below + self.side;
        let (below, above) = (&values[below..below + 2], &values[above..above + 2]);
        let along = |row: &[f32]| {
            let (left, right) = (f64::from(row[0]), f64::from(row[1]));
            left + (right - left) * part_x
        };
        let (lower, upper) = (along(below), along(above));
        lower + (upper - lower) * part_y
    }

    /// Slope of the values at a position, per metre, over a step to both sides.
    pub(super) fn slope(&self, values: &[f32], at: Point) -> Point {
        let place = self.place(at);
        let last = (self.side - 1) as f64;
        let is_within = |along: f64| along >= 1.0 && along + 2.0 <= last;
        let [right, left, above, below] = if is_within(place.x) && is_within(place.y) {
            let (corner, parts) = self.corner(place);
            [corner + 1, corner - 1, corner + self.side, corner - self.side]
                .map(|corner| self.between(values, corner, parts))
        } else {
            [
                Point::new(1.0, 0.0),
                Point::new(-1.0, 0.0),
                Point::new(0.0, 1.0),
                Point::new(0.0, -1.0),
            ]
            .map(|step| self.value_at(values, place + step))
        };
        let per_m = 1.0 / (2.0 * self.spacing_m);
        Point::new(right - left, above - below) * per_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    #[test]
    fn points_are_centres_of_cells_and_values_in_between_are_linear() {
        let frame = GridFrame::new(40, 40, 0.1, Pose::new(3.0, -2.0, 0.4)).unwrap();
        let lattice = Lattice::around(&frame, Point::new(2.03, 2.07), 1.0, 0.25);
        assert!((lattice.spacing_m - 0.2).abs() < 1e-12, "two cells");
        assert_eq!(lattice.side, 13, "five to either side, and one more");
        assert_eq!(lattice.cell(6, 6), Cell::new(20, 20));
        assert!(lattice.position(6, 6).distance(Point::new(2.05, 2.05)) < 1e-12);
        assert_eq!(lattice.nearest(Point::new(2.14, 2.05)), Some(6 * 13 + 6));
        assert_eq!(lattice.nearest(Point::new(2.16, 2.05)), Some(6 * 13 + 7));
        assert_eq!(lattice.nearest(Point::new(9.0, 2.05)), None);
        let plane = |at: Point| 3.0 * at.x - 2.0 * at.y;
        let mut values = vec![0.0; lattice.count()];
        for (index, value) in values.iter_mut().enumerate() {
            *value = plane(lattice.position(index % 13, index / 13)) as f32;
        }
        for at in [Point::new(2.0, 2.0), Point::new(1.31, 2.77), Point::new(2.93, 1.13)] {
            assert!((lattice.value(&values, at) - plane(at)).abs() < 1e-5);
            let slope = lattice.slope(&values, at);
            assert!(slope.distance(Point::new(3.0, -2.0)) < 1e-4);
        }
        // A third of a cell apart; each cell has nine.
        let divided = Lattice::around(&frame, Point::new(2.03, 2.07), 0.2, 0.05);
        assert!((divided.spacing_m - 0.1 / 3.0).abs() < 1e-12 && !divided.is_of_centres());
        for (x, y) in [(0, 0), (1, 2), (7, 3), (8, 11)] {
            let (cell, at) = (divided.cell(x, y), divided.position(x, y));
            assert_eq!(cell, Cell::new((at.x / 0.1).floor() as i32, (at.y / 0.1).floor() as i32));
        }
        let off = |x: usize| divided.position(x, 0).x / 0.1 - 0.5;
        let middle = |&x: &usize| (off(x) - off(x).round()).abs() < 1e-9;
        assert_eq!((0..9).filter(middle).count(), 3, "every third is the centre of its cell");
        assert!(Lattice::around(&frame, Point::new(2.0, 2.0), 0.2, 0.06).is_of_centres());
        // 18 km, as a robot of 100 m/s may come in three minutes.
        let wide = Lattice::around(&frame, Point::new(2.0, 2.0), 18e3, 0.1);
        assert!(wide.side <= 503 && wide.spacing_m >= 72.0);
        let corner = lattice.value(&values, Point::new(-50.0, -50.0));
        assert!((corner - plane(lattice.position(0, 0))).abs() < 1e-5, "its edge");
    }
}
