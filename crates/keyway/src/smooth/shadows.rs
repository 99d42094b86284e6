//! What an eye sees of a line: which points of it can be reached straight, with a clearance.
//!
//! An obstacle that stops one connection stops those to all points in its shadow. The shadow of a convex
//! shape is convex: where both ends of a straight stretch of a line lie in it, so does all between them.
//! The shapes are boxes that the clearance keeps connections out of: a row or a column of obstacle cells,
//! longer by the clearance at both ends.

use crate::geometry::{Point, Segment, Square};
use crate::map::{Cell, Clearance, Obstruction};

/// Boxes are smaller by this on all sides \[cells\]: in their shadow, a connection is stopped for certain.
const INSIDE_CELLS: f64 = 1e-6;

/// Points that are this far from a straight line \[cells\] lie on it.
const STRAIGHT_CELLS: f64 = 1e-8;

/// The longest row or column of obstacle cells that makes a box.
const LONGEST_CELLS: i32 = 256;

/// How many boxes are remembered.
const BOXES: usize = 16;

/// A line, and the straight stretches of it.
pub(super) struct Stretches<'l> {
    points: &'l [Point],
    /// The points \[cells\].
    cells: Vec<Point>,
    /// For each point, the first one of the stretch that it lies on or ends.
    first: Vec<usize>,
}

impl<'l> Stretches<'l> {
    pub(super) fn new(points: &'l [Point], clearance: &Clearance<'_>) -> Self {
        let cells: Vec<Point> =
            points.iter().map(|&point| clearance.frame().grid_from_world(point)).collect();
        let mut first: Vec<usize> = Vec::with_capacity(points.len());
        let mut ahead = Point::default();
        for at in 0..cells.len() {
            let Some(&from) = first.last() else {
                first.push(0);
                continue;
            };
            let (way, step) = (cells[at] - cells[from], cells[at] - cells[at - 1]);
            // A stretch has the direction of its first two points; repeated points have none.
            let goes_on = ahead.dot(step) > 0.0 && ahead.cross(way).abs() <= STRAIGHT_CELLS;
            if !goes_on {
                let length = step.norm();
                ahead = if length > 0.0 { step * (1.0 / length) } else { Point::default() };
            }
            first.push(if goes_on { from } else { at - 1 });
        }
        Self { points, cells, first }
    }
}

/// What is known of the obstacles around an eye.
pub(super) struct Shadows<'a> {
    eye: Point,
    /// The eye \[cells\].
    eye_cells: Point,
    clearance: &'a Clearance<'a>,
    clearance_m: f64,
    /// The one that was found or used last comes last.
    boxes: Vec<Solid>,
}

impl<'a> Shadows<'a> {
    pub(super) fn new(eye: Point, clearance: &'a Clearance<'a>, clearance_m: f64) -> Self {
        let eye_cells = clearance.frame().grid_from_world(eye);
        Self { eye, eye_cells, clearance, clearance_m, boxes: Vec::new() }
    }

    /// The last point of a line, from number `least` on, that is seen: nothing stops its connection.
    /// Whatever comes nearer to an obstacle than the clearance must be stopped.
    pub(super) fn last_seen(
        &mut self,
        line: &Stretches<'_>,
        least: usize,
        what_stops: impl Fn(Segment) -> Option<Obstruction>,
    ) -> Option<usize> {
        let mut to = line.points.len().checked_sub(1)?;
        while to >= least {
            if let Some(solid) = self.what_hides(line.cells[to]) {
                let from = line.first[to].max(least);
                to = self.first_hidden(&line.cells[from..=to], &solid) + from;
            } else {
                let connection = Segment::new(self.eye, line.points[to]);
                match what_stops(connection) {
                    None => return Some(to),
                    Some(Obstruction::Obstacle(square)) => self.remember(square),
                    Some(Obstruction::Border) => {}
                }
            }
            to = to.checked_sub(1)?;
        }
        None
    }

    fn what_hides(&mut self, point: Point) -> Option<Solid> {
        let found = self.boxes.iter().rposition(|solid| solid.stops(self.eye_cells, point))?;
        let solid = self.boxes.remove(found);
        self.boxes.push(solid);
        Some(solid)
    }

    /// The first of some points on a straight stretch that is hidden; the last one is.
    fn first_hidden(&self, stretch: &[Point], solid: &Solid) -> usize {
        if solid.stops(self.eye_cells, stretch[0]) {
            return 0;
        }
        let (mut seen, mut hidden) = (0, stretch.len() - 1);
        while hidden > seen + 1 {
            let middle = seen.midpoint(hidden);
            if solid.stops(self.eye_cells, stretch[middle]) {
                hidden = middle;
            } else {
                seen = middle;
            }
        }
        hidden
    }

    /// The obstacle cells in a row, and in a column, with one that stopped a connection.
    fn remember(&mut self, square: Square) {
        let obstacles = self.clearance.obstacles();
        let at = Cell::new(square.corner.x as i32, square.corner.y as i32);
        let count = |dx: i32, dy: i32| {
            let is_in = |k: &i32| obstacles.get(Cell::new(at.x + k * dx, at.y + k * dy));
            f64::from((1..LONGEST_CELLS).take_while(is_in).count() as i32)
        };
        // Solids are as long as the clearance lets them be, and as thick as the cells.
        let margin = self.clearance_m.max(0.0) / self.clearance.frame().resolution_m();
        let longer = margin * (1.0 - INSIDE_CELLS) - INSIDE_CELLS;
        let far = square.corner + Point::new(1.0, 1.0);
        let row = Solid {
            low: square.corner + Point::new(-count(-1, 0) - longer, INSIDE_CELLS),
            high: far + Point::new(count(1, 0) + longer, -INSIDE_CELLS),
        };
        let column = Solid {
            low: square.corner + Point::new(INSIDE_CELLS, -count(0, -1) - longer),
            high: far + Point::new(-INSIDE_CELLS, count(0, 1) + longer),
        };
        if self.boxes.len() + 2 > BOXES {
            self.boxes.drain(..2);
        }
        self.boxes.extend([row, column]);
    }
}

/// A box that a connection may not meet \[cells\].
#[derive(Clone, Copy, Debug)]
struct Solid {
    low: Point,
    high: Point,
}

impl Solid {
    /// Whether it meets the connection of two points.
    fn stops(&self, from: Point, to: Point) -> bool {
        let Self { low, high } = self;
        let apart =
            |a: f64, b: f64, low: f64, high: f64| (a < low && b < low) || (a > high && b > high);
        if apart(from.x, to.x, low.x, high.x) || apart(from.y, to.y, low.y, high.y) {
            return false;
        }
        // No side of the box is a separating line; the connection's own line is left.
        let way = to - from;
        let off = way.cross((*low + *high) * 0.5 - from).abs();
        let half = (*high - *low) * 0.5;
        off <= half.x * way.y.abs() + half.y * way.x.abs()
    }
}
