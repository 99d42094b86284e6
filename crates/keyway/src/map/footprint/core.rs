//! Distances from a footprint to obstacles, points and other footprints.
//!
//! A footprint is the area within a radius of its *core*: the centre of rotation for a disc, the
//! polygon itself (radius 0) for a polygon. One rule thus measures both.

use crate::geometry::{Point, Pose, Segment, holds_point, outline};
use crate::map::{Cell, Clearance, GridFrame};
use crate::robot::Footprint;

/// The core of a footprint: the centre of rotation, or a polygon around it.
#[derive(Clone, Copy, Debug)]
pub struct Core<'a> {
    /// Vertices in the robot's frame \[m\]; empty for the centre alone.
    vertices: &'a [Point],
    /// Distance of the farthest vertex from the centre of rotation \[m\].
    swing_m: f64,
}

impl Footprint {
    /// Distance from the footprint at a pose to the nearest obstacle square \[m\]: 0 if it
    /// touches or covers one, `reach_m` if none is nearer than that.
    pub fn distance_m(&self, pose: Pose, clearance: &Clearance<'_>, reach_m: f64) -> f64 {
        let (core, radius_m) = self.core();
        let core_reach_m = reach_m + radius_m;
        let apart_m = core.distance_m(pose, clearance, core_reach_m);
        if apart_m >= core_reach_m { reach_m } else { (apart_m - radius_m).max(0.0).min(reach_m) }
    }

    /// Distance from the footprint at a pose to the map's border \[m\]; negative if it leaves the
    /// map.
    pub fn to_border_m(&self, pose: Pose, clearance: &Clearance<'_>) -> f64 {
        let (core, radius_m) = self.core();
        core.to_border_m(pose, clearance) - radius_m
    }

    /// The core, and the radius around it \[m\].
    pub fn core(&self) -> (Core<'_>, f64) {
        match self {
            Self::Circle(circle) => (Core { vertices: &[], swing_m: 0.0 }, circle.radius_m()),
            Self::Polygon(polygon) => (Core::polygon(polygon.vertices()), 0.0),
        }
    }
}

impl<'a> Core<'a> {
    /// Builds a polygon from its vertices in the robot's frame \[m\].
    pub fn polygon(vertices: &'a [Point]) -> Self {
        let swing_m = vertices.iter().map(|vertex| vertex.norm()).fold(0.0, f64::max);
        Self { vertices, swing_m }
    }

