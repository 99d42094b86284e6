//! Clearance of a footprint: approximate, and fast.

use super::lattice::Lattice;
use crate::geometry::{Point, Pose};
use crate::local::rear::{outline_points, spacing_m};
use crate::map::{Cell, DistanceField};
use crate::robot::{Footprint, Robot};
use std::f64::consts::SQRT_2;

/// Distances to the obstacles around the robot, and to the border of the map.
#[derive(Debug, Default)]
pub(super) struct Room {
    lattice: Lattice,
    distances_m: Vec<f32>,
}

impl Room {
    /// Largest excess of an interpolated distance between points that are a metre apart; it
    /// occurs at the corner of a square in the middle between four points \[m\].
    const EXCESS: f64 = 0.427;

    /// Fills in the distances at the points of a lattice; 0 and less outside the map.
    ///
    /// If cells are divided, the robot is no larger than the error of interpolation. Distances up
    /// to `enough_m` are then reduced so that no interpolated one is too large.
    pub(super) fn fill(&mut self, lattice: Lattice, obstacles: &DistanceField, enough_m: f64) {
        self.lattice = lattice;
        self.distances_m.clear();
        if lattice.is_of_centres() {
            for y in 0..lattice.side {
                self.fill_row(y, obstacles);
            }
            return;
        }
        let excess_m = Self::EXCESS * lattice.spacing_m;
        let near_m = enough_m + obstacles.frame().resolution_m();
        for y in 0..lattice.side {
            let (mut cell, mut of_cell_m) = (None, 0.0);
            for x in 0..lattice.side {
                let its_cell = lattice.cell(x, y);
                if cell.replace(its_cell) != Some(its_cell) {
                    of_cell_m = of_centre_m(its_cell, obstacles);
                }
                let mut room_m = of_cell_m;
                if room_m < near_m {
                    room_m = exact_m(lattice.position(x, y), obstacles, enough_m) - excess_m;
                }
                self.distances_m.push(room_m as f32);
            }
        }
    }

    /// Fills in a row of points that are centres of cells: those before the map, on it, and after
    /// it.
    fn fill_row(&mut self, y: usize, obstacles: &DistanceField) {
        let (lattice, frame) = (self.lattice, obstacles.frame());
        let Cell { x: low, y: row } = lattice.cell(0, y);
        let stride = lattice.stride();
        let points_before = |column: i32| {
            let columns = (column - low).max(0) as usize;
            columns.div_ceil(stride).min(lattice.side)
        };
        let squares = obstacles.row_squares(row).unwrap_or_default();
        let (first, end) = (points_before(0), points_before(squares.len() as i32));
        let (first, end) = if squares.is_empty() { (0, 0) } else { (first, end) };
        let outside = |x: usize| of_centre_m(lattice.cell(x, y), obstacles) as f32;
        self.distances_m.extend((0..first).map(outside));
        if first < end {
            let from = (low + (first * stride) as i32) as usize;
            let (last, to_rows) =
                (squares.len() as i32 - 1, row.min(frame.height() as i32 - 1 - row));
            let cell_m = frame.resolution_m() as f32;
            let room_m = |(point, &squared): (usize, &i32)| {
                let x = (from + point * stride) as i32;
                let border_m = (x.min(last - x).min(to_rows) as f32 + 0.5) * cell_m;
                let cells = if squared == 0 { -0.5 } else { 0.5 * (squared as f32).sqrt() };
                border_m.min(cells * cell_m)
            };
            let squares = squares[from..].iter();
            if stride == 1 {
                self.distances_m.extend(squares.take(end - first).enumerate().map(room_m));
            } else {
                let squares = squares.step_by(stride).take(end - first);
                self.distances_m.extend(squares.enumerate().map(room_m));
            }
        }
        self.distances_m.extend((end..lattice.side).map(outside));
    }

    /// Largest deficit of distances between the points \[m\]: in the middle of four of them, in a
    /// narrow passage.
    fn too_small_by_m(&self) -> f64 {
        let reduced = if self.lattice.is_of_centres() { 0.0 } else { Self::EXCESS };
        (0.5 * SQRT_2 + reduced) * self.lattice.spacing_m
    }

    /// Spacing of the points \[m\].
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

    /// Distance of a point to obstacles \[m\], interpolated.
    #[inline]
    pub(super) fn of_point(&self, at: Point) -> f64 {
        self.lattice.value(&self.distances_m, at)
    }
}

/// Distance of the centre of a cell to obstacles and to the border \[m\]; below 0 outside the
/// map, and minus half a cell in an occupied cell, so that the interpolated distance is 0 at its
/// side.
fn of_centre_m(cell: Cell, obstacles: &DistanceField) -> f64 {
    let frame = obstacles.frame();
    let (last_x, last_y) = (frame.width() as i32 - 1, frame.height() as i32 - 1);
    let border = cell.x.min(cell.y).min(last_x - cell.x).min(last_y - cell.y);
    let border_m = (f64::from(border) + 0.5) * frame.resolution_m();
    let to_square = |squared: u32| match squared {
        0 => -0.5 * frame.resolution_m(),
        _ => 0.5 * frame.resolution_m() * f64::from(squared).sqrt(),
    };
    obstacles.half_cells_sq(cell).map_or(border_m, to_square).min(border_m)
}

