//! How much room a footprint has, nearly and fast.

use super::lattice::Lattice;
use crate::geometry::Point;
use crate::map::{Cell, DistanceField};
use crate::robot::{Footprint, Robot};

/// Distances to what stands around the robot.
#[derive(Debug, Default)]
pub(super) struct Room {
    lattice: Lattice,
    distances_m: Vec<f32>,
}

impl Room {
    pub(super) fn fill(&mut self, lattice: Lattice, obstacles: &DistanceField) {
        self.lattice = lattice;
        self.distances_m.clear();
        let (width, height) = (obstacles.frame().width() as i32, obstacles.frame().height() as i32);
        let cell_m = obstacles.frame().resolution_m();
        for y in 0..lattice.side {
            for x in 0..lattice.side {
                let cell = lattice.cell(x, y);
                let Cell { x, y } = cell;
                let border = x.min(y).min(width - 1 - x).min(height - 1 - y);
                let border_m = (f64::from(border) + 0.5) * cell_m;
                let seen = obstacles.half_cells_sq(cell);
                let seen_m = seen.map_or(border_m, |sq| 0.5 * cell_m * f64::from(sq).sqrt());
                self.distances_m.push(seen_m.min(border_m) as f32);
            }
        }
    }

    /// Distance of a point to what stands \[m\].
    #[inline]
    pub(super) fn of_point(&self, at: Point) -> f64 {
        f64::from(self.lattice.value(&self.distances_m, at))
    }
}

/// A footprint as points on its outline.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// No farther apart than `spacing_m`.
    points: Vec<Point>,
    per_spacing: f64,
    pub(super) inscribed_m: f64,
    pub(super) circumscribed_m: f64,
}

impl Outline {
    pub(super) fn of(robot: &Robot) -> Self {
        let footprint = &robot.footprint;
        let (inscribed_m, circumscribed_m) =
            (footprint.inscribed_radius_m(), footprint.circumscribed_radius_m());
        let spacing_m = 0.1 * inscribed_m;
        let points = match footprint {
            Footprint::Circle(_) => Vec::new(),
            Footprint::Polygon(polygon) => {
                let vertices = polygon.vertices();
                let next = vertices.iter().cycle().skip(1);
                let mut points = Vec::new();
                for (&from, &to) in vertices.iter().zip(next) {
                    let parts = (from.distance(to) / spacing_m).ceil().max(1.0);
                    let along = |part: u32| from + (to - from) * (f64::from(part) / parts);
                    points.extend((0..parts as u32).map(along));
                }
                points
            }
        };
        Self { points, per_spacing: 1.0 / spacing_m, inscribed_m, circumscribed_m }
    }

    /// Room between the footprint and what stands \[m\]; more than `enough_m` is not told apart. Negative where it touches.
    #[inline]
    pub(super) fn room_m(&self, room: &Room, at: Point, ahead: Point, enough_m: f64) -> f64 {
        let centre_m = room.of_point(at);
        if self.points.is_empty() || centre_m >= self.circumscribed_m + enough_m {
            return centre_m - self.circumscribed_m;
        }
        if centre_m <= self.inscribed_m {
            return centre_m - self.inscribed_m;
        }
        let mut nearest_m = enough_m.min(centre_m - self.inscribed_m);
        let mut index = 0;
        while let Some(point) = self.points.get(index) {
            let turned = Point::new(
                point.x * ahead.x - point.y * ahead.y,
                point.x * ahead.y + point.y * ahead.x,
            );
            let room_m = room.of_point(at + turned);
            // Along the outline the room changes no faster than the way.
            index += 1 + ((room_m - nearest_m).max(0.0) * self.per_spacing) as usize;
            nearest_m = nearest_m.min(room_m);
        }
        nearest_m
    }
}
