//! The ground a robot covers, and whether it is free at a pose.

use super::clearance::{TOUCH_TOLERANCE_CELLS, enters};
use super::{Clearance, DistanceField, DistanceTo};
use crate::geometry::{Point, Pose, Segment, Square};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The ground that a robot covers, seen from above in its own frame: x ahead, y left, the centre of
/// rotation at (0, 0).
///
/// # Which clearance to plan with
/// Planners and smoothers treat a robot as a disc whose radius is the clearance asked for:
///
/// - The *circumscribed* radius is safe at every heading, also while turning on the spot, but closes
///   passages that a long robot fits through lengthwise.
/// - The *inscribed* radius opens them, but promises nothing: then check the path.
///   [`Self::is_free`] at its samples judges the poses on the way
///   ([`crate::geometry::Path::samples_and_joints`]; a robot moves on between two samples, so plan
///   with a margin of their spacing). Where the heading jumps, the robot turns on the spot between
///   two samples: [`Self::is_free_turn`] judges all headings in between.
///
/// `examples/driveable_path.rs` does all of it.
///
/// ```
/// use keyway::map::Footprint;
/// let round = Footprint::circle(0.2)?;
/// let box_ = [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]];
/// let box_ = Footprint::polygon(box_.map(keyway::geometry::Point::from).to_vec())?;
/// assert_eq!((round.inscribed_radius_m(), box_.inscribed_radius_m()), (0.2, 0.2));
/// assert!(box_.circumscribed_radius_m() > 0.36);
/// assert!(Footprint::circle(-0.2).is_err());
/// # Ok::<(), keyway::map::FootprintError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Footprint {
    /// A disc around the centre of rotation.
    Circle(Circle),
    /// A polygon.
    Polygon(Polygon),
}

/// A disc around the centre of rotation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct Circle {
    radius_m: f64,
}

/// A simple polygon, convex or not, with the distances that quick tests need.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Point>", into = "Vec<Point>")]
pub struct Polygon {
    vertices: Vec<Point>,
    inscribed_radius_m: f64,
    pub(super) circumscribed_radius_m: f64,
}

/// Why a radius or points do not make a footprint.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FootprintError {
    /// A radius that is negative, NaN, or larger than a kilometre.
    #[error("the radius of the footprint must be a length from 0 to 1000 m, got {0:e}")]
    Radius(f64),
    /// Fewer than three points.
    #[error("a footprint needs at least 3 vertices, got {0}")]
    TooFewVertices(usize),
    /// NaN, infinite, or farther than a kilometre from the centre.
    #[error("vertex {index} of the footprint must lie within 1000 m, got ({x:e}, {y:e})")]
    Vertex {
        /// Which one.
        index: usize,
        /// Its x \[m\].
        x: f64,
        /// Its y \[m\].
        y: f64,
    },
    /// All vertices lie on one line, or two successive ones coincide.
    #[error("the footprint covers no ground at vertex {0}")]
    Degenerate(usize),
    /// Two edges that are not neighbours meet.
    #[error("edges {0} and {1} of the footprint meet")]
    SelfIntersecting(usize, usize),
}

/// No part of a footprint is farther than this from the centre of rotation \[m\].
const FARTHEST_M: f64 = 1000.0;

impl Circle {
    /// The disc of this radius \[m\].
    ///
    /// # Errors
    /// When the radius is negative, not finite, or larger than a kilometre.
    pub fn new(radius_m: f64) -> Result<Self, FootprintError> {
        if (0.0..=FARTHEST_M).contains(&radius_m) {
            Ok(Self { radius_m })
        } else {
            Err(FootprintError::Radius(radius_m))
        }
    }

    /// The radius \[m\].
    pub const fn radius_m(&self) -> f64 {
        self.radius_m
    }
}

impl Polygon {
    /// Vertices nearer than this to each other or to an edge count as touching \[m\].
    const LEAST_LENGTH_M: f64 = 1e-6;