/// The same for any point along the axes of the cells.
fn exact_m(at: Point, obstacles: &DistanceField, enough_m: f64) -> f64 {
    let frame = obstacles.frame();
    let cell_m = frame.resolution_m();
    let (width_m, height_m) =
        (f64::from(frame.width()) * cell_m, f64::from(frame.height()) * cell_m);
    let border_m = at.x.min(at.y).min(width_m - at.x).min(height_m - at.y);
    let world = frame.world_from_grid(at * (1.0 / cell_m));
    obstacles.clearance().of_point(world, enough_m).min(border_m)
}

/// The footprint itself, for poses at which interpolation is too rough: in the middle of a narrow
/// passage whose sides are nearer to the points beside it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exact<'a> {
    pub(super) footprint: &'a Footprint,
    pub(super) obstacles: &'a DistanceField,
}

impl Exact<'_> {
    /// Clearance between the footprint and obstacles \[m\], up to `enough_m`; 0 on contact. The
    /// result is rounded: rounding errors must not decide between two trajectories.
    fn room_m(&self, (at, ahead): (Point, Point), enough_m: f64) -> f64 {
        let (frame, clearance) = (self.obstacles.frame(), self.obstacles.clearance());
        let world = frame.world_from_grid(at * frame.resolution_m().recip());
        let theta = libm::atan2(ahead.y, ahead.x) + frame.origin().theta;
        let pose = Pose { x: world.x, y: world.y, theta };
        let border_m = self.footprint.to_border_m(pose, &clearance);
        let room_m = self.footprint.distance_m(pose, &clearance, enough_m).min(border_m);
        f64::from(room_m as f32)
    }
}

/// A footprint as points on its outline.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// In order, with the first one repeated at the end; empty for a disc.
    points: Vec<Point>,
    /// Upper limit of the distance between successive points \[m\].
    spacing_m: f64,
    pub(super) inscribed_m: f64,
    pub(super) circumscribed_m: f64,
}

impl Outline {
    /// Distance between two points on the outline, in inscribed radii.
    pub(super) const SPACING: f64 = 0.6;

    /// Below this clearance, in inscribed radii, the outline is also checked between the points.
    const NEAR: f64 = 0.25;

    /// Largest slope of interpolated distances per metre: one along each axis.
    const STEEPEST: f64 = SQRT_2;

    pub(super) fn of(robot: &Robot) -> Self {
        let footprint = &robot.footprint;
        let spacing_m = spacing_m(footprint, Self::SPACING);
        Self {
            points: outline_points(footprint, spacing_m),
            spacing_m,
            inscribed_m: footprint.inscribed_radius_m(),
            circumscribed_m: footprint.circumscribed_radius_m(),
        }
    }

    /// Largest motion of any part of the footprint in a turn by a radian \[m\]; 0 for a disc,
    /// which covers the same ground.
    pub(super) fn swing_m(&self) -> f64 {
        if self.points.is_empty() { 0.0 } else { self.circumscribed_m }
    }

    /// Clearance between the footprint and obstacles \[m\]. Values below `least_m` are not
    /// distinguished, nor are those above `enough_m`. Negative on contact. The footprint is at
    /// `at` and faces `ahead`, a direction of length 1.
    #[inline]
    pub(super) fn room_m(
        &self,
        room: &Room,
        (at, ahead): (Point, Point),
        (least_m, enough_m): (f64, f64),
    ) -> f64 {
        let centre_m = room.of_point(at);
        if self.points.is_empty() || centre_m >= self.circumscribed_m + enough_m {
            return centre_m - self.circumscribed_m;
        }
        let of_core_m = centre_m - self.inscribed_m;
        if of_core_m <= 0.0 {
            return of_core_m;
        }
        let bounds_m = (least_m, enough_m.min(of_core_m));
        let lattice = &room.lattice;
        let (place, ahead) = (lattice.place(at), ahead * (1.0 / lattice.spacing_m));
        let left = Point::new(-ahead.y, ahead.x);
        let on_lattice = |point: Point| place + ahead * point.x + left * point.y;
        // Most footprints are not near the edge of the lattice.
        if lattice.holds(place, self.circumscribed_m) {
            let at_point_m = |point| lattice.value_within(&room.distances_m, on_lattice(point));
            self.along_m(bounds_m, at_point_m)
        } else {
            self.along_m(bounds_m, |point| lattice.value_at(&room.distances_m, on_lattice(point)))
        }
    }

