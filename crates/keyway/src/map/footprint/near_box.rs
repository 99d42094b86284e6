//! Distances from a core to a box, at one pose and along a short straight motion. All lengths are
//! in cells.

use super::line::Line;
use super::turned::{Placement, Turned};
use crate::geometry::{Point, Segment};
use std::f64::consts::FRAC_1_SQRT_2;

/// A rectangle of obstacle squares.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearBox {
    pub(super) low: Point,
    pub(super) high: Point,
    /// Distance from the tile's middle.
    pub(super) from_middle: f64,
}

/// A core on a short straight motion without rotation: from `-half` to `half` of its middle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sweep<'a> {
    pub(crate) middle: Placement<'a>,
    pub(crate) half: Point,
    pub(crate) half_length: f64,
}

/// Bounds of a distance during such a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Apart {
    pub(crate) at_least: Line,
    pub(crate) at_most: Line,
}

/// Winding of a polygon's outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Winding {
    Left,
    Right,
    /// Not convex.
    Both,
}

impl Winding {
    pub(super) fn of(vertices: &[Point]) -> Self {
        let count = vertices.len();
        let turn = |i: usize| {
            let [a, b, c] = [i, i + 1, i + 2].map(|i| vertices[i % count]);
            (b - a).cross(c - b)
        };
        let (mut is_left, mut is_right) = (false, false);
        for turn in (0..count).map(turn) {
            is_left |= turn > 0.0;
            is_right |= turn < 0.0;
        }
        match (is_left, is_right) {
            (true, false) => Self::Left,
            (false, true) => Self::Right,
            _ => Self::Both,
        }
    }

    /// 1 for an outline that turns to the left, -1 for one that turns to the right. With this
    /// sign the normals of its edges point outwards.
    pub(super) const fn outward(self) -> Option<f64> {
        match self {
            Self::Left => Some(1.0),
            Self::Right => Some(-1.0),
            Self::Both => None,
        }
    }
}

/// Bounding box of a core at both ends of a motion. Each vertex moves straight from one end to
/// the other, so none leaves the box in between.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    low: Point,
    high: Point,
}

impl Frame {
    pub(super) fn of_both(from: &Placement<'_>, to: &Placement<'_>) -> Self {
        let [a, b] = [from, to].map(|at| {
            let Turned { left, right, lowest, highest, .. } = at.turned;
            (at.origin + Point::new(left.x, lowest.y), at.origin + Point::new(right.x, highest.y))
        });
        Self {
            low: -Point::new(larger(-a.0.x, -b.0.x), larger(-a.0.y, -b.0.y)),
            high: Point::new(larger(a.1.x, b.1.x), larger(a.1.y, b.1.y)),
        }
    }
}

impl<'a> Sweep<'a> {
    /// A core that is stationary.
    pub(super) fn still(middle: Placement<'a>) -> Self {
        Self { middle, half: Point::default(), half_length: 0.0 }
    }
}

/// A part of a motion, within -1 to 1.
#[derive(Clone, Copy, Debug)]
struct Part {
    begin: f64,
    end: f64,
}

impl Part {
    const WHOLE: Self = Self { begin: -1.0, end: 1.0 };

    /// Keeps the part in which a value that grows at `rate` is at least `at_least`; `None` if
    /// nothing is left.
    #[inline]
    fn keep(&mut self, rate: f64, at_least: f64) -> Option<()> {
        if rate > 0.0 {
            self.begin = larger(self.begin, at_least / rate);
        } else if rate < 0.0 {
            self.end = -larger(-self.end, -(at_least / rate));
        } else if at_least > 0.0 {
            return None;
        }
        (self.begin <= self.end).then_some(())
    }

    /// The smallest part that contains both.
    fn hull(self, other: Self) -> Self {
        Self { begin: self.begin.min(other.begin), end: self.end.max(other.end) }
    }
}

/// Length of a shortest connection, and the tangent of that length at the middle of the motion of
/// a core.
#[inline]
fn tangent(sweep: &Sweep<'_>, shortest: Point) -> (f64, Line) {
    let distance = length(shortest);
    let nearer = if distance > 0.0 { shortest.dot(sweep.half) / distance } else { 0.0 };
    (distance, Line { begin: distance + nearer, end: distance - nearer })
}

/// Length of a vector that is often parallel to an axis: then no root is taken.
#[inline]
fn length(way: Point) -> f64 {
    if way.y == 0.0 {
        way.x.abs()
    } else if way.x == 0.0 {
        way.y.abs()
    } else {
        way.norm()
    }
}

