//! The leading edges of a footprint: its front, and its rear when the robot backs up.

use crate::geometry::Point;
use crate::map::{BitGrid, Cell, Clearance, GridFrame};
use crate::robot::{Footprint, Robot};
use std::f64::consts::PI;

/// Points on the rear of a footprint, in the robot's frame \[m\].
#[derive(Clone, Debug)]
pub(super) struct Rear {
    points: Vec<Point>,
}

/// Spacing of points of an outline, given in inscribed radii, but not much less than the length
/// of the footprint: one that turns around a point of its edge has no inscribed circle \[m\].
pub(super) fn spacing_m(footprint: &Footprint, inscribed_radii: f64) -> f64 {
    const LEAST_OF_CIRCUMSCRIBED: f64 = 0.02;
    let least_m = LEAST_OF_CIRCUMSCRIBED * footprint.circumscribed_radius_m();
    (inscribed_radii * footprint.inscribed_radius_m()).max(least_m)
}

impl Rear {
    /// Points of the rear of a footprint; successive points are at most this many inscribed radii
    /// apart.
    pub(super) fn of(footprint: &Footprint, spacing_radii: f64) -> Self {
        let points = match footprint {
            Footprint::Circle(circle) => half_circle(circle.radius_m(), spacing_radii, PI),
            Footprint::Polygon(_) => {
                let spacing_m = spacing_m(footprint, spacing_radii);
                let mut points = outline_points(footprint, spacing_m);
                // Includes the rearmost points of a footprint that is entirely ahead of its
                // centre of rotation.
                let rearmost_m = points.iter().map(|point| point.x).fold(f64::INFINITY, f64::min);
                points.retain(|point| point.x < 0.0 || point.x <= rearmost_m + 1e-9);
                points
            }
        };
        Self { points }
    }

    /// Combines the points with a grid of cells over which the robot may back up.
    pub(super) const fn over<'a>(&'a self, cells: &'a BitGrid, frame: &GridFrame) -> Seen<'a> {
        Seen { points: self.points.as_slice(), cells, cell_m: frame.resolution_m() }
    }
}

/// Points on the front of a footprint, in the robot's frame \[m\].
#[derive(Clone, Debug)]
pub(super) struct Front {
    points: Vec<Point>,
}

impl Front {
    /// A seen cell is free around its centre: half of its diagonal is kept from unknown ground
    /// \[cells\].
    const KEPT_CELLS: f64 = 0.75;

    /// The front of a robot; successive points are at most this many inscribed radii apart.
    /// Points of the sides are left out, as they follow the front, and so are those that no
    /// sensor sees, except for the foremost ones.
    pub(super) fn of(robot: &Robot, spacing_radii: f64) -> Self {
        let footprint = &robot.footprint;
        let mut points = match footprint {
            Footprint::Circle(circle) => half_circle(circle.radius_m(), spacing_radii, 0.0),
            Footprint::Polygon(_) => outline_points(footprint, spacing_m(footprint, spacing_radii)),
        };
        let foremost_m = footprint.foremost_m();
        let is_front = |point: &Point| point.x >= foremost_m.min(0.5 * foremost_m.max(0.0)) - 1e-9;
        let is_looked_at =
            |point: &Point| robot.sensors.iter().any(|sensor| sensor.looks_at(*point));
        let is_foremost = |point: &Point| point.x >= foremost_m - 1e-9;
        points.retain(|point| is_front(point) && (is_looked_at(point) || is_foremost(point)));
        Self { points }
    }

    /// Combines the points with a grid of cells that have been seen, among known obstacles.
    pub(super) const fn over<'a>(
        &'a self,
        cells: &'a BitGrid,
        known: Clearance<'a>,
    ) -> SeenAhead<'a> {
        let (obstacles, cell_m) = (known.obstacles(), known.frame().resolution_m());
        SeenAhead { points: self.points.as_slice(), cells, obstacles, cell_m }
    }
}

/// Points on the front of a footprint, and the cells within which they must stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenAhead<'a> {
    points: &'a [Point],
    cells: &'a BitGrid,
    obstacles: &'a BitGrid,
    cell_m: f64,
}