    /// The polygon's vertices; empty for the centre alone.
    pub const fn vertices(&self) -> &'a [Point] {
        self.vertices
    }

    /// Distance of the farthest vertex from the centre of rotation \[m\].
    pub const fn swing_m(&self) -> f64 {
        self.swing_m
    }

    /// Upper bound of the distance that any point of the core moves when the robot drives and
    /// turns by these amounts \[m\].
    pub fn moves_m(&self, driven_m: f64, turned_rad: f64) -> f64 {
        driven_m.abs() + self.swing_m * turned_rad.abs()
    }

    /// Distance to the nearest obstacle square: 0 if the core touches or covers one, `reach_m` if
    /// none is nearer than that.
    pub fn distance_m(&self, pose: Pose, clearance: &Clearance<'_>, reach_m: f64) -> f64 {
        if self.vertices.is_empty() {
            return clearance.of_point(pose.point(), reach_m);
        }
        if !(pose.point().is_finite() && pose.theta.is_finite()) {
            return 0.0;
        }
        let placed = Placed::in_world(self, pose);
        let nearest =
            placed.edges().fold(reach_m, |nearest, edge| clearance.of_segment(edge, nearest));
        let covers = || Placed::on_grid(self, pose, clearance.frame()).covers(clearance);
        if nearest > 0.0 && covers() { 0.0 } else { nearest }
    }

    /// Collects the obstacle squares that are no farther than `touch_m` from the core, row by
    /// row.
    pub(crate) fn touched(
        &self,
        pose: Pose,
        clearance: &Clearance<'_>,
        touch_m: f64,
        touched: &mut Vec<Cell>,
    ) {
        touched.clear();
        // Distances are capped at the reach, so it must exceed `touch_m`.
        let reach_m = touch_m + clearance.frame().resolution_m();
        self.for_each_near(pose, clearance, reach_m, |at, apart_m| {
            if apart_m <= touch_m {
                touched.push(at);
            }
        });
    }

    /// Distance to the nearest obstacle square that is not in `without` \[m\], a list sorted by
    /// rows and columns; `reach_m` if none is nearer than that.
    pub(crate) fn distance_without_m(
        &self,
        pose: Pose,
        clearance: &Clearance<'_>,
        reach_m: f64,
        without: &[Cell],
    ) -> f64 {
        let mut nearest_m = reach_m;
        self.for_each_near(pose, clearance, reach_m, |at, apart_m| {
            if without.binary_search_by_key(&(at.y, at.x), |cell| (cell.y, cell.x)).is_err() {
                nearest_m = nearest_m.min(apart_m);
            }
        });
        nearest_m
    }

    /// Visits the obstacle squares around the core row by row, at least those within `reach_m`.
    /// Each comes with its distance, capped at `reach_m`.
    fn for_each_near(
        &self,
        pose: Pose,
        clearance: &Clearance<'_>,
        reach_m: f64,
        mut visit: impl FnMut(Cell, f64),
    ) {
        let frame = clearance.frame();
        let cell_m = frame.resolution_m();
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let corners = corners.map(|(x, y)| Point::new(x * cell_m, y * cell_m));
        let square = Core::polygon(&corners);
        let origin = frame.grid_from_world(pose.point());
        let around = (self.swing_m + reach_m) / cell_m;
        let cell = |coordinate: f64| coordinate.floor() as i32;
        for y in cell(origin.y - around)..=cell(origin.y + around) {
            let (from, to) = (cell(origin.x - around), cell(origin.x + around));
            for x in clearance.obstacles().ones_in_span(y, from, to) {
                let at = Cell::new(x, y);
                let middle = frame.world_from_cell(at);
                let place = Pose::new(middle.x, middle.y, frame.origin().theta);
                visit(at, self.distance_to_core_m(pose, &square, place, reach_m));
            }
        }
    }

    /// Distance to a point: 0 inside a polygon.
    pub fn distance_to_m(&self, pose: Pose, point: Point) -> f64 {
        if self.vertices.is_empty() {
            return pose.point().distance(point);
        }
        let placed = Placed::in_world(self, pose);
        let to_edge = |edge: Segment| edge.distance_sq_to_point(point);
        let boundary_sq = placed.edges().map(to_edge).fold(f64::INFINITY, f64::min);
        if holds_point(placed.edges(), point) { 0.0 } else { boundary_sq.sqrt() }
    }

    /// Distance to the map's border; negative if the core leaves the map.
    pub(crate) fn to_border_m(self, pose: Pose, clearance: &Clearance<'_>) -> f64 {
        if self.vertices.is_empty() {
            return clearance.to_border(pose.point());
        }
        let placed = Placed::in_world(&self, pose);
        placed.vertices().map(|vertex| clearance.to_border(vertex)).fold(f64::INFINITY, f64::min)
    }
}

/// A core at a pose.
struct Placed<'a> {
    vertices: &'a [Point],
    origin: Point,
    /// Direction of the robot's x axis; its length is one metre.
    ahead: Point,
}

impl<'a> Placed<'a> {
    /// Places a core in world coordinates \[m\].
    fn in_world(core: &Core<'a>, pose: Pose) -> Self {
        let (sin, cos) = libm::sincos(pose.theta);
        Self { vertices: core.vertices, origin: pose.point(), ahead: Point::new(cos, sin) }
    }