    /// The polygon with these vertices \[m\], in either direction around.
    ///
    /// # Errors
    /// When they are fewer than 3, not finite, or do not bound one piece of ground.
    pub fn new(vertices: Vec<Point>) -> Result<Self, FootprintError> {
        if vertices.len() < 3 {
            return Err(FootprintError::TooFewVertices(vertices.len()));
        }
        if let Some(index) =
            vertices.iter().position(|vertex| !(0.0..=FARTHEST_M).contains(&vertex.norm()))
        {
            let Point { x, y } = vertices[index];
            return Err(FootprintError::Vertex { index, x, y });
        }
        let edges: Vec<Segment> = edges(&vertices).collect();
        check_edges(&edges)?;
        let to_edge = |edge: &Segment| edge.distance_sq_to_point(Point::default());
        let boundary_sq = edges.iter().map(to_edge).fold(f64::INFINITY, f64::min);
        let holds_centre = contains(&vertices, Point::default());
        Ok(Self {
            inscribed_radius_m: if holds_centre { boundary_sq.sqrt() } else { 0.0 },
            circumscribed_radius_m: vertices.iter().map(|v| v.norm()).fold(0.0, f64::max),
            vertices,
        })
    }

    /// The vertices \[m\], in the order given.
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }
}

impl Footprint {
    /// The disc of this radius \[m\].
    ///
    /// # Errors
    /// See [`Circle::new`].
    pub fn circle(radius_m: f64) -> Result<Self, FootprintError> {
        Circle::new(radius_m).map(Self::Circle)
    }

    /// The polygon with these vertices \[m\].
    ///
    /// # Errors
    /// See [`Polygon::new`].
    pub fn polygon(vertices: Vec<Point>) -> Result<Self, FootprintError> {
        Polygon::new(vertices).map(Self::Polygon)
    }

    /// Radius of the largest disc around the centre of rotation inside the footprint \[m\]; 0 when
    /// the centre lies outside.
    pub const fn inscribed_radius_m(&self) -> f64 {
        match self {
            Self::Circle(circle) => circle.radius_m,
            Self::Polygon(polygon) => polygon.inscribed_radius_m,
        }
    }

    /// Radius of the smallest disc around the centre of rotation that holds the footprint \[m\].
    pub const fn circumscribed_radius_m(&self) -> f64 {
        match self {
            Self::Circle(circle) => circle.radius_m,
            Self::Polygon(polygon) => polygon.circumscribed_radius_m,
        }
    }

    /// True when the footprint at a pose stays inside the map and enters no obstacle square; it may
    /// touch one. False for a pose that is not finite.
    ///
    /// `field` and `clearance` must know the same obstacles. Most poses are decided by one look into a
    /// field of distances to squares: free when the nearest obstacle is farther than the circumscribed
    /// radius, not free when it is nearer than the inscribed one. In between, and always with a
    /// field of distances to centres, the shape itself is compared with the squares around it.
    pub fn is_free(&self, pose: Pose, field: &DistanceField, clearance: &Clearance<'_>) -> bool {
        let point = pose.point();
        if !(point.is_finite() && pose.theta.is_finite()) {
            return false;
        }
        let quickly = match field.to() {
            DistanceTo::Squares => self.is_free_by_radii(point, field, clearance),
            DistanceTo::Centres => None,
        };
        quickly.unwrap_or_else(|| match self {
            Self::Circle(circle) => clearance.is_clear_point(point, circle.radius_m),
            Self::Polygon(polygon) => polygon.is_clear(pose, clearance),
        })
    }

    /// What the two radii decide, whatever the heading; `None` where that is not enough.
    pub(super) fn is_free_by_radii(
        &self,
        point: Point,
        field: &DistanceField,
        clearance: &Clearance<'_>,
    ) -> Option<bool> {
        let nearest_m = field.lower_bound_m(point).min(clearance.to_border(point));
        if nearest_m >= self.circumscribed_radius_m() && nearest_m > 0.0 {
            return Some(true);
        }
        // A square entered by less than the tolerance counts as touched.
        let tolerance_m = 4.0 * TOUCH_TOLERANCE_CELLS * field.frame().resolution_m();
        let inner_m = self.inscribed_radius_m() * (1.0 - 4.0 * TOUCH_TOLERANCE_CELLS);
        (field.upper_bound_m(point) < inner_m - tolerance_m).then_some(false)
    }
}

