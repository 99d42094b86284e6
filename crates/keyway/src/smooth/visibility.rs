//! Visibility of a line from a viewpoint: finds the points of the line that can be reached in a
//! straight line, with a clearance.
//!
//! An obstacle that blocks one connection blocks those to all points in its shadow. The shadow of
//! a convex shape is convex ([`HiddenRegion`]): if it contains both ends of a straight stretch, it
//! contains the whole stretch, and if it contains the corners of a box, it contains the whole box.
//! The shapes are rows and columns of obstacle cells, inflated by the clearance.

use super::hidden_region::HiddenRegion;
use super::required_clearance::RequiredClearance;
use super::stretches::{Part, Span, Stretches};
use crate::geometry::{Point, Segment, Square};
use crate::map::{Cell, Clearance, Obstruction};

/// Shapes are shrunk by this on all sides \[cells\], so that whatever they block is certainly
/// blocked.
const INSIDE_CELLS: f64 = 1e-6;

/// The longest column of obstacle cells that makes a box.
const LONGEST_CELLS: i32 = 256;

/// Maximum number of shapes that are remembered.
const SOLIDS: usize = 8;

/// Obstacles found so far around a viewpoint that moves along a line.
pub(super) struct Visibility<'a> {
    clearance: &'a Clearance<'a>,
    clearance_m: f64,
    /// Shapes that block connections, and their shadows for the viewpoint. The shape that was
    /// found or used most recently comes last.
    solids: Vec<(Solid, HiddenRegion)>,
    /// Position of the viewpoint \[cells\].
    eye: Point,
    /// Parts of the line that are still to be searched, the last part last.
    parts: Vec<Part>,
    /// End point of the last safe connection that was found: a safe connection can begin there.
    safe: Option<usize>,
}

impl<'a> Visibility<'a> {
    /// Every connection that comes closer to an obstacle than the clearance must count as blocked.
    pub(super) const fn new(clearance: &'a Clearance<'a>, clearance_m: f64) -> Self {
        Self {
            clearance,
            clearance_m,
            solids: Vec::new(),
            eye: Point::new(f64::NAN, f64::NAN),
            parts: Vec::new(),
            safe: None,
        }
    }

    /// The farthest point along a line that a safe connection from point `eye` leads to. If there
    /// is none, the next point, without any test. `required` must have the same clearance as
    /// `self`.
    pub(super) fn farthest_safe(
        &mut self,
        line: &Stretches<'_>,
        eye: usize,
        required: &RequiredClearance<'_>,
    ) -> usize {
        let next = eye + 1;
        if line.points().len() <= next + 1 {
            return next;
        }
        // No connection is safe from a point that is itself too close to an obstacle or the
        // border.
        let is_safe = self.safe == Some(eye) || required.is_safe_point(line.points()[eye]);
        let what_stops = |connection| required.obstruction(connection);
        self.safe = if is_safe { self.last_seen(line, eye, next + 1, what_stops) } else { None };
        self.safe.unwrap_or(next)
    }

    /// The last point of a line, from index `least` on, that is visible from point `eye`: nothing
    /// blocks its connection.
    pub(super) fn last_seen(
        &mut self,
        line: &Stretches<'_>,
        eye: usize,
        least: usize,
        what_stops: impl Fn(Segment) -> Option<Obstruction>,
    ) -> Option<usize> {
        self.look_from(line.cell(eye));
        self.parts.clear();
        self.parts.extend(line.whole());
        while let Some(part) = self.parts.pop() {
            let (first, last) = line.points_of(part).into_inner();
            if last < least || self.what_hides(line.around(part)).is_some() {
                continue;
            }
            if let Some(halves) = line.halves(part) {
                self.parts.extend(halves);
            } else {
                let seen = self.last_seen_of(line, eye, first.max(least), last, &what_stops);
                if seen.is_some() {
                    return seen;
                }
            }
        }
        None
    }

    /// As [`Self::last_seen`], for points on a straight stretch.
    fn last_seen_of(
        &mut self,
        line: &Stretches<'_>,
        eye: usize,
        first: usize,
        last: usize,
        what_stops: impl Fn(Segment) -> Option<Obstruction>,
    ) -> Option<usize> {
        let mut to = last;
        while to >= first {
            let place = line.cell(to);
            if let Some(shadow) = self.what_hides(Span::of_two(place, place)) {
                to = shadow.first_hidden(line, first, to);
            } else {
                match what_stops(Segment::new(line.points()[eye], line.points()[to])) {
                    None => return Some(to),
                    Some(Obstruction::Obstacle(square)) => self.remember(square),
                    Some(Obstruction::Border) => {}
                }
            }
            to = to.checked_sub(1)?;
        }
        None
    }