    /// Places a core in grid coordinates \[cells\].
    fn on_grid(core: &Core<'a>, pose: Pose, frame: &GridFrame) -> Self {
        let (sin, cos) = libm::sincos(pose.theta - frame.origin().theta);
        let ahead = Point::new(cos, sin) * (1.0 / frame.resolution_m());
        Self { vertices: core.vertices, origin: frame.grid_from_world(pose.point()), ahead }
    }

    fn vertices(&self) -> impl Iterator<Item = Point> + Clone + '_ {
        let Self { origin, ahead, .. } = *self;
        let left = Point::new(-ahead.y, ahead.x);
        self.vertices.iter().map(move |vertex| origin + ahead * vertex.x + left * vertex.y)
    }

    fn edges(&self) -> impl Iterator<Item = Segment> + '_ {
        outline(self.vertices())
    }

    /// True if the centre of an obstacle square lies inside the polygon (on the grid).
    fn covers(&self, clearance: &Clearance<'_>) -> bool {
        let low = self.vertices().fold(self.origin, |a, b| Point::new(a.x.min(b.x), a.y.min(b.y)));
        let high = self.vertices().fold(self.origin, |a, b| Point::new(a.x.max(b.x), a.y.max(b.y)));
        let cell = |coordinate: f64| coordinate.floor() as i32;
        (cell(low.y)..=cell(high.y)).any(|y| {
            let mut row = clearance.obstacles().ones_in_span(y, cell(low.x), cell(high.x));
            row.any(|x| {
                let middle = Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                holds_point(self.edges(), middle)
            })
        })
    }
}

impl Footprint {
    /// Distance between two footprints at their poses \[m\]: 0 if they touch or one covers the
    /// other, `reach_m` if they are at least that far apart.
    pub fn distance_to_footprint_m(
        &self,
        pose: Pose,
        other: &Self,
        other_pose: Pose,
        reach_m: f64,
    ) -> f64 {
        let ((core, radius_m), (other_core, other_radius_m)) = (self.core(), other.core());
        let radii_m = radius_m + other_radius_m;
        let core_reach_m = reach_m + radii_m;
        let apart_m = core.distance_to_core_m(pose, &other_core, other_pose, core_reach_m);
        if apart_m >= core_reach_m { reach_m } else { (apart_m - radii_m).clamp(0.0, reach_m) }
    }
}

impl Core<'_> {
    /// Distance between two cores: 0 if they touch or one covers the other, `reach_m` if they are
    /// at least that far apart. Costs a few operations per pair of edges, and fewer beyond the
    /// reach.
    fn distance_to_core_m(
        &self,
        pose: Pose,
        other: &Core<'_>,
        other_pose: Pose,
        reach_m: f64,
    ) -> f64 {
        let is_placed = |pose: Pose| pose.point().is_finite() && pose.theta.is_finite();
        if !(is_placed(pose) && is_placed(other_pose)) {
            return 0.0;
        }
        let centres_m = pose.point().distance(other_pose.point());
        if centres_m - self.swing_m - other.swing_m >= reach_m {
            return reach_m;
        }
        let apart_m = if self.vertices.is_empty() {
            other.distance_to_m(other_pose, pose.point())
        } else if other.vertices.is_empty() {
            self.distance_to_m(pose, other_pose.point())
        } else {
            Placed::in_world(self, pose).distance_to(&Placed::in_world(other, other_pose))
        };
        apart_m.min(reach_m)
    }
}

impl Placed<'_> {
    /// Distance between two polygons: 0 if they meet. Polygons that do not meet are nearest at a
    /// vertex of one of them. If their edges do not cross, each polygon contains all vertices of
    /// the other or none.
    fn distance_to(&self, other: &Placed<'_>) -> f64 {
        let holds_first = |one: &Placed<'_>, two: &Placed<'_>| {
            two.vertices().next().is_some_and(|vertex| holds_point(one.edges(), vertex))
        };
        if holds_first(self, other) || holds_first(other, self) {
            return 0.0;
        }
        let mut nearest_sq = f64::INFINITY;
        for edge in self.edges() {
            for other_edge in other.edges() {
                if cross(edge, other_edge) {
                    return 0.0;
                }
                let to_other = other_edge.distance_sq_to_point(edge.a);
                nearest_sq = nearest_sq.min(to_other).min(edge.distance_sq_to_point(other_edge.a));
            }
        }
        nearest_sq.sqrt()
    }
}

