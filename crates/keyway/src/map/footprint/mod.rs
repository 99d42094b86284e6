//! Collision checks of a robot's footprint.

use super::clearance::{TOUCH_TOLERANCE_CELLS, enters};
use super::{Clearance, DistanceField};
use crate::geometry::{Point, Pose, Square, holds_point, outline};
use crate::robot::{Footprint, Polygon};

mod arc;
mod core;
mod drive;
mod line;
mod near_box;
mod near_obstacles;
mod turn;
mod turned;

pub use core::Core;
pub(crate) use line::Line;
pub(crate) use near_box::{Apart, Sweep};
pub(crate) use near_obstacles::{NearBoxes, NearObstacles, Reach};
pub(crate) use turned::{Placement, Turned, on_grid};

impl Footprint {
    /// True if the footprint at a pose stays inside the map and enters no obstacle square; it may
    /// touch one. False for a pose that is not finite.
    ///
    /// One lookup in the field decides most poses: free if the nearest obstacle is farther than
    /// the circumscribed radius, not free if it is nearer than the inscribed one. In between, the
    /// shape itself is tested against the squares around it.
    pub fn is_free(&self, pose: Pose, field: &DistanceField) -> bool {
        let point = pose.point();
        if !(point.is_finite() && pose.theta.is_finite()) {
            return false;
        }
        self.is_free_by_radii(point, field).unwrap_or_else(|| match self {
            Self::Circle(circle) => field.clearance().is_clear_point(point, circle.radius_m()),
            Self::Polygon(polygon) => polygon.is_clear(pose, &field.clearance()),
        })
    }

    /// True if the footprint is free at a pose and keeps a clearance of `room_m` \[m\] from
    /// obstacles and from the border of the map.
    pub fn keeps_room(&self, pose: Pose, room_m: f64, field: &DistanceField) -> bool {
        if !self.is_free(pose, field) {
            return false;
        }
        if room_m <= 0.0 || self.is_far(pose.point(), room_m, field) {
            return true;
        }
        let (clearance, cell_m) = (field.clearance(), field.frame().resolution_m());
        match self {
            Self::Circle(circle) => {
                let reach_m = circle.radius_m() + room_m;
                clearance.is_clear_point(pose.point(), reach_m)
                    && clearance.to_border(pose.point()) >= reach_m
            }
            Self::Polygon(polygon) => polygon.has_room(pose, room_m / cell_m, &clearance),
        }
    }

    /// True if no obstacle is within the circumscribed radius plus `room_m` \[m\].
    fn is_far(&self, point: Point, room_m: f64, field: &DistanceField) -> bool {
        let nearest_m = field.square_bounds_m(point).0.min(field.clearance().to_border(point));
        nearest_m > 0.0 && nearest_m >= self.circumscribed_radius_m() + room_m
    }

    /// The result if the two radii decide it for any heading; `None` if they do not.
    fn is_free_by_radii(&self, point: Point, field: &DistanceField) -> Option<bool> {
        let border_m = field.clearance().to_border(point);
        let (lower_m, upper_m) = field.square_bounds_m(point);
        let nearest_m = lower_m.min(border_m);
        if nearest_m >= self.circumscribed_radius_m() && nearest_m > 0.0 {
            return Some(true);
        }
        // A square entered by less than the tolerance counts as touched.
        let tolerance_m = 4.0 * TOUCH_TOLERANCE_CELLS * field.frame().resolution_m();
        let inner_m = self.inscribed_radius_m() * (1.0 - 4.0 * TOUCH_TOLERANCE_CELLS);
        (upper_m < inner_m - tolerance_m).then_some(false)
    }
}

impl Polygon {
    /// The exact test.
    fn is_clear(&self, pose: Pose, clearance: &Clearance<'_>) -> bool {
        let frame = clearance.frame();
        let vertices: Vec<Point> = self
            .vertices()
            .iter()
            .map(|&vertex| frame.grid_from_world(pose.world_from_body(vertex)))
            .collect();
        let low = vertices.iter().copied().reduce(|a, b| Point::new(a.x.min(b.x), a.y.min(b.y)));
        let high = vertices.iter().copied().reduce(|a, b| Point::new(a.x.max(b.x), a.y.max(b.y)));
        let (Some(low), Some(high)) = (low, high) else {
            return true;
        };
        let (width, height) = (f64::from(frame.width()), f64::from(frame.height()));
        let slack = TOUCH_TOLERANCE_CELLS;
        if low.x < -slack || low.y < -slack || high.x > width + slack || high.y > height + slack {
            return false;
        }
        let obstacles = clearance.obstacles();
        (low.y.floor() as i32..=high.y.floor() as i32).all(|y| {
            obstacles.ones_in_span(y, low.x.floor() as i32, high.x.floor() as i32).all(|x| {
                let corner = Point::new(f64::from(x), f64::from(y));
                !overlaps(&vertices, Square { corner })
            })
        })
    }
}