impl Polygon {
    /// The exact test.
    pub(super) fn is_clear(&self, pose: Pose, clearance: &Clearance<'_>) -> bool {
        let frame = clearance.frame();
        let vertices: Vec<Point> = self
            .vertices
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

/// True when a polygon covers part of a square: an edge enters it, or all of it lies inside.
fn overlaps(vertices: &[Point], square: Square) -> bool {
    edges(vertices).any(|edge| enters(edge, square))
        || contains(vertices, square.corner + Point::new(0.5, 0.5))
}

pub(super) fn edges(vertices: &[Point]) -> impl Iterator<Item = Segment> + '_ {
    let next = vertices.iter().cycle().skip(1);
    vertices.iter().zip(next).map(|(&a, &b)| Segment::new(a, b))
}

/// True for a point inside: a ray to the right crosses the boundary an odd number of times.
pub(super) fn contains(vertices: &[Point], point: Point) -> bool {
    let crossings = edges(vertices).filter(|edge| {
        let (above_a, above_b) = (edge.a.y > point.y, edge.b.y > point.y);
        let rise = (point.y - edge.a.y) / (edge.b.y - edge.a.y);
        above_a != above_b && point.x < edge.a.x + rise * (edge.b.x - edge.a.x)
    });
    crossings.count() % 2 == 1
}

/// Refuses edges without length, and edges that touch another one elsewhere than at a common
/// vertex.
fn check_edges(edges: &[Segment]) -> Result<(), FootprintError> {
    let least_sq = Polygon::LEAST_LENGTH_M * Polygon::LEAST_LENGTH_M;
    for (i, edge) in edges.iter().enumerate() {
        let next = &edges[(i + 1) % edges.len()];
        // The far end of one neighbour on the other one: a spike, or no ground at all.
        let folds = next.distance_sq_to_point(edge.a) < least_sq
            || edge.distance_sq_to_point(next.b) < least_sq;
        if (edge.b - edge.a).norm_sq() < least_sq || folds {
            return Err(FootprintError::Degenerate(i));
        }
        for (j, other) in edges.iter().enumerate().skip(i + 2) {
            let neighbours = i == 0 && j == edges.len() - 1;
            if !neighbours && meet(edge, other) {
                return Err(FootprintError::SelfIntersecting(i, j));
            }
        }
    }
    Ok(())
}

/// True when two segments cross or touch.
fn meet(one: &Segment, other: &Segment) -> bool {
    let side = |line: &Segment, point: Point| (line.b - line.a).cross(point - line.a);
    let crosses = side(one, other.a) * side(one, other.b) < 0.0
        && side(other, one.a) * side(other, one.b) < 0.0;
    let least_sq = Polygon::LEAST_LENGTH_M * Polygon::LEAST_LENGTH_M;
    let touches = |line: &Segment, point| line.distance_sq_to_point(point) < least_sq;
    crosses
        || touches(one, other.a)
        || touches(one, other.b)
        || touches(other, one.a)
        || touches(other, one.b)
}

impl TryFrom<f64> for Circle {
    type Error = FootprintError;
    fn try_from(radius_m: f64) -> Result<Self, FootprintError> {
        Self::new(radius_m)
    }
}

impl From<Circle> for f64 {
    fn from(circle: Circle) -> Self {
        circle.radius_m
    }
}

impl TryFrom<Vec<Point>> for Polygon {
    type Error = FootprintError;
    fn try_from(vertices: Vec<Point>) -> Result<Self, FootprintError> {
        Self::new(vertices)
    }
}

impl From<Polygon> for Vec<Point> {
    fn from(polygon: Polygon) -> Self {
        polygon.vertices
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{FieldConfig, GridFrame, OccupancyGrid};
    use proptest::prelude::*;

    fn polygon(vertices: &[[f64; 2]]) -> Result<Footprint, FootprintError> {
        Footprint::polygon(vertices.iter().map(|&vertex| vertex.into()).collect())
    }

    fn is_free(footprint: &Footprint, pose: Pose, grid: &OccupancyGrid) -> bool {
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let [by_squares, by_centres] = [DistanceTo::Squares, DistanceTo::Centres].map(|to| {
            let config = FieldConfig { to, ..FieldConfig::default() };
            let field = DistanceField::new(grid.frame(), grid.occupied(), &config);
            footprint.is_free(pose, &field, &clearance)
        });
        assert_eq!(by_squares, by_centres);
        by_squares
    }

    #[test]
    fn radii() {
        let box_ = polygon(&[[0.3, 0.2], [-0.1, 0.2], [-0.1, -0.2], [0.3, -0.2]]).unwrap();
        assert_eq!(box_.inscribed_radius_m(), 0.1);
        assert!((box_.circumscribed_radius_m() - 0.13_f64.sqrt()).abs() < 1e-15);
        let ahead = polygon(&[[1.0, 1.0], [2.0, 1.0], [2.0, -1.0], [1.0, -1.0]]).unwrap();
        assert_eq!(ahead.inscribed_radius_m(), 0.0);
        assert_eq!(Footprint::circle(0.4).unwrap().circumscribed_radius_m(), 0.4);
    }

    #[test]
    fn what_is_no_footprint() {
        assert_eq!(polygon(&[[0.0, 0.0], [1.0, 0.0]]), Err(FootprintError::TooFewVertices(2)));
        let line = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]];
        assert!(matches!(polygon(&line), Err(FootprintError::Degenerate(_))));
        let twice = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(polygon(&twice), Err(FootprintError::Degenerate(0)));
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(polygon(&bow), Err(FootprintError::SelfIntersecting(0, 2)));
        let nan = [[0.0, 0.0], [f64::NAN, 1.0], [1.0, 0.0]];
        assert!(matches!(polygon(&nan), Err(FootprintError::Vertex { index: 1, .. })));
        assert!(serde_json::from_str::<Footprint>(r#"{"polygon": [[0, 0], [1, 0]]}"#).is_err());
        let triangle = polygon(&[[1.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]]).unwrap();
        let text = serde_json::to_string(&triangle).unwrap();
        assert_eq!(serde_json::from_str::<Footprint>(&text).unwrap(), triangle);
    }

    #[test]
    fn only_lengths_are_radii() {
        for radius_m in [0.0, 0.4, 1000.0] {
            let circle = Footprint::circle(radius_m).unwrap();
            assert_eq!(circle.inscribed_radius_m(), radius_m);
            let text = serde_json::to_string(&circle).unwrap();
            assert_eq!(text, format!(r#"{{"circle":{radius_m:?}}}"#));
            assert_eq!(serde_json::from_str::<Footprint>(&text).unwrap(), circle);
        }
        for radius_m in [-0.1, f64::NAN, f64::INFINITY, 1000.1] {
            assert!(matches!(Footprint::circle(radius_m), Err(FootprintError::Radius(_))));
        }
        assert!(serde_json::from_str::<Footprint>(r#"{"circle": -0.4}"#).is_err());
        assert!(toml::from_str::<Footprint>("circle = nan").is_err());
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

    /// The area that a polygon and a unit square share, by cutting the polygon along the square's
    /// four sides; cuts of a polygon that is not convex leave edges that cover each other.
    fn shared_area(vertices: &[Point], corner: Point) -> f64 {
        let mut rest: Vec<Point> = vertices.iter().map(|&vertex| vertex - corner).collect();
        let sides: [fn(Point) -> f64; 4] = [|p| p.x, |p| 1.0 - p.x, |p| p.y, |p| 1.0 - p.y];
        for inside in sides {
            let mut cut = Vec::new();
            for edge in edges(&rest) {
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
        edges(&rest).map(|edge| 0.5 * edge.a.cross(edge.b)).sum::<f64>().abs()
    }

    proptest! {
        #[test]
        fn agrees_with_shared_areas(cells in prop::collection::vec(prop::bool::weighted(0.04), 24 * 20),
                                    radii in prop::collection::vec(0.05..0.6f64, 3..9), offset in (-0.4..0.4f64, -0.4..0.4f64),
                                    x in -0.1..1.3f64, y in -0.1..1.1f64, theta in -3.1..3.1f64, yaw in -3.0..3.0f64) {
            let frame = GridFrame::new(24, 20, 0.05, Pose::new(1.0, -2.0, yaw)).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &cells);
            // A star around a point that need not be the centre of rotation.
            let step = std::f64::consts::TAU / radii.len() as f64;
            let vertices: Vec<Point> = radii.iter().enumerate().map(|(i, &radius)| {
                let (sin, cos) = (step * i as f64).sin_cos();
                Point::new(offset.0 + radius * cos, offset.1 + radius * sin)
            }).collect();
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
