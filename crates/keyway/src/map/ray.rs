//! The cells that a ray passes through, in order.

use super::cell::floor_to_i32;
use super::{Cell, GridFrame};
use crate::geometry::Point;

/// A cell that a ray passes through.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RayCell {
    /// The cell.
    pub cell: Cell,
    /// Distance at which the ray enters the cell, in lengths of the ray's direction: cells for a
    /// unit vector. 0 for the cell in which the ray begins.
    pub enter: f64,
}

/// The cells of a grid that a ray passes through, in order of the distance at which it enters
/// them \[Amanatides1987\].
///
/// The ray visits the cells whose *interior* it crosses; a cell that is only touched at a corner
/// is not visited. A ray along the border between two rows or columns crosses the interior of
/// neither: it visits the cells above or right of it (on the outer upper or right border the last
/// cells), as [`GridFrame::cell_from_grid`] assigns points. A ray has no width, so it slips
/// through the common corner of two cells.
///
/// The distance of a crossing is computed from its own grid line, not summed up, so rounding does
/// not accumulate along the ray: a cell is missed or added only if the ray runs inside or outside
/// of it for a length in the last digits of the coordinates. Cost: a few operations per cell,
/// none for the distance to the grid of a ray that begins outside.
#[derive(Clone, Debug)]
pub struct RayCells {
    x: Axis,
    y: Axis,
    enter: f64,
    /// Distance at which the ray ends or leaves the grid.
    leave: f64,
}

/// Distance from the origin of the grid \[cells\] within which the precision of a ray's start is
/// far finer than a cell.
const NEAR_CELLS: f64 = 1e9;

/// One coordinate of a ray: its current column (or row), and the distance at which it leaves it.
#[derive(Clone, Debug)]
struct Axis {
    start: f64,
    rate: f64,
    cell: i32,
    /// Distance at which the ray leaves `cell`, in lengths of its direction.
    next: f64,
}

impl RayCells {
    /// The cells of `frame`'s grid on the ray from `start` (grid coordinates \[cells\], may lie
    /// outside the grid) to `start + direction * length`; `length` may be infinite. Empty if the
    /// start or direction is not finite, or the length not positive.
    pub fn new(frame: &GridFrame, start: Point, direction: Point, length: f64) -> Self {
        let mut x = Axis::new(start.x, direction.x);
        let mut y = Axis::new(start.y, direction.y);
        if !start.is_finite() || !direction.is_finite() || length.is_nan() {
            return Self { x, y, enter: 0.0, leave: 0.0 };
        }
        let (columns, rows) = (frame.width() as i32, frame.height() as i32);
        let (x_span, y_span) = (x.span(columns), y.span(rows));
        let enter = x_span.0.max(y_span.0).max(0.0);
        let leave = x_span.1.min(y_span.1).min(length);
        if enter < leave {
            x.enter_at(enter, columns);
            y.enter_at(enter, rows);
        }
        Self { x, y, enter, leave }
    }

    /// Distance at which the ray enters the first obstacle cell, if any; exactly the one found
    /// from cell to cell. `steps` returns a lower bound of the number of steps (to any of the 8
    /// neighbours) from a cell of the grid to the nearest obstacle cell: 0 only for an obstacle
    /// cell itself.
    ///
    /// Costs a few operations per square of free cells that the ray crosses.
    pub fn enters_first(mut self, steps: impl Fn(Cell) -> i32) -> Option<f64> {
        let is_near = self.x.start.abs().max(self.y.start.abs()) < NEAR_CELLS;
        while self.enter < self.leave {
            let free = steps(Cell::new(self.x.cell, self.y.cell));
            if free == 0 {
                return Some(self.enter);
            }
            if free == 1 || !is_near {
                self.next();
                continue;
            }
            // All cells fewer steps away are free: a square around the cell.
            self.enter = self.x.leaves_around(free - 1).min(self.y.leaves_around(free - 1));
            if self.enter < self.leave {
                self.x.go_to(self.enter);
                self.y.go_to(self.enter);
            }
        }
        None
    }
}

impl Iterator for RayCells {
    type Item = RayCell;

    fn next(&mut self) -> Option<RayCell> {
        // At the grid's last column `next` is computed like the end of the span: it equals
        // `leave`.
        if self.enter >= self.leave {
            return None;
        }
        let passed = RayCell { cell: Cell::new(self.x.cell, self.y.cell), enter: self.enter };
        self.enter = self.x.next.min(self.y.next);
        // Both at once if the ray passes through a corner.
        if self.enter < self.leave {
            self.x.pass(self.enter);
            self.y.pass(self.enter);
        }
        Some(passed)
    }
}

impl Axis {
    const fn new(start: f64, rate: f64) -> Self {
        Self { start, rate, cell: 0, next: f64::INFINITY }
    }

    /// Distance at which the ray crosses the grid line `line`.
    fn crossing(&self, line: i32) -> f64 {
        (f64::from(line) - self.start) / self.rate
    }