/// True if a polygon covers part of a square: an edge enters it, or all of it lies inside.
fn overlaps(vertices: &[Point], square: Square) -> bool {
    outline(vertices.iter().copied()).any(|edge| enters(edge, square))
        || holds_point(outline(vertices.iter().copied()), square.corner + Point::new(0.5, 0.5))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{DistanceTo, FieldConfig, GridFrame, OccupancyGrid};
    use crate::robot::FootprintError;
    use crate::robot::star;
    use proptest::prelude::*;

    fn polygon(vertices: &[[f64; 2]]) -> Result<Footprint, FootprintError> {
        Footprint::polygon(vertices.iter().map(|&vertex| vertex.into()).collect())
    }

    fn is_free(footprint: &Footprint, pose: Pose, grid: &OccupancyGrid) -> bool {
        let [by_squares, by_centres] = [DistanceTo::Squares, DistanceTo::Centres].map(|to| {
            let config = FieldConfig { to, ..FieldConfig::default() };
            let field = DistanceField::new(grid.frame(), grid.occupied(), &config);
            footprint.is_free(pose, &field)
        });
        assert_eq!(by_squares, by_centres);
        by_squares
    }

    #[test]
    fn a_turn_decides_and_touching_is_allowed() {
        // A box of 2 m x 0.8 m in a lane of 1 m: along it, not across.
        let grid = OccupancyGrid::from_ascii(&["#####", ".....", "#####"]);
        let long = polygon(&[[1.0, 0.4], [-1.0, 0.4], [-1.0, -0.4], [1.0, -0.4]]).unwrap();
        assert!(is_free(&long, Pose::new(2.5, 1.5, 0.0), &grid));
        assert!(!is_free(&long, Pose::new(2.5, 1.5, 1.57), &grid));
        assert!(is_free(&long, Pose::new(2.5, 1.4, 0.0), &grid), "it touches the wall");
        assert!(!is_free(&long, Pose::new(2.5, 1.399, 0.0), &grid));
        assert!(!is_free(&long, Pose::new(0.9, 1.5, 0.0), &grid), "it leaves the map");
        assert!(!is_free(&long, Pose { x: f64::NAN, ..Pose::default() }, &grid));
        // A fork whose gap holds the obstacle that a convex footprint would hit.
        let pillar = OccupancyGrid::from_ascii(&[".....", ".....", "..#..", ".....", "....."]);
        let fork = [
            [1.0, 1.5],
            [-1.5, 1.5],
            [-1.5, -1.5],
            [1.0, -1.5],
            [1.0, -0.6],
            [-0.6, -0.6],
            [-0.6, 0.6],
            [1.0, 0.6],
        ];
        assert!(is_free(&polygon(&fork).unwrap(), Pose::new(2.5, 2.5, 0.0), &pillar));
        assert!(!is_free(&polygon(&fork).unwrap(), Pose::new(2.5, 2.5, 0.5), &pillar));
    }

    /// The area that a polygon and a unit square share, from clipping the polygon along the
    /// square's four sides; clips of a non-convex polygon leave edges that overlap.
    fn shared_area(vertices: &[Point], corner: Point) -> f64 {
        let mut rest: Vec<Point> = vertices.iter().map(|&vertex| vertex - corner).collect();
        let sides: [fn(Point) -> f64; 4] = [|p| p.x, |p| 1.0 - p.x, |p| p.y, |p| 1.0 - p.y];
        for inside in sides {
            let mut cut = Vec::new();
            for edge in outline(rest.iter().copied()) {
                let (a, b) = (inside(edge.a), inside(edge.b));
                if a >= 0.0 {
                    cut.push(edge.a);
                }
                if (a >= 0.0) != (b >= 0.0) {
                    cut.push(edge.a.lerp(edge.b, a / (a - b)));
                }
            }
            rest = cut;
        }
        outline(rest.iter().copied()).map(|edge| 0.5 * edge.a.cross(edge.b)).sum::<f64>().abs()
    }

    proptest! {
        #[test]
        fn agrees_with_shared_areas(cells in prop::collection::vec(prop::bool::weighted(0.04), 24 * 20),
                                    radii in prop::collection::vec(0.05..0.6f64, 3..9), offset in (-0.4..0.4f64, -0.4..0.4f64),
                                    x in -0.1..1.3f64, y in -0.1..1.1f64, theta in -3.1..3.1f64, yaw in -3.0..3.0f64) {
            let frame = GridFrame::new(24, 20, 0.05, Pose::new(1.0, -2.0, yaw)).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &cells);
            // A star around a point that need not be the centre of rotation.
            let vertices = star(&radii, offset);
            let footprint = Footprint::polygon(vertices.clone()).unwrap();
            let centre = frame.world_from_grid(Point::new(x / 0.05, y / 0.05));
            let pose = Pose::new(centre.x, centre.y, theta);
            let in_grid: Vec<Point> = vertices.iter()
                .map(|&vertex| frame.grid_from_world(pose.world_from_body(vertex))).collect();
            let inside = in_grid.iter()
                .all(|p| p.x >= 0.0 && p.y >= 0.0 && p.x <= 24.0 && p.y <= 20.0);
            let shared = frame.cells().filter(|&cell| grid.occupied().get(cell))
                .map(|cell| shared_area(&in_grid, Point::new(f64::from(cell.x), f64::from(cell.y))))
                .fold(0.0, f64::max);
            prop_assume!(!(1e-12..1e-6).contains(&shared));
            prop_assert_eq!(is_free(&footprint, pose, &grid), inside && shared < 1e-9);
        }

        #[test]
        fn a_circle_is_a_distance(cells in prop::collection::vec(prop::bool::weighted(0.04), 24 * 20),
                                  x in 0.0..1.2f64, y in 0.0..1.0f64, radius_m in prop_oneof![Just(0.0), 0.0..0.3f64]) {
            let frame = GridFrame::new(24, 20, 0.05, Pose::default()).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &cells);
            let clearance = Clearance::new(grid.frame(), grid.occupied());
            let free = is_free(&Footprint::circle(radius_m).unwrap(), Pose::new(x, y, 1.0), &grid);
            prop_assert_eq!(free, clearance.is_clear_point(Point::new(x, y), radius_m));
        }
    }
}