/// True if the end points of each segment lie on opposite sides of the other.
fn cross(one: Segment, other: Segment) -> bool {
    let side = |line: Segment, point: Point| (line.b - line.a).cross(point - line.a);
    side(one, other.a) * side(one, other.b) < 0.0 && side(other, one.a) * side(other, one.b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Arc, Cubic, PathPiece, Square};
    use crate::map::BitGrid;
    use crate::robot::star;
    use proptest::prelude::*;

    /// The smallest distance between a polygon and a square, found by comparing all their edges;
    /// 0 if one contains a corner of the other.
    fn to_square(vertices: &[Point], square: Square) -> f64 {
        let middle = square.corner + Point::new(0.5, 0.5);
        let is_inside = |p: Point| {
            let off = p - middle;
            off.x.abs() <= 0.5 && off.y.abs() <= 0.5
        };
        let edges = || outline(vertices.iter().copied());
        if holds_point(edges(), middle) || vertices.iter().any(|&v| is_inside(v)) {
            return 0.0;
        }
        let sides: Vec<Segment> = outline(square.corners().into_iter()).collect();
        let crossed = |a: Segment, b: Segment| {
            let side = |s: Segment, p: Point| (s.b - s.a).cross(p - s.a);
            side(a, b.a) * side(a, b.b) <= 0.0 && side(b, a.a) * side(b, a.b) <= 0.0
        };
        let apart_sq = |a: Segment, b: Segment| {
            let ends = [a.distance_sq_to_point(b.a), a.distance_sq_to_point(b.b)];
            let ends =
                ends.into_iter().chain([b.distance_sq_to_point(a.a), b.distance_sq_to_point(a.b)]);
            if crossed(a, b) { 0.0 } else { ends.fold(f64::INFINITY, f64::min) }
        };
        let pairs = edges().flat_map(|edge| sides.iter().map(move |&side| apart_sq(edge, side)));
        pairs.fold(f64::INFINITY, f64::min).sqrt()
    }

    proptest! {
        #[test]
        fn distances_are_those_of_all_pairs(
            cells in prop::collection::vec(prop::bool::weighted(0.03), 24 * 20),
            radii in prop::collection::vec(0.05..0.6f64, 3..9), offset in (-0.4..0.4f64, -0.4..0.4f64),
            x in -0.1..1.3f64, y in -0.1..1.1f64, theta in -3.1..3.1f64, yaw in -3.0..3.0f64,
            reach_m in 0.01..2.0f64,
        ) {
            let frame = GridFrame::new(24, 20, 0.05, Pose::new(1.0, -2.0, yaw)).unwrap();
            let mut obstacles = BitGrid::new(24, 20, false);
            let squares: Vec<Cell> = frame.cells().zip(cells).filter(|c| c.1).map(|c| c.0).collect();
            for &cell in &squares { obstacles.set(cell, true); }
            let vertices = star(&radii, offset);
            let footprint = Footprint::polygon(vertices.clone()).unwrap();
            let at = frame.world_from_grid(Point::new(x / 0.05, y / 0.05));
            let pose = Pose::new(at.x, at.y, theta);
            let on_grid: Vec<Point> = vertices.iter()
                .map(|&vertex| frame.grid_from_world(pose.world_from_body(vertex))).collect();
            let square = |cell: &Cell| Square { corner: Point::new(f64::from(cell.x), f64::from(cell.y)) };
            let expected = squares.iter().map(|cell| 0.05 * to_square(&on_grid, square(cell)))
                .fold(f64::INFINITY, f64::min);
            let clearance = Clearance::new(&frame, &obstacles);
            let measured = footprint.distance_m(pose, &clearance, reach_m);
            prop_assert!((measured - expected.min(reach_m)).abs() < 1e-9, "{measured} {expected}");
            let border = on_grid.iter()
                .map(|v| 0.05 * v.x.min(v.y).min(24.0 - v.x).min(20.0 - v.y)).fold(f64::INFINITY, f64::min);
            prop_assert!((footprint.to_border_m(pose, &clearance) - border).abs() < 1e-9);
        }

        #[test]
        fn no_part_moves_farther_than_is_said(
            radii in prop::collection::vec(0.05..0.6f64, 3..9), offset in (-0.4..0.4f64, -0.4..0.4f64),
            v in -1.0..1.0f64, omega in -3.0..3.0f64, duration_s in 0.0..1.0f64,
        ) {
            let vertices = star(&radii, offset);
            let core = Core::polygon(&vertices);
            let moves_m = core.moves_m(v * duration_s, omega * duration_s);
            let end = Pose::default().after_arc(crate::geometry::Velocity::new(v, omega), duration_s);
            for &vertex in &vertices {
                let moved_m = end.world_from_body(vertex).distance(vertex);
                prop_assert!(moved_m <= moves_m + 1e-12, "{moved_m} {moves_m}");
            }
        }
    }

    proptest! {
        /// Callers tell by the exact value that no obstacle is near, so not even the last bit may
        /// differ.
        #[test]
        fn where_nothing_is_near_the_reach_is_given_back(
            cell_m in 0.01..1.0f64, (x, y) in (30.0..40.0f64, 30.0..40.0f64), (theta, yaw) in (-3.1..3.1f64, -3.1..3.1f64),
            radii in prop::collection::vec(0.5..3.0f64, 3..9), reach in 0.01..20.0f64,
        ) {
            // Lengths are in cells; the only obstacle is at the corner of the map.
            let frame = GridFrame::new(60, 60, cell_m, Pose::new(3.0, -2.0, yaw)).unwrap();
            let mut obstacles = BitGrid::new(60, 60, false);
            obstacles.set(Cell::new(0, 0), true);
            let clearance = Clearance::new(&frame, &obstacles);
            let at = |x: f64, y: f64| frame.world_from_grid(Point::new(x, y));
            let (from, to, reach_m) = (at(x, y), at(y, x), reach * cell_m);
            let bend = Point::new(cell_m, -cell_m);
            let arc = Arc::new(from, 2.0 * cell_m, theta, 1.5);
            let cubic = Cubic { start: from, legs: [bend, (to - from) * 0.5, bend] };
            let of_cubic = clearance.of_curve(&PathPiece::Cubic(cubic), reach_m, 0.1 * cell_m);
            let of_lines = [clearance.of_point(from, reach_m), clearance.of_segment(Segment::new(from, to), reach_m),
                clearance.of_arc(arc, reach_m), of_cubic.at_least_m, of_cubic.at_most_m];
            prop_assert_eq!(of_lines, [reach_m; 5]);
            let radii: Vec<f64> = radii.iter().map(|radius| radius * cell_m).collect();
            for footprint in [around(&radii, (0.0, 0.0)), Footprint::circle(radii[0]).unwrap()] {
                prop_assert_eq!(footprint.distance_m(Pose::new(from.x, from.y, theta), &clearance, reach_m), reach_m);
            }
        }
    }

    /// A polygon around a point, with vertices at these distances from it.
    fn around(radii: &[f64], offset: (f64, f64)) -> Footprint {
        Footprint::polygon(star(radii, offset)).unwrap()
    }

    #[test]
    fn distances_between_footprints_by_hand() {
        let (disc, small) = (Footprint::circle(0.5).unwrap(), Footprint::circle(0.1).unwrap());
        let (box_, plate) =
            (Footprint::rectangle(2.0, 1.0).unwrap(), Footprint::rectangle(4.0, 4.0).unwrap());
        let between = |a: &Footprint, b: &Footprint, x, y, degrees: f64| {
            let (here, there) =
                (Pose::new(1.0, 2.0, 0.0), Pose::new(1.0 + x, 2.0 + y, degrees.to_radians()));
            let apart_m = a.distance_to_footprint_m(here, b, there, 9.0);
            let back_m = b.distance_to_footprint_m(there, a, here, 9.0);
            assert!((apart_m - back_m).abs() < 1e-12);
            apart_m
        };
        assert!((between(&disc, &small, 3.0, 4.0, 0.0) - 4.4).abs() < 1e-12);
        assert_eq!(between(&disc, &small, 0.3, 0.2, 0.0), 0.0);
        // Beside the box, and beyond its corner (1, 0.5).
        assert!((between(&box_, &disc, 0.3, 2.0, 0.0) - 1.0).abs() < 1e-12);
        assert!((between(&box_, &disc, 4.0, 4.5, 0.0) - 4.5).abs() < 1e-12);
        // Two boxes: side by side, across, and one within the other without crossing edges.
        assert!((between(&box_, &box_, 0.5, 1.75, 180.0) - 0.75).abs() < 1e-12);
        assert!((between(&box_, &box_, 0.0, 2.0, 90.0) - 0.5).abs() < 1e-12);
        assert_eq!(between(&box_, &box_, 0.0, 0.0, 90.0), 0.0);
        assert_eq!(between(&plate, &box_, 0.2, 0.3, 20.0), 0.0);
        assert_eq!(between(&plate, &small, 0.2, 0.3, 20.0), 0.0);
        let within =
            disc.distance_to_footprint_m(Pose::default(), &box_, Pose::new(9.0, 0.0, 0.0), 2.0);
        assert_eq!(within, 2.0);
        let nowhere = Pose { x: f64::NAN, ..Pose::default() };
        assert_eq!(disc.distance_to_footprint_m(nowhere, &small, Pose::default(), 1.0), 0.0);
    }

    proptest! {
        /// Samples one outline at most 3.5 mm apart and measures to the other footprint.
        #[test]
        fn distances_between_footprints_are_those_of_their_points(
            radii in prop::collection::vec(0.05..0.6f64, 3..9), offset in (-0.4..0.4f64, -0.4..0.4f64),
            other_radii in prop::collection::vec(0.05..0.6f64, 3..9), other_offset in (-0.4..0.4f64, -0.4..0.4f64),
            x in -1.5..1.5f64, y in -1.5..1.5f64, thetas in (-3.1..3.1f64, -3.1..3.1f64), reach_m in 0.01..3.0f64,
        ) {
            let (one, other) = (around(&radii, offset), around(&other_radii, other_offset));
            let (pose, other_pose) = (Pose::new(0.3, -0.2, thetas.0), Pose::new(x, y, thetas.1));
            let (core, _) = one.core();
            let (other_core, _) = other.core();
            let measured = one.distance_to_footprint_m(pose, &other, other_pose, reach_m);
            let to_other = |point: Point| other_core.distance_to_m(other_pose, point);
            let placed = Placed::in_world(&core, pose);
            let sampled = placed.edges()
                .flat_map(|edge| (0..=300).map(move |i| edge.a.lerp(edge.b, f64::from(i) / 300.0)))
                .map(to_other).fold(f64::INFINITY, f64::min);
            // The other one may lie wholly inside.
            let first = Placed::in_world(&other_core, other_pose).vertices().next().unwrap();
            let sampled = sampled.min(core.distance_to_m(pose, first));
            prop_assert!(measured <= sampled.min(reach_m) + 1e-12, "{measured} {sampled}");
            prop_assert!(sampled.min(reach_m) - measured < 2e-3, "{measured} {sampled}");
            let back = other.distance_to_footprint_m(other_pose, &one, pose, reach_m);
            prop_assert!((back - measured).abs() < 1e-12);
        }
    }
}