    /// True if a safe connection leads from point `eye` to another one.
    pub(super) fn is_safe(
        &mut self,
        line: &Stretches<'_>,
        eye: usize,
        to: usize,
        required: &RequiredClearance<'_>,
    ) -> bool {
        if self.is_stopped(line.cell(eye), line.cell(to)) {
            return false;
        }
        let what_stops = required.obstruction(Segment::new(line.points()[eye], line.points()[to]));
        if let Some(Obstruction::Obstacle(square)) = what_stops {
            self.remember(square);
        }
        what_stops.is_none()
    }

    /// Moves the viewpoint \[cells\] and updates the shadows.
    fn look_from(&mut self, eye: Point) {
        self.eye = eye;
        for (solid, shadow) in &mut self.solids {
            *shadow = solid.shadow(eye);
        }
    }

    /// The shadow that contains all of a box \[cells\].
    fn what_hides(&mut self, places: Span) -> Option<HiddenRegion> {
        let found = self.solids.iter().rposition(|(_, shadow)| shadow.hides(places))?;
        self.solids[found..].rotate_left(1);
        self.solids.last().map(|&(_, shadow)| shadow)
    }

    /// True if a remembered shape blocks a connection \[cells\].
    fn is_stopped(&mut self, from: Point, to: Point) -> bool {
        let Some(found) = self.solids.iter().rposition(|(solid, _)| solid.stops(from, to)) else {
            return false;
        };
        self.solids[found..].rotate_left(1);
        true
    }

    /// Remembers the row and the column of obstacle cells around one that blocked a connection.
    fn remember(&mut self, square: Square) {
        let obstacles = self.clearance.obstacles();
        let at = Cell::new(square.corner.x as i32, square.corner.y as i32);
        let (left, right) = obstacles.ones_beside(at);
        let count = |dy: i32| {
            let is_in = |k: &i32| obstacles.get(Cell::new(at.x, at.y + k * dy));
            f64::from((1..LONGEST_CELLS).take_while(is_in).count() as i32)
        };
        let margin = self.clearance_m / self.clearance.frame().resolution_m();
        let solid = |low: Point, high: Point| Solid {
            low: square.corner - low + Point::new(INSIDE_CELLS, INSIDE_CELLS),
            high: square.corner + high + Point::new(1.0 - INSIDE_CELLS, 1.0 - INSIDE_CELLS),
            radius: (margin * (1.0 - INSIDE_CELLS)).max(0.0),
        };
        let row = solid(Point::new(left.into(), 0.0), Point::new(right.into(), 0.0));
        let column = solid(Point::new(0.0, count(-1)), Point::new(0.0, count(1)));
        if self.solids.len() + 2 > SOLIDS {
            self.solids.drain(..2);
        }
        self.solids.extend([row, column].map(|solid| (solid, solid.shadow(self.eye))));
    }
}

/// A box with a radius \[cells\] that connections must keep from it.
#[derive(Clone, Copy, Debug)]
struct Solid {
    low: Point,
    high: Point,
    radius: f64,
}

impl Solid {
    /// True if it blocks the connection of two points.
    fn stops(&self, from: Point, to: Point) -> bool {
        let Self { low, high, radius } = *self;
        let apart = |by: f64| {
            let on_one_side = |a: f64, b: f64, low: f64, high: f64| {
                (a < low && b < low) || (a > high && b > high)
            };
            on_one_side(from.x, to.x, low.x - by, high.x + by)
                || on_one_side(from.y, to.y, low.y - by, high.y + by)
        };
        if apart(radius) {
            return false;
        }
        // The sides of the inflated box are no separating lines; the connection's own line remains
        // to be tested.
        let way = to - from;
        let off = way.cross((low + high) * 0.5 - from).abs();
        let half = (high - low) * 0.5;
        let shadow = half.x * way.y.abs() + half.y * way.x.abs();
        if off <= shadow && !apart(0.0) {
            return true;
        }
        off < shadow + radius * way.norm() && self.is_rounded_near(Segment::new(from, to))
    }

    /// True if a connection past the box comes closer than the radius. The closest point is then
    /// one of its ends, or next to a corner of the box.
    fn is_rounded_near(&self, connection: Segment) -> bool {
        let Self { low, high, radius } = *self;
        let radius_sq = radius * radius;
        let from_box = |p: Point| {
            let dx = (low.x - p.x).max(p.x - high.x).max(0.0);
            let dy = (low.y - p.y).max(p.y - high.y).max(0.0);
            dx * dx + dy * dy
        };
        let corners = [low, high, Point::new(low.x, high.y), Point::new(high.x, low.y)];
        [connection.a, connection.b].into_iter().any(|end| from_box(end) < radius_sq)
            || corners.into_iter().any(|at| connection.distance_sq_to_point(at) < radius_sq)
    }

    /// The region that it hides from a viewpoint.
    fn shadow(&self, eye: Point) -> HiddenRegion {
        HiddenRegion::of_box(Span::of_two(self.low, self.high), self.radius, eye)
    }
}