impl SeenAhead<'_> {
    /// True if all points stay in those cells; the next cell to either side counts as well, as an
    /// obstacle between two such points would be narrower than both. A point in such a cell may
    /// also come arbitrarily close to a known obstacle, and to the map's border: nothing else can
    /// be there. Arguments as for [`Seen::holds`].
    pub(super) fn holds(&self, at: Point, ahead: Point) -> bool {
        let kept = ahead * (Front::KEPT_CELLS * self.cell_m);
        let aside = Point::new(-ahead.y, ahead.x) * self.cell_m;
        self.points.iter().all(|&point| {
            let own = at + turned(point, ahead);
            let place = own + kept;
            let is_seen = |place| self.cells.get(cell_of(place, self.cell_m));
            [place, place + aside, place - aside].into_iter().any(is_seen)
                || is_seen(own) && self.is_end(cell_of(place, self.cell_m))
        })
    }

    /// True at a known obstacle or outside the map.
    #[inline]
    fn is_end(&self, cell: Cell) -> bool {
        !self.cells.contains(cell) || self.obstacles.get(cell)
    }
}

/// Rotates a point of a robot that faces `ahead`, a direction of length 1.
fn turned(point: Point, ahead: Point) -> Point {
    Point::new(point.x * ahead.x - point.y * ahead.y, point.x * ahead.y + point.y * ahead.x)
}

fn cell_of(place: Point, cell_m: f64) -> Cell {
    // Rounds down: for negative values that is one less than rounding towards 0.
    let along = |value: f64| {
        let cells = value / cell_m;
        let towards_0 = cells as i32;
        towards_0.saturating_sub(i32::from(cells < f64::from(towards_0)))
    };
    Cell::new(along(place.x), along(place.y))
}

fn half_circle(radius_m: f64, spacing_radii: f64, around_rad: f64) -> Vec<Point> {
    let parts = (PI / spacing_radii).ceil();
    let at = |part: u32| {
        let (sin, cos) = libm::sincos(around_rad + PI * (f64::from(part) / parts - 0.5));
        Point::new(cos, sin) * radius_m
    };
    (0..=parts as u32).map(at).collect()
}

/// Points along the edges of a polygon, at most `spacing_m` apart, with the first one repeated at
/// the end; empty for a disc.
pub(super) fn outline_points(footprint: &Footprint, spacing_m: f64) -> Vec<Point> {
    let Footprint::Polygon(polygon) = footprint else { return Vec::new() };
    let vertices = polygon.vertices();
    let ends = vertices.iter().cycle().skip(1);
    let mut points = Vec::new();
    for (&from, &to) in vertices.iter().zip(ends) {
        let parts = (from.distance(to) / spacing_m).ceil().max(1.0);
        points.extend((0..parts as u32).map(|part| from.lerp(to, f64::from(part) / parts)));
    }
    points.extend(vertices.first().copied());
    points
}

/// Points of a footprint, and the cells on which they may lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    points: &'a [Point],
    cells: &'a BitGrid,
    cell_m: f64,
}

impl Seen<'_> {
    /// Position of the rearmost point along the robot's axis, negative behind its centre \[m\].
    pub(super) fn rearmost_m(&self) -> f64 {
        self.points.iter().map(|point| point.x).fold(0.0, f64::min)
    }

    /// True if a position is on those cells.
    #[inline]
    pub(super) fn holds_point(&self, at: Point) -> bool {
        self.cells.get(cell_of(at, self.cell_m))
    }

    /// True if all points are on those cells. The robot is at `at`, from the lower-left corner of
    /// the grid \[m\], and faces `ahead`, a direction of length 1 on the grid.
    pub(super) fn holds(&self, at: Point, ahead: Point) -> bool {
        let mut places = self.points.iter().map(|&point| at + turned(point, ahead));
        places.all(|place| self.cells.get(cell_of(place, self.cell_m)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rear(footprint: &Footprint) -> Rear {
        Rear::of(footprint, 0.2)
    }

    #[test]
    fn the_rear_is_what_goes_ahead_backwards() {
        let rectangle = Footprint::rectangle(0.5, 0.4).unwrap();
        let disc = Footprint::circle(0.3).unwrap();
        for (footprint, back_m) in [(rectangle, 0.25), (disc, 0.3)] {
            let points = rear(&footprint).points;
            let farthest_m = points.iter().fold(0.0, |least: f64, point| least.min(point.x));
            assert!((farthest_m + back_m).abs() < 1e-12);
            assert!(points.iter().all(|point| point.x <= 1e-12) && points.len() > 10);
        }
    }

    /// A footprint that turns around a point of its edge.
    #[test]
    fn without_an_inscribed_circle_there_are_no_more_points() {
        for back_m in [1e-9, 0.0, -0.1] {
            let vertices = [[0.5, 0.2], [-back_m, 0.2], [-back_m, -0.2], [0.5, -0.2]];
            let footprint = Footprint::polygon(vertices.map(Point::from).to_vec()).unwrap();
            let points = rear(&footprint).points.len();
            assert!((20..50).contains(&points), "{back_m} {points}");
        }
    }
}
