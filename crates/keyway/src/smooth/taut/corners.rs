//! The obstacle corners that a taut path may bend around, and the radius it keeps from each.

use super::TOUCH_CELLS;
use crate::geometry::{Point, Segment};
use crate::map::{BitGrid, Cell};
use crate::search::bit_scan::convex_corners;

/// If the line itself is closer to a corner than the radius, the corner's radius is less than the
/// line's distance by this share, so that the line stays outside even if it is rounded.
const ROUNDING: f64 = 1e-10;

/// A lattice point, the lower left corner of its cell, surrounded by one blocked cell, or two
/// diagonal ones.
pub(super) type Corner = Cell;

/// Position of a corner \[cells\].
pub(super) fn position(corner: Corner) -> Point {
    Point::new(f64::from(corner.x), f64::from(corner.y))
}

/// The corners of a map's obstacles, for one line.
pub(super) struct Corners<'m> {
    obstacles: &'m BitGrid,
    /// The radius to keep around corners \[cells\].
    radius: f64,
    /// Corners that the line is closer to, with their smaller radii; sorted.
    tight: Vec<((i32, i32), f64)>,
}

impl<'m> Corners<'m> {
    /// Corners for a line \[cells\] that has to keep `radius` \[cells\].
    pub(super) fn new(obstacles: &'m BitGrid, radius: f64, line: &[Point]) -> Self {
        let mut corners = Self { obstacles, radius, tight: Vec::new() };
        if radius > TOUCH_CELLS {
            corners.tight = corners.nearer_than_radius(line);
        }
        corners
    }

    fn nearer_than_radius(&self, line: &[Point]) -> Vec<((i32, i32), f64)> {
        let mut tight = Vec::new();
        for pair in line.windows(2) {
            let segment = Segment::new(pair[0], pair[1]);
            self.for_each_near([segment], |corner| {
                let distance = segment.distance_sq_to_point(position(corner)).sqrt();
                let radius = distance * (1.0 - ROUNDING);
                if radius < self.radius {
                    tight.push(((corner.x, corner.y), radius));
                }
            });
        }
        tight.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        tight.dedup_by_key(|(corner, _)| *corner);
        tight
    }

    /// The radius around a corner \[cells\].
    pub(super) fn radius(&self, corner: Corner) -> f64 {
        let tight = self.tight.binary_search_by_key(&(corner.x, corner.y), |entry| entry.0);
        tight.map_or(self.radius, |found| self.tight[found].1)
    }

    /// True if an obstacle at a corner lies on one side (1 left, -1 right) of all these directions.
    pub(super) fn has_obstacle_beside(&self, at: Corner, directions: &[Point], side: f64) -> bool {
        [(-1, -1), (0, -1), (-1, 0), (0, 0)].into_iter().any(|(dx, dy)| {
            let inner = Point::new(f64::from(2 * dx + 1), f64::from(2 * dy + 1));
            self.obstacles.get(Cell::new(at.x + dx, at.y + dy))
                && directions.iter().all(|direction| side * direction.cross(inner) > 0.0)
        })
    }

    /// Visits all corners whose discs may intersect the convex hull of the segments \[cells\], and
    /// some more. Corners on the border of the map are left out: a path cannot bend around them.
    pub(super) fn for_each_near<const N: usize>(
        &self,
        hull: [Segment; N],
        mut visit: impl FnMut(Corner),
    ) {
        let reach = self.radius + TOUCH_CELLS;
        let ys = hull.iter().flat_map(|edge| [edge.a.y, edge.b.y]);
        let (low, high) =
            ys.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
        let (width, height) = (self.obstacles.width() as i32, self.obstacles.height() as i32);
        let lines =
            ((low - reach).ceil() as i32).max(1)..=((high + reach).floor() as i32).min(height - 1);
        let edges = hull.map(Edge::new);
        for y in lines {
            let (from, to) = extent(&edges, f64::from(y), reach);
            // Corners are integers. Rounding towards 0 adds at most one corner on the left.
            let first = (from as i32).max(1);
            let last = (to as i32).min(width - 1);
            if first <= last {
                self.visit_line(y, first as usize, last as usize, &mut visit);
            }
        }
    }

    fn visit_line(&self, y: i32, first: usize, last: usize, visit: &mut impl FnMut(Corner)) {
        let (below, above) = (self.obstacles.row(y - 1), self.obstacles.row(y));
        for word in first / 64..=last / 64 {
            let found = convex_corners(below, above, word);
            let from = if word == first / 64 { u64::MAX << (first % 64) } else { u64::MAX };
            let to = if word == last / 64 { u64::MAX >> (63 - last % 64) } else { u64::MAX };
            let mut bits = (found.single | found.between) & from & to;
            while bits != 0 {
                visit(Corner::new((word * 64) as i32 + bits.trailing_zeros() as i32, y));
                bits &= bits - 1;
            }
        }
    }
}

/// An edge of a hull, with its lower end first.
struct Edge {
    low: Point,
    high: Point,
    /// Change of column per line along the edge.
    slope: f64,
}

impl Edge {
    fn new(edge: Segment) -> Self {
        let (low, high) = if edge.a.y <= edge.b.y { (edge.a, edge.b) } else { (edge.b, edge.a) };
        let slope = (high.x - low.x) / (high.y - low.y);
        Self { low, high, slope }
    }

    /// The column of the edge at line `y`; outside its range, the column of `end`.
    fn column(&self, y: f64, end: Point) -> f64 {
        let is_beside = self.low.y < y && y < self.high.y;
        if is_beside { self.low.x + (y - self.low.y) * self.slope } else { end.x }
    }
}

/// The range of columns of a line that lie within `reach` of the hull of the edges, or slightly
/// more.
fn extent(edges: &[Edge], y: f64, reach: f64) -> (f64, f64) {
    let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
    for edge in edges {
        if edge.low.y > y + reach || edge.high.y < y - reach {
            continue;
        }
        // Both ends count for a horizontal edge.
        for x in [edge.column(y - reach, edge.low), edge.column(y + reach, edge.high)] {
            from = if x < from { x } else { from };
            to = if x > to { x } else { to };
        }
    }
    (from - reach, to + reach)
}