    /// The same, but exact if the footprint is nearly too close to something: if the approximate
    /// value would be below `least_m`, or not much more.
    pub(super) fn exact_room_m(
        &self,
        (room, exact): (&Room, Exact<'_>),
        posed: (Point, Point),
        (least_m, enough_m): (f64, f64),
    ) -> f64 {
        let off_m = room.too_small_by_m();
        let roughly_m = self.room_m(room, posed, (least_m - off_m, enough_m));
        if (roughly_m - least_m).abs() > off_m {
            return roughly_m;
        }
        match exact.room_m(posed, enough_m) {
            exact_m if exact_m > 0.0 => exact_m,
            _ => roughly_m.min(0.0),
        }
    }

    /// The least of the distances along the outline. Values below the first bound are not
    /// distinguished, nor are those above the second.
    #[inline]
    fn along_m(&self, (least_m, most_m): (f64, f64), at_point_m: impl Fn(Point) -> f64) -> f64 {
        let (falls_m, near_m) = (Self::STEEPEST * self.spacing_m, Self::NEAR * self.inscribed_m);
        let mut nearest_m = most_m;
        let mut last: Option<(Point, f64)> = None;
        for &point in &self.points {
            if nearest_m < least_m {
                break;
            }
            let room_m = at_point_m(point);
            nearest_m = if room_m < nearest_m { room_m } else { nearest_m };
            if let Some((last, last_m)) = last {
                // Lower bound between the two points.
                let between_m = 0.5 * (last_m + room_m - falls_m);
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
    use crate::robot::Footprint;
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
            room.fill(Lattice::around(map.frame(), at, 12.0, 1.0), &field, 20.0);
            let pose = Pose::new(x, y, theta);
            let clearance = field.clearance();
            let exact_m = robot.footprint.distance_m(pose, &clearance, 20.0).min(robot.footprint.to_border_m(pose, &clearance));
            let (sin, cos) = libm::sincos(theta);
            let found_m = outline.room_m(&room, (at, Point::new(cos, sin)), (f64::NEG_INFINITY, 2.0));
            if exact_m > 0.0 {
                // Between points, a distance is off by up to half a cell beside a square, and by
                // less elsewhere; the outline is checked every 0.375 m if it is near.
                prop_assert!((found_m.min(2.0) - exact_m.min(2.0)).abs() < 0.6, "{found_m} {exact_m}");
            } else {
                prop_assert!(found_m < 0.6, "{found_m}");
            }
        }

        /// In a lane hardly wider than the robot, whose middle is between the points or on one.
        #[test]
        fn on_a_narrow_way_room_is_exact(
            (low, rows, stride) in (3..8i32, 9..14i32, 1..5i32), x in 18.0..22.0f64, is_round in any::<bool>(),
            theta in -0.02..0.02f64,
        ) {
            let walls = |x: i32| (0..low).chain(low + rows..40).map(move |y| (x, y));
            let map = map(&(0..40).flat_map(walls).collect::<Vec<_>>());
            let half = 0.5 * f64::from(rows) - 0.3;
            let mut robot = Robot::jackal();
            robot.footprint = if is_round { Footprint::circle(half).unwrap() } else { Footprint::rectangle(7.0, 2.0 * half).unwrap() };
            let outline = Outline::of(&robot);
            let field = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
            let at = Point::new(x, f64::from(low) + 0.5 * f64::from(rows));
            let mut room = Room::default();
            room.fill(Lattice::around(map.frame(), at, 14.0, f64::from(stride)), &field, 20.0);
            let exact = Exact { footprint: &robot.footprint, obstacles: &field };
            let (sin, cos) = libm::sincos(theta);
            let found_m = outline.exact_room_m((&room, exact), (at, Point::new(cos, sin)), (0.05, 2.0));
            let exact_m = robot.footprint.distance_m(Pose::new(at.x, at.y, theta), &field.clearance(), 2.0);
            prop_assert!((found_m - exact_m).abs() < 1e-6, "{found_m} {exact_m}");
        }

        /// For robots that are small beside the cells.
        #[test]
        fn between_the_centres_of_cells_no_room_is_too_large(
            cells in proptest::collection::vec((10..30, 10..30), 0..40),
            (x, y) in (10.0..30.0, 10.0..30.0),
        ) {
            let map = map(&cells);
            let field = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
            let (mut room, at) = (Room::default(), Point::new(x, y));
            let lattice = Lattice::around(map.frame(), at, 3.0, 0.3);
            prop_assert!(!lattice.is_of_centres());
            room.fill(lattice, &field, 2.0);
            let exact_m = field.clearance().of_point(at, 2.0);
            let found_m = room.of_point(at).min(2.0);
            // At a point itself; in between it changes by no more than the distance.
            let least_m = exact_m - (Room::EXCESS + 1.0) * lattice.spacing_m;
            prop_assert!(found_m <= exact_m + 1e-6 && found_m >= least_m - 1e-6, "{found_m} {exact_m}");
        }
    }
}