/// The larger of two numbers, the second one if the first is NaN: one instruction, unlike
/// [`f64::max`].
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

impl NearBox {
    /// Vector of the shortest connection from a point to the box; 0 inside.
    pub(super) fn way_to_point(&self, point: Point) -> Point {
        let beside = |low: f64, high: f64, at: f64| {
            if at < low {
                low - at
            } else if at > high {
                high - at
            } else {
                0.0
            }
        };
        Point::new(
            beside(self.low.x, self.high.x, point.x),
            beside(self.low.y, self.high.y, point.y),
        )
    }

    /// Bounds of the distance from a core during a short motion, if it may be less than a limit.
    ///
    /// The distance between two convex shapes is a convex function of their positions. It is
    /// therefore never less than its tangent at the middle of the motion, whose slope is the
    /// share of the motion that leads towards the box. The distance of a convex part of the core,
    /// one vertex or edge, is never more than the straight line between its values at both ends
    /// of the motion, and no core is farther away than a part of it. For a vertex that stays
    /// beside one face, both bounds equal the distance.
    #[inline]
    pub(super) fn apart(&self, sweep: &Sweep<'_>, winding: Winding, limit: f64) -> Option<Apart> {
        let at = &sweep.middle;
        let Turned { left, right, lowest, highest, vertices } = at.turned;
        let near = Self { low: self.low - at.origin, high: self.high - at.origin, ..*self };
        let (low, high) = (near.low, near.high);
        // A bounding box of the core that touches it at these four vertices is not farther away.
        let (beside, vertex_x) = if left.x >= high.x {
            (high.x - left.x, left)
        } else {
            (larger(low.x - right.x, 0.0), right)
        };
        let (above, vertex_y) = if lowest.y >= high.y {
            (high.y - lowest.y, lowest)
        } else {
            (larger(low.y - highest.y, 0.0), highest)
        };
        let to_frame = Point::new(beside, above);
        let limit = limit + sweep.half_length;
        if to_frame.norm_sq() >= limit * limit {
            return None;
        }
        // Usually such a vertex is the nearest.
        let is_level = |vertex: &Point| vertex.y >= low.y && vertex.y <= high.y;
        let is_upright = |vertex: &Point| vertex.x >= low.x && vertex.x <= high.x;
        if vertices.is_empty() || beside != 0.0 && above == 0.0 && is_level(vertex_x) {
            return Some(near.apart_at(sweep, to_frame, *vertex_x));
        }
        if above != 0.0 && beside == 0.0 && is_upright(vertex_y) {
            return Some(near.apart_at(sweep, to_frame, *vertex_y));
        }
        let is_apart = beside != 0.0 || above != 0.0;
        let Some(outward) = winding.outward() else {
            return Some(near.apart_from_any(sweep));
        };
        near.apart_from_convex(sweep, outward, is_apart, limit)
    }

    /// A part of a motion, within -1 to 1, during which a core is nearer than a distance to the
    /// box, if one is found.
    pub(super) fn meets(
        &self,
        sweep: &Sweep<'_>,
        winding: Winding,
        distance: f64,
    ) -> Option<[f64; 2]> {
        let is_point = sweep.middle.turned.vertices.is_empty();
        let part = if is_point {
            self.meets_point(sweep, distance)
        } else {
            self.meets_convex(sweep, winding.outward()?)
        };
        part.map(|Part { begin, end }| [begin, end])
    }

    /// Like [`Self::meets`], for the centre alone. The area within the distance is convex. It
    /// contains the box grown along either axis, and the box grown by less along both.
    fn meets_point(&self, sweep: &Sweep<'_>, distance: f64) -> Option<Part> {
        let Sweep { middle, half, .. } = sweep;
        let (low, high) = (self.low - middle.origin, self.high - middle.origin);
        let meets = |x: f64, y: f64| {
            let mut part = Part::WHOLE;
            part.keep(half.x, low.x - x)?;
            part.keep(-half.x, -high.x - x)?;
            part.keep(half.y, low.y - y)?;
            part.keep(-half.y, -high.y - y)?;
            Some(part)
        };
        let less = distance * FRAC_1_SQRT_2;
        let parts = [meets(distance, 0.0), meets(0.0, distance), meets(less, less)];
        parts.into_iter().flatten().reduce(Part::hull)
    }

