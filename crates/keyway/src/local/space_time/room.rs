//! How much room a footprint has: nearly, and fast.

use super::lattice::Lattice;
use crate::geometry::Point;
use crate::map::{Cell, DistanceField};
use crate::robot::{Footprint, Robot};

/// Distances to what stands around the robot, and to the border of the map.
#[derive(Debug, Default)]
pub(super) struct Room {
    lattice: Lattice,
    distances_m: Vec<f32>,
}

impl Room {
    /// Takes the distances at the points of a lattice; 0 and less outside the map.
    pub(super) fn fill(&mut self, lattice: Lattice, obstacles: &DistanceField) {
        self.lattice = lattice;
        self.distances_m.clear();
        let frame = obstacles.frame();
        let (last_x, last_y) = (frame.width() as i32 - 1, frame.height() as i32 - 1);
        let cell_m = frame.resolution_m();
        for y in 0..lattice.side {
            for x in 0..lattice.side {
                let cell = lattice.cell(x, y);
                let Cell { x, y } = cell;
                let border = x.min(y).min(last_x - x).min(last_y - y);
                let border_m = (f64::from(border) + 0.5) * cell_m;
                let squared = obstacles.half_cells_sq(cell);
                let to_square_m = squared.map(|squared| 0.5 * cell_m * f64::from(squared).sqrt());
                self.distances_m.push(to_square_m.unwrap_or(border_m).min(border_m) as f32);
            }
        }
    }

    /// Distance of the points \[m\].
    pub(super) const fn spacing_m(&self) -> f64 {
        self.lattice.spacing_m
    }

    /// Open ground.
    #[cfg(test)]
    pub(super) fn open() -> Self {
        let frame = crate::map::GridFrame::new(1, 1, 0.05, crate::geometry::Pose::default());
        let lattice = Lattice::around(&frame.unwrap(), Point::new(0.5, 0.5), 1.0, 0.05);
        Self { lattice, distances_m: vec![9.0; lattice.count()] }
    }

    /// Distance of a point to what stands \[m\], interpolated.
    #[inline]
    pub(super) fn of_point(&self, at: Point) -> f64 {
        f64::from(self.lattice.value(&self.distances_m, at))
    }
}

/// A footprint as points on its outline.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// In their order, the first one again at the end; none for a disc.
    points: Vec<Point>,
    /// No two successive ones are farther apart \[m\].
    spacing_m: f64,
    pub(super) inscribed_m: f64,
    pub(super) circumscribed_m: f64,
}

impl Outline {
    /// Distance of two points on the outline, in inscribed radii.
    const SPACING: f64 = 0.6;

    /// Less room than this, in inscribed radii, is looked for between the points, too.
    const NEAR: f64 = 0.25;

    pub(super) fn of(robot: &Robot) -> Self {
        let footprint = &robot.footprint;
        let inscribed_m = footprint.inscribed_radius_m();
        let spacing_m = Self::SPACING * inscribed_m;
        let mut points = Vec::new();
        if let Footprint::Polygon(polygon) = footprint {
            let vertices = polygon.vertices();
            let ends = vertices.iter().cycle().skip(1);
            for (&from, &to) in vertices.iter().zip(ends) {
                let parts = (from.distance(to) / spacing_m).ceil().max(1.0);
                points.extend((0..parts as u32).map(|part| from.lerp(to, f64::from(part) / parts)));
            }
            points.extend(vertices.first().copied());
        }
        let circumscribed_m = footprint.circumscribed_radius_m();
        Self { points, spacing_m, inscribed_m, circumscribed_m }
    }

    /// No part of the footprint moves farther in a turn by a radian \[m\]; 0 for a disc, which covers the same ground.
    pub(super) fn swing_m(&self) -> f64 {
        if self.points.is_empty() { 0.0 } else { self.circumscribed_m }
    }

    /// Room between the footprint and what stands \[m\]; more than `enough_m` is not told apart. Negative where it touches.
    /// The footprint is at `at` and faces `ahead`, a direction of length 1.
    #[inline]
    pub(super) fn room_m(&self, room: &Room, at: Point, ahead: Point, enough_m: f64) -> f64 {
        let centre_m = room.of_point(at);
        if self.points.is_empty() || centre_m >= self.circumscribed_m + enough_m {
            return centre_m - self.circumscribed_m;
        }
        let of_core_m = centre_m - self.inscribed_m;
        if of_core_m <= 0.0 {
            return of_core_m;
        }
        let at_point_m = |point: Point| {
            let x = point.x * ahead.x - point.y * ahead.y;
            room.of_point(at + Point::new(x, point.x * ahead.y + point.y * ahead.x))
        };
        let near_m = Self::NEAR * self.inscribed_m;
        let mut nearest_m = enough_m.min(of_core_m);
        let mut last: Option<(Point, f64)> = None;
        for &point in &self.points {
            let room_m = at_point_m(point);
            nearest_m = nearest_m.min(room_m);
            if let Some((last, last_m)) = last {
                // Between the two it is no less than this.
                let between_m = 0.5 * (last_m + room_m - self.spacing_m);
                if between_m < nearest_m.min(near_m) {
                    let parts = [0.25, 0.5, 0.75].map(|part| at_point_m(last.lerp(point, part)));
                    nearest_m = parts.into_iter().fold(nearest_m, f64::min);
                }
            }
            last = Some((point, room_m));
        }
        nearest_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{CellState, Edit, FieldConfig, OccupancyGrid};
    use proptest::prelude::*;

    fn map(occupied: &[(i32, i32)]) -> OccupancyGrid {
        let mut map = OccupancyGrid::from_ascii(&["........................................"; 40]);
        let edit =
            |&(x, y): &(i32, i32)| Edit { cell: Cell::new(x, y), state: CellState::Occupied };
        map.apply(&occupied.iter().map(edit).collect::<Vec<_>>());
        map
    }

    proptest! {
        /// Compared with exact distances of the footprint.
        #[test]
        fn room_is_nearly_exact(
            cells in proptest::collection::vec((4..36, 4..36), 0..6),
            (x, y, theta) in (12.0..28.0, 12.0..28.0, -3.0..3.0_f64),
            is_round in any::<bool>(),
        ) {
            let map = map(&cells);
            let mut robot = Robot::jackal();
            // Cells of 1 m: a robot ten times as large.
            robot.footprint = if is_round { Footprint::circle(3.0).unwrap() } else { Footprint::rectangle(8.0, 5.0).unwrap() };
            let outline = Outline::of(&robot);
            let field = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
            let mut room = Room::default();
            let at = Point::new(x, y);
            room.fill(Lattice::around(map.frame(), at, 12.0, 1.0), &field);
            let pose = Pose::new(x, y, theta);
            let clearance = field.clearance();
            let exact_m = robot.footprint.distance_m(pose, &clearance, 20.0).min(robot.footprint.to_border_m(pose, &clearance));
            let (sin, cos) = libm::sincos(theta);
            let found_m = outline.room_m(&room, at, Point::new(cos, sin), 2.0);
            if exact_m > 0.0 {
                // Between points, a distance is off by up to half a cell beside a square, and by less elsewhere; the outline is
                // looked at every 0.375 m where it is near.
                prop_assert!((found_m.min(2.0) - exact_m.min(2.0)).abs() < 0.6, "{found_m} {exact_m}");
            } else {
                prop_assert!(found_m < 0.6, "{found_m}");
            }
        }
    }
}
