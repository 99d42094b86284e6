//! The homotopy class of a line, and the test that it is the shortest of its class. Exact: corners
//! and centres of cells are whole numbers of half cells.
//!
//! In the universal cover of the free plane, no two locally shortest lines have the same ends. So
//! a line is the shortest of its class if it is free, straight between corners of obstacles, and
//! bends around each on the obstacle's side.

use keyway::geometry::{Point, Polyline};
use keyway::map::Cell;

/// The obstacles of a map: blocked cells that touch, even at a corner, are one.
pub(crate) struct Obstacles {
    width: i32,
    height: i32,
    blocked: Vec<bool>,
    /// Origins of the upward rays, one in each obstacle, from left to right, no two in a line.
    rays: Vec<(f64, f64)>,
}

impl Obstacles {
    pub(crate) fn new(width: i32, height: i32, is_blocked: impl Fn(Cell) -> bool) -> Self {
        let cells = (0..height).flat_map(|y| (0..width).map(move |x| Cell::new(x, y)));
        let blocked: Vec<bool> = cells.map(is_blocked).collect();
        let mut map = Self { width, height, blocked, rays: Vec::new() };
        let mut is_seen = vec![false; map.blocked.len()];
        for first in 0..map.blocked.len() {
            if !map.blocked[first] || std::mem::replace(&mut is_seen[first], true) {
                continue;
            }
            let (x, y) = (first as i32 % width, first as i32 / width);
            // Rays are off the middle of their cell, each by a different share of it.
            let shift = (map.rays.len() as f64 * 0.618_033_988_749_894_9).fract();
            map.rays.push((f64::from(x) + 0.05 + 0.4 * shift, f64::from(y) + 0.5));
            let mut open = vec![(x, y)];
            while let Some((x, y)) = open.pop() {
                for (x, y) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy))) {
                    let at = (y * width + x) as usize;
                    if map.is_blocked(x, y) && !std::mem::replace(&mut is_seen[at], true) {
                        open.push((x, y));
                    }
                }
            }
        }
        map.rays.sort_by(|a, b| a.0.total_cmp(&b.0));
        map
    }

    /// False outside the map.
    fn is_blocked(&self, x: i32, y: i32) -> bool {
        let is_inside = x >= 0 && y >= 0 && x < self.width && y < self.height;
        is_inside && self.blocked[(y * self.width + x) as usize]
    }

    /// The rays that a line \[cells\] crosses, with the direction; crossings there and back again
    /// cancel. Two lines with the same ends can be pulled into each other if and only if their
    /// classes are equal.
    pub(crate) fn class(&self, line: &Polyline) -> Vec<(usize, bool)> {
        let mut word = Vec::new();
        for segment in line.segments() {
            let (a, b) = (segment.a, segment.b);
            let is_rightwards = a.x < b.x;
            let (left, right) = if is_rightwards { (a, b) } else { (b, a) };
            let first = self.rays.partition_point(|ray| ray.0 <= left.x);
            let end = self.rays.partition_point(|ray| ray.0 <= right.x);
            let mut cross = |ray: usize| {
                let (x, y) = self.rays[ray];
                if left.lerp(right, (x - left.x) / (right.x - left.x)).y <= y {
                    return;
                }
                if word.last() == Some(&(ray, !is_rightwards)) {
                    word.pop();
                } else {
                    word.push((ray, is_rightwards));
                }
            };
            if is_rightwards {
                (first..end).for_each(&mut cross);
            } else {
                (first..end).rev().for_each(&mut cross);
            }
        }
        word
    }

    /// The reason why a line \[cells\] is not the shortest of its class.
    pub(crate) fn flaw(&self, line: &Polyline) -> Option<String> {
        let points: Vec<Half> =
            line.points().iter().map(|&p| Half::new(p)).collect::<Option<_>>()?;
        for pair in points.windows(2) {
            if !self.is_free(pair[0], pair[1]) {
                return Some(format!("{pair:?} is not free"));
            }
        }
        for turn in points.windows(3) {
            let (came, goes) = (turn[1].from(turn[0]), turn[2].from(turn[1]));
            if !self.bends_around(turn[1], came, goes) {
                return Some(format!("{turn:?} bends around nothing"));
            }
        }
        None
    }

    /// True if all points of a line are corners or centres of cells.
    pub(crate) fn is_exact(line: &Polyline) -> bool {
        line.points().iter().all(|&point| Half::new(point).is_some())
    }

    fn bends_around(&self, at: Half, came: Half, goes: Half) -> bool {
        let is_corner = at.x % 2 == 0 && at.y % 2 == 0;
        let is_inside = at.x > 0
            && at.y > 0
            && at.x < 2 * i64::from(self.width)
            && at.y < 2 * i64::from(self.height);
        let side = came.cross(goes).signum();
        is_corner
            && is_inside
            && [(-1, -1), (0, -1), (-1, 0), (0, 0)].into_iter().any(|(dx, dy)| {
                let inner = Half { x: 2 * dx + 1, y: 2 * dy + 1 };
                self.is_blocked((at.x / 2 + dx) as i32, (at.y / 2 + dy) as i32)
                    && side * came.cross(inner) > 0
                    && side * goes.cross(inner) > 0
            })
    }

    /// True if a straight line stays in the map, enters no obstacle, and does not pass between two
    /// blocked cells that it touches at the same point.
    fn is_free(&self, a: Half, b: Half) -> bool {
        let is_inside = |p: Half| {
            (0..=2 * i64::from(self.width)).contains(&p.x)
                && (0..=2 * i64::from(self.height)).contains(&p.y)
        };
        is_inside(a)
            && is_inside(b)
            && self.enters_nothing(a, b)
            && self.slips_through_nothing(a, b)
    }

    fn enters_nothing(&self, a: Half, b: Half) -> bool {
        if a.x == b.x {
            // A vertical line enters nothing on the edge of a column; otherwise its column counts.
            let rows = a.y.min(b.y).div_euclid(2)..=(a.y.max(b.y) - 1).div_euclid(2);
            return a.x % 2 == 0
                || rows.into_iter().all(|y| !self.is_blocked((a.x / 2) as i32, y as i32));
        }
        let (a, b) = if a.x < b.x { (a, b) } else { (b, a) };
        let way = b.from(a);
        // The row coordinate at a column coordinate, over 2 `way.x`.
        let row_at = |x: i64| a.y * way.x + (x - a.x) * way.y;
        (a.x.div_euclid(2)..=(b.x - 1).div_euclid(2)).all(|x| {
            let ends = [row_at(a.x.max(2 * x)), row_at(b.x.min(2 * x + 2))];
            let first = ends[0].min(ends[1]).div_euclid(2 * way.x);
            let last = -(-ends[0].max(ends[1])).div_euclid(2 * way.x) - 1;
            (first..=last).all(|y| !self.is_blocked(x as i32, y as i32))
        })
    }

    /// Corners of cells on the line, and edges of cells along it.
    fn slips_through_nothing(&self, a: Half, b: Half) -> bool {
        let way = b.from(a);
        let steps = gcd(way.x.abs(), way.y.abs());
        let unit = Half { x: way.x / steps.max(1), y: way.y / steps.max(1) };
        (0..=steps).all(|k| {
            let at = Half { x: a.x + k * unit.x, y: a.y + k * unit.y };
            let around = |dx: i64, dy: i64| {
                let (x, y) = ((at.x + dx).div_euclid(2), (at.y + dy).div_euclid(2));
                self.is_blocked(x as i32, y as i32)
            };
            // For a point between two corners along an edge, a cell beyond the border counts as
            // blocked.
            let beyond = |dx: i64, dy: i64| {
                let (x, y) = ((at.x + dx).div_euclid(2) as i32, (at.y + dy).div_euclid(2) as i32);
                x < 0 || y < 0 || x >= self.width || y >= self.height || self.is_blocked(x, y)
            };
            let is_passed = k > 0 && k < steps;
            match (at.x % 2 == 0, at.y % 2 == 0) {
                (true, true) if is_passed => {
                    !(around(-1, -1) && around(0, 0) || around(-1, 0) && around(0, -1))
                }
                (true, false) if way.x == 0 && is_passed => {
                    !(beyond(-1, 0) && beyond(0, 0) && (around(-1, 0) || around(0, 0)))
                }
                (false, true) if way.y == 0 && is_passed => {
                    !(beyond(0, -1) && beyond(0, 0) && (around(0, -1) || around(0, 0)))
                }
                _ => true,
            }
        })
    }
}

/// A point, or a vector, in half cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Half {
    pub(crate) x: i64,
    pub(crate) y: i64,
}

impl Half {
    /// `None` for points that are neither corners nor centres of cells.
    pub(crate) fn new(cells: Point) -> Option<Self> {
        let (x, y) = ((2.0 * cells.x).round(), (2.0 * cells.y).round());
        let is_near = (2.0 * cells.x - x).abs() < 1e-6 && (2.0 * cells.y - y).abs() < 1e-6;
        is_near.then_some(Self { x: x as i64, y: y as i64 })
    }

    pub(crate) fn from(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y }
    }

    pub(crate) fn cross(self, other: Self) -> i64 {
        self.x * other.y - self.y * other.x
    }
}

fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