    /// Like [`Self::meets`], for a convex core; for `outward` see [`Winding::outward`].
    ///
    /// Core and box meet unless a line along a side of either separates them. Each of these lines
    /// restricts the motion to a part.
    fn meets_convex(&self, sweep: &Sweep<'_>, outward: f64) -> Option<Part> {
        let Placement { origin, turned } = sweep.middle;
        let near = Self { low: self.low - origin, high: self.high - origin, ..*self };
        let (low, high, half) = (near.low, near.high, sweep.half);
        let mut part = Part::WHOLE;
        part.keep(half.x, low.x - turned.right.x)?;
        part.keep(-half.x, turned.left.x - high.x)?;
        part.keep(half.y, low.y - turned.highest.y)?;
        part.keep(-half.y, turned.lowest.y - high.y)?;
        let mut a = *turned.vertices.last()?;
        for &b in &turned.vertices {
            let along = b - a;
            let normal = Point::new(along.y * outward, -along.x * outward);
            part.keep(normal.dot(half), normal.dot(near.nearest_corner(normal) - a))?;
            a = b;
        }
        Some(part)
    }

    /// Bounds for a convex core whose nearest point may be anywhere on its outline, with the box
    /// given relative to the centre of rotation. For `outward` see [`Winding::outward`].
    ///
    /// If a line along an edge separates the core from the box, its distance from the box is that
    /// of the box's nearest corner. If that corner is beside the edge, nothing is nearer. If it
    /// is beside no edge, a vertex is the nearest, unless no line along a side of either
    /// separates them: then they meet.
    fn apart_from_convex(
        &self,
        sweep: &Sweep<'_>,
        outward: f64,
        mut is_apart: bool,
        limit: f64,
    ) -> Option<Apart> {
        let vertices = &sweep.middle.turned.vertices;
        let mut a = vertices[vertices.len() - 1];
        for &b in vertices {
            let along = b - a;
            let normal = Point::new(along.y * outward, -along.x * outward);
            let corner = self.nearest_corner(normal) - a;
            let off = normal.dot(corner);
            if off > 0.0 {
                let (ahead, length_sq) = (along.dot(corner), along.norm_sq());
                if off * off >= limit * limit * length_sq {
                    return None;
                }
                if ahead > 0.0 && ahead < length_sq {
                    let shortest = normal * (off / length_sq);
                    return Some(self.apart_on(sweep, shortest, Segment::new(a, b)));
                }
                is_apart = true;
            }
            a = b;
        }
        if !is_apart {
            return Some(Apart {
                at_least: Line::level(0.0),
                at_most: Line::level(sweep.half_length),
            });
        }
        let mut nearest = (Point::default(), Point::default(), f64::INFINITY);
        for &vertex in vertices {
            let shortest = self.way_to_point(vertex);
            let length_sq = shortest.norm_sq();
            if length_sq < nearest.2 {
                nearest = (shortest, vertex, length_sq);
            }
        }
        (nearest.2 < limit * limit).then(|| self.apart_at(sweep, nearest.0, nearest.1))
    }

    /// Bounds for any polygon: no part of it gets nearer or farther by more than it moves.
    fn apart_from_any(&self, sweep: &Sweep<'_>) -> Apart {
        let at = Placement { origin: Point::default(), ..sweep.middle };
        let to_edge = |edge| self.way_to_edge(edge).norm_sq();
        let distance = at.edges().map(to_edge).fold(f64::INFINITY, f64::min).sqrt();
        Apart {
            at_least: Line::level(distance - sweep.half_length),
            at_most: Line::level(distance + sweep.half_length),
        }
    }

    /// Bounds if a vertex is nearest, with the shortest connection from it to the box.
    #[inline]
    fn apart_at(&self, sweep: &Sweep<'_>, shortest: Point, vertex: Point) -> Apart {
        let (distance, at_least) = tangent(sweep, shortest);
        if sweep.half_length == 0.0 {
            return Apart { at_least, at_most: Line::level(distance) };
        }
        let from = |point: Point| length(self.way_to_point(point));
        let at_most = Line { begin: from(vertex - sweep.half), end: from(vertex + sweep.half) };
        Apart { at_least, at_most }
    }

    /// Bounds if the inside of an edge is nearest.
    #[inline]
    fn apart_on(&self, sweep: &Sweep<'_>, shortest: Point, edge: Segment) -> Apart {
        let (distance, at_least) = tangent(sweep, shortest);
        if sweep.half_length == 0.0 {
            return Apart { at_least, at_most: Line::level(distance) };
        }
        let from = |by: Point| length(self.way_to_edge(Segment::new(edge.a + by, edge.b + by)));
        let at_most = Line { begin: from(-sweep.half), end: from(sweep.half) };
        Apart { at_least, at_most }
    }