    /// The span of distances in which the ray is among the `count` columns; empty (from infinity
    /// on) if it never is.
    fn span(&self, count: i32) -> (f64, f64) {
        if self.rate == 0.0 {
            let inside = self.start >= 0.0 && self.start <= f64::from(count);
            let from = if inside { f64::NEG_INFINITY } else { f64::INFINITY };
            return (from, f64::INFINITY);
        }
        let (first, last) = (self.crossing(0), self.crossing(count));
        (first.min(last), first.max(last))
    }

    /// Finds the column that the ray enters at distance `enter`.
    fn enter_at(&mut self, enter: f64, count: i32) {
        let at = self.start + self.rate * enter;
        self.cell = (at.floor() as i32).clamp(0, count - 1);
        self.next = self.leaves();
        // On a grid line, or because `at` is rounded, this may be the column that ends here.
        self.pass(enter);
    }

    fn leaves(&self) -> f64 {
        match self.rate {
            rate if rate > 0.0 => self.crossing(self.cell + 1),
            rate if rate < 0.0 => self.crossing(self.cell),
            _ => f64::INFINITY,
        }
    }

    /// Distance at which the ray leaves the columns that are at most `beside` away from `cell`.
    fn leaves_around(&self, beside: i32) -> f64 {
        match self.rate {
            rate if rate > 0.0 => self.crossing(self.cell + 1 + beside),
            rate if rate < 0.0 => self.crossing(self.cell - beside),
            _ => f64::INFINITY,
        }
    }

    /// Advances to the column in which the ray is after distance `enter`: entered by then, and
    /// left later. Passing one grid line after the other leads to the same column.
    fn go_to(&mut self, enter: f64) {
        if self.rate == 0.0 {
            return;
        }
        self.cell = floor_to_i32(self.start + self.rate * enter);
        // Next to a grid line, rounding may be off by a column.
        let (entered_line, backwards) = if self.rate > 0.0 { (0, -1) } else { (1, 1) };
        if self.crossing(self.cell + entered_line) > enter {
            self.cell += backwards;
        }
        self.next = self.leaves();
        self.pass(enter);
    }