    /// Vector of the shortest connection from an edge to the box; 0 if they meet.
    ///
    /// Two convex shapes that do not meet are nearest at a corner of one of them. Among the box's
    /// corners this can only be the one nearest to the edge's line.
    #[inline]
    pub(super) fn way_to_edge(&self, Segment { a, b }: Segment) -> Point {
        let along = b - a;
        let (low, high) = (self.low - a, self.high - a);
        let is_left = along.cross(low + high) >= 0.0;
        let corner = Point::new(
            if (along.y > 0.0) == is_left { high.x } else { low.x },
            if (along.x > 0.0) == is_left { low.y } else { high.y },
        );
        let normal =
            if is_left { Point::new(-along.y, along.x) } else { Point::new(along.y, -along.x) };
        // Distance of the corner from the line, times the edge's length; at most 0 if the line
        // meets the box.
        let off = normal.dot(corner);
        let (ahead, length_sq) = (along.dot(corner), along.norm_sq());
        if off > 0.0 && ahead > 0.0 && ahead < length_sq {
            return normal * (off / length_sq);
        }
        let meet = |a: f64, b: f64, low: f64, high: f64| a.max(b) >= low && a.min(b) <= high;
        if off <= 0.0
            && meet(a.x, b.x, self.low.x, self.high.x)
            && meet(a.y, b.y, self.low.y, self.high.y)
        {
            return Point::default();
        }
        let (from_a, from_b) = (self.way_to_point(a), self.way_to_point(b));
        if from_a.norm_sq() <= from_b.norm_sq() { from_a } else { from_b }
    }

    /// True if a frame is at least this distance to the left, to the right, above or below:
    /// everything in it then keeps the distance.
    #[inline]
    pub(super) fn is_beside(&self, frame: &Frame, distance: f64) -> bool {
        let (before, after) = (self.low - frame.high, frame.low - self.high);
        larger(larger(before.x, after.x), larger(before.y, after.y)) >= distance
    }

    /// True if a whole convex core surely keeps a distance during a motion; for `outward` see
    /// [`Winding::outward`].
    ///
    /// It does if, at both ends, all its vertices are that far from the box on the other side of
    /// a line: along one of the edges at the middle of the motion, or across the shortest
    /// connection from a vertex.
    pub(super) fn is_kept_by_convex(
        &self,
        [from, to]: [&Placement<'_>; 2],
        outward: f64,
        distance: f64,
    ) -> bool {
        let is_across = |normal: Point, least: f64| {
            let free = normal.dot(self.nearest_corner(normal)) - least;
            [from, to].into_iter().all(|at| {
                let most = free - normal.dot(at.origin);
                at.turned.vertices.iter().all(|&vertex| normal.dot(vertex) <= most)
            })
        };
        let vertices = from.turned.vertices.iter().zip(&to.turned.vertices);
        let origin = from.origin + to.origin;
        let mut half_way = vertices.map(|(&from, &to)| (origin + from + to) * 0.5);
        let Some(first) = half_way.next() else {
            return false;
        };
        let (mut a, mut shortest) = (first, self.way_to_point(first));
        for b in half_way.chain([first]) {
            let along = b - a;
            let normal = Point::new(along.y * outward, -along.x * outward);
            let off = normal.dot(self.nearest_corner(normal) - a);
            if off > 0.0 && is_across(normal, distance * normal.norm()) {
                return true;
            }
            let way = self.way_to_point(b);
            if way.norm_sq() < shortest.norm_sq() {
                shortest = way;
            }
            a = b;
        }
        shortest != Point::default() && is_across(shortest, distance * shortest.norm())
    }

    /// The corner that is the least far in a direction.
    #[inline]
    fn nearest_corner(&self, direction: Point) -> Point {
        Point::new(
            if direction.x > 0.0 { self.low.x } else { self.high.x },
            if direction.y > 0.0 { self.low.y } else { self.high.y },
        )
    }

    /// True if a moving edge keeps a distance; see [`NearObstacles::is_kept`].
    pub(super) fn is_kept_by(&self, from: Segment, to: Segment, distance: f64) -> bool {
        let half_way = Segment::new(from.a.lerp(to.a, 0.5), from.b.lerp(to.b, 0.5));
        let shortest = self.way_to_edge(half_way);
        let apart = shortest.norm();
        if apart <= 0.0 {
            return false;
        }
        let towards = shortest * (1.0 / apart);
        let box_at = towards.dot(self.nearest_corner(towards));
        [from.a, from.b, to.a, to.b].iter().all(|&end| box_at - towards.dot(end) >= distance)
    }
}