    /// Advances to the column after the grid line at distance `enter`, if one is crossed there.
    fn pass(&mut self, enter: f64) {
        if self.next <= enter {
            self.cell += if self.rate > 0.0 { 1 } else { -1 };
            self.next = self.leaves();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, Segment, Square};
    use proptest::prelude::*;

    fn frame() -> GridFrame {
        GridFrame::new(4, 3, 1.0, Pose::default()).unwrap()
    }

    fn cells(start: [f64; 2], direction: [f64; 2], length: f64) -> Vec<(i32, i32, f64)> {
        RayCells::new(&frame(), start.into(), direction.into(), length)
            .map(|passed| (passed.cell.x, passed.cell.y, passed.enter))
            .collect()
    }

    #[test]
    fn along_the_axes() {
        let row = [(1, 1, 0.0), (2, 1, 0.75), (3, 1, 1.75)];
        assert_eq!(cells([1.25, 1.5], [1.0, 0.0], f64::INFINITY), row);
        assert_eq!(cells([1.25, 1.5], [1.0, 0.0], 1.75), row[..2]);
        assert_eq!(cells([1.25, 1.5], [0.0, -1.0], 9.0), [(1, 1, 0.0), (1, 0, 0.5)]);
    }

    #[test]
    fn from_a_border_into_the_cell_ahead() {
        assert_eq!(cells([2.0, 0.5], [-1.0, 0.0], 1.5), [(1, 0, 0.0), (0, 0, 1.0)]);
        assert_eq!(cells([2.0, 0.5], [1.0, 0.0], 1.0), [(2, 0, 0.0)]);
        assert_eq!(cells([4.0, 0.5], [1.0, 0.0], 9.0), []);
        assert_eq!(cells([4.0, 0.5], [-1.0, 0.0], 0.5), [(3, 0, 0.0)]);
    }

    #[test]
    fn along_a_border_through_the_cells_above_or_right() {
        assert_eq!(cells([0.0, 1.0], [1.0, 0.0], 2.0), [(0, 1, 0.0), (1, 1, 1.0)]);
        assert_eq!(cells([3.0, 3.0], [-0.0, -1.0], 1.0), [(3, 2, 0.0)]);
        assert_eq!(cells([4.0, 2.0], [0.0, -1.0], 1.0), [(3, 1, 0.0)]);
        assert_eq!(cells([0.5, 3.0], [1.0, 0.0], 0.5), [(0, 2, 0.0)]);
    }

    #[test]
    fn through_corners_diagonally() {
        let up = [(0, 0, 0.0), (1, 1, 1.0), (2, 2, 2.0)];
        assert_eq!(cells([0.0, 0.0], [1.0, 1.0], 9.0), up);
        assert_eq!(cells([1.5, 2.5], [1.0, -1.0], 1.0), [(1, 2, 0.0), (2, 1, 0.5)]);
    }

    #[test]
    fn from_outside() {
        assert_eq!(cells([-2.0, 0.5], [1.0, 0.0], 3.5), [(0, 0, 2.0), (1, 0, 3.0)]);
        assert_eq!(cells([-2.0, 0.5], [1.0, 0.0], 2.0), []);
        assert_eq!(cells([-2.0, 0.5], [-1.0, 0.0], 9.0), []);
        assert_eq!(cells([-2.0, 3.5], [1.0, 0.0], 9.0), []);
        // Only the corner (0, 3) is touched.
        assert_eq!(cells([-1.0, 2.0], [1.0, 1.0], 9.0), []);
    }

    #[test]
    fn what_is_no_ray() {
        assert_eq!(cells([f64::NAN, 0.5], [1.0, 0.0], 9.0), []);
        assert_eq!(cells([0.5, 0.5], [f64::INFINITY, 0.0], 9.0), []);
        for length in [0.0, -1.0, f64::NAN] {
            assert_eq!(cells([0.5, 0.5], [1.0, 0.0], length), []);
        }
        assert_eq!(cells([0.5, 0.5], [0.0, 0.0], f64::INFINITY), [(0, 0, 0.0)]);
        assert_eq!(cells([-1e300, 0.5], [1.0, 0.0], 9.0), []);
    }

    /// Any coordinate; half of them are on grid lines or half-way between them.
    fn coordinate(low: i32, high: i32) -> impl Strategy<Value = f64> {
        let grid = (2 * low..=2 * high).prop_map(|n| f64::from(n) / 2.0);
        prop_oneof![grid, f64::from(low)..f64::from(high)]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn exactly_the_crossed_cells_in_order(x in coordinate(-2, 9), y in coordinate(-2, 7),
                                              dx in coordinate(-3, 3), dy in coordinate(-3, 3),
                                              length in 0.01..6.0f64) {
            let frame = GridFrame::new(7, 5, 0.3, Pose::new(1.0, 2.0, 0.4)).unwrap();
            let (start, direction) = (Point::new(x, y), Point::new(dx, dy));
            let segment = Segment::new(start, start + direction * length);
            let passed: Vec<RayCell> = RayCells::new(&frame, start, direction, length).collect();
            let corner = |cell: Cell| Point::new(f64::from(cell.x), f64::from(cell.y));
            for ray_cell in &passed {
                let square = Square { corner: corner(ray_cell.cell) };
                prop_assert!(frame.contains(ray_cell.cell));
                prop_assert!(segment.distance_sq_to_square(square) < 1e-20, "{ray_cell:?}");
                let at = start + direction * ray_cell.enter;
                prop_assert!(square.distance_sq_to_point(at) < 1e-20, "{ray_cell:?}");
            }
            for pair in passed.windows(2) {
                prop_assert!(pair[0].enter < pair[1].enter);
                let (a, b) = (pair[0].cell, pair[1].cell);
                prop_assert!((a.x - b.x).abs().max((a.y - b.y).abs()) == 1);
            }
            // Squares of free cells of any size are skipped, without any other change.
            for (obstacle, most) in passed.iter().zip([255, 1, 2, 3].into_iter().cycle()) {
                let steps = |cell: Cell| {
                    let away = cell.x.abs_diff(obstacle.cell.x).max(cell.y.abs_diff(obstacle.cell.y));
                    (away as i32).min(most)
                };
                let ray = RayCells::new(&frame, start, direction, length);
                prop_assert_eq!(ray.enters_first(steps), Some(obstacle.enter));
            }
            let ray = RayCells::new(&frame, start, direction, length);
            prop_assert_eq!(ray.enters_first(|_| 2), None);
            for cell in frame.cells() {
                // Slightly smaller: the side on which a rounded ray passes a corner is undefined.
                let scaled = |p: Point| (p - corner(cell) - Point::new(1e-9, 1e-9)) * (1.0 + 2e-9);
                let inner = Segment::new(scaled(segment.a), scaled(segment.b));
                if inner.crosses(Square { corner: Point::new(0.0, 0.0) }) {
                    prop_assert!(passed.iter().any(|p| p.cell == cell), "{} missed", cell);
                }
            }
        }

        /// Rays through corners, for which rounding decides which cells are passed: the cells are
        /// the same.
        #[test]
        fn skipping_passes_corners_as_steps_do(corner in (0..40i32, 0..30i32), angle in -3.2..3.2f64,
                                               back in 0.0..30.0f64, most in 2..9i32) {
            let frame = GridFrame::new(40, 30, 1.0, Pose::default()).unwrap();
            let (sin, cos) = libm::sincos(angle);
            let direction = Point::new(cos, sin);
            let start = Point::new(f64::from(corner.0), f64::from(corner.1)) - direction * back;
            let passed: Vec<RayCell> = RayCells::new(&frame, start, direction, 60.0).collect();
            for obstacle in passed {
                let steps = |cell: Cell| {
                    let away = cell.x.abs_diff(obstacle.cell.x).max(cell.y.abs_diff(obstacle.cell.y));
                    (away as i32).min(most)
                };
                let ray = RayCells::new(&frame, start, direction, 60.0);
                prop_assert_eq!(ray.enters_first(steps), Some(obstacle.enter), "{}", obstacle.cell);
            }
        }
    }
}
