//! The footprint of a robot.

use crate::geometry::{Point, Segment, holds_point, outline};
use crate::given::Given;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display, Formatter};
use thiserror::Error;

/// The ground area that a robot covers, in its own frame: x ahead, y left, the centre of rotation
/// at (0, 0).
///
/// # Choosing the clearance
/// Planners and smoothers treat a robot as a disc whose radius is the requested clearance:
///
/// - The *circumscribed* radius is safe at every heading, also while turning in place, but closes
///   passages that a long robot fits through lengthwise.
/// - The *inscribed* radius opens them, but guarantees nothing: the path has to be checked.
///   [`Self::is_free`] checks the poses at its samples
///   ([`crate::geometry::Path::samples_and_joints`]; the robot moves between two samples, so plan
///   with a margin of their spacing). At a heading jump the robot turns in place between two
///   samples: [`Self::is_free_turn`] checks all headings in between.
///
/// `examples/driveable_path.rs` does all of this.
///
/// ```
/// use keyway::robot::Footprint;
/// let round = Footprint::circle(0.2)?;
/// let box_ = [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]];
/// let box_ = Footprint::polygon(box_.map(keyway::geometry::Point::from).to_vec())?;
/// assert_eq!((round.inscribed_radius_m(), box_.inscribed_radius_m()), (0.2, 0.2));
/// assert!(box_.circumscribed_radius_m() > 0.36);
/// assert!(Footprint::circle(-0.2).is_err());
/// # Ok::<(), keyway::robot::FootprintError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Footprint {
    /// A disc around the centre of rotation: its radius \[m\]; 0 is a point.
    #[serde(rename = "radius_m")]
    Circle(Circle),
    /// A polygon: its vertices \[m\], as \[x, y\] each.
    #[serde(rename = "vertices_m")]
    Polygon(Polygon),
}

/// A disc around the centre of rotation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "f64"))]
pub struct Circle {
    radius_m: f64,
}

/// A simple polygon, convex or not, with its radii for quick tests.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Point>", into = "Vec<Point>")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Vec<[f64; 2]>"))]
pub struct Polygon {
    vertices: Vec<Point>,
    inscribed_radius_m: f64,
    circumscribed_radius_m: f64,
}

/// Reason why a radius or vertices do not make a footprint.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FootprintError {
    /// A radius that is negative, NaN, or larger than a kilometre.
    #[error("the radius of the footprint must be a length from 0 to 1000 m, got {}", Given(*.0))]
    Radius(f64),
    /// A length or width of a rectangle that is not positive, NaN, or larger than a kilometre.
    #[error(
        "the length and the width of the footprint must be above 0 and at most 1000 m, got {} and {}",
        Given(*.length_m), Given(*.width_m)
    )]
    Rectangle {
        /// The length \[m\].
        length_m: f64,
        /// The width \[m\].
        width_m: f64,
    },
    /// Fewer than three points.
    #[error("a footprint needs at least 3 vertices, got {0}")]
    TooFewVertices(usize),
    /// More than [`Polygon::MOST_VERTICES`].
    #[error("a footprint has at most {most} vertices, got {0}; remove vertices that hardly change the shape",
        most = Polygon::MOST_VERTICES)]
    TooManyVertices(usize),
    /// NaN, infinite, or farther than a kilometre from the centre.
    #[error(
        "vertex {index} of the footprint must lie within 1000 m, got ({}, {})", Given(*.x), Given(*.y)
    )]
    Vertex {
        /// Index of the vertex.
        index: usize,
        /// Its x \[m\].
        x: f64,
        /// Its y \[m\].
        y: f64,
    },
    /// Two successive vertices coincide, for example if the first one is repeated as the last.
    #[error(
        "vertices {0} and {1} of the footprint coincide; leave one out (the last vertex is joined to the first)"
    )]
    Repeated(usize, usize),
    /// Two successive edges overlap, as in a spike or if all vertices are collinear.
    #[error("the footprint has no area at vertex {0}")]
    Degenerate(usize),
    /// Two edges that are not neighbours touch or cross.
    #[error("edges {0} and {1} of the footprint touch or cross")]
    SelfIntersecting(usize, usize),
}

/// Maximum distance of any part of a footprint from the centre of rotation \[m\].
const FARTHEST_M: f64 = 1000.0;

impl Circle {
    /// The disc of this radius \[m\].
    ///
    /// # Errors
    /// Returns [`FootprintError`] if the radius is negative, not finite, or larger than a
    /// kilometre.
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
    /// Vertices closer than this to each other or to an edge count as touching \[m\].
    const LEAST_LENGTH_M: f64 = 1e-6;

    /// Maximum number of vertices: the time of every distance computation, and so of every
    /// decision of a local planner, is proportional to it. The convex hull is not used instead,
    /// because a robot may be a fork that an obstacle can enter.
    pub const MOST_VERTICES: usize = 100;

    /// The polygon with these vertices \[m\], in either orientation. The last one is connected to
    /// the first, which must not be repeated.
    ///
    /// # Errors
    /// Returns [`FootprintError`] if there are fewer than 3 vertices or more than
    /// [`Self::MOST_VERTICES`], if they do not bound a single area, or if one is not within a
    /// kilometre of the centre of rotation.
    pub fn new(vertices: Vec<Point>) -> Result<Self, FootprintError> {
        if vertices.len() < 3 {
            return Err(FootprintError::TooFewVertices(vertices.len()));
        }
        if vertices.len() > Self::MOST_VERTICES {
            return Err(FootprintError::TooManyVertices(vertices.len()));
        }
        if let Some(index) =
            vertices.iter().position(|vertex| !(0.0..=FARTHEST_M).contains(&vertex.norm()))
        {
            let Point { x, y } = vertices[index];
            return Err(FootprintError::Vertex { index, x, y });
        }
        let edges: Vec<Segment> = outline(vertices.iter().copied()).collect();
        check_edges(&edges)?;
        let to_edge = |edge: &Segment| edge.distance_sq_to_point(Point::default());
        let boundary_sq = edges.iter().map(to_edge).fold(f64::INFINITY, f64::min);
        let holds_centre = holds_point(edges.iter().copied(), Point::default());
        Ok(Self {
            inscribed_radius_m: if holds_centre { boundary_sq.sqrt() } else { 0.0 },
            circumscribed_radius_m: vertices.iter().map(|v| v.norm()).fold(0.0, f64::max),
            vertices,
        })
    }

    /// Radius of the smallest disc around the centre of rotation that holds the polygon \[m\].
    pub const fn circumscribed_radius_m(&self) -> f64 {
        self.circumscribed_radius_m
    }

    /// The vertices \[m\], in the order given.
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }
}

impl Footprint {
    /// A robot without extent: its centre of rotation.
    pub const POINT: Self = Self::Circle(Circle { radius_m: 0.0 });

    /// The disc of this radius \[m\].
    ///
    /// # Errors
    /// See [`Circle::new`].
    pub fn circle(radius_m: f64) -> Result<Self, FootprintError> {
        Circle::new(radius_m).map(Self::Circle)
    }

    /// A box of this length and width \[m\] around the centre of rotation.
    ///
    /// # Errors
    /// Returns [`FootprintError::Rectangle`] unless both are positive lengths of up to a
    /// kilometre.
    pub fn rectangle(length_m: f64, width_m: f64) -> Result<Self, FootprintError> {
        let is_side = |side_m: f64| side_m > 0.0 && side_m <= FARTHEST_M;
        if !(is_side(length_m) && is_side(width_m)) {
            return Err(FootprintError::Rectangle { length_m, width_m });
        }
        let (x, y) = (0.5 * length_m, 0.5 * width_m);
        let vertices = [(x, y), (-x, y), (-x, -y), (x, -y)];
        Self::polygon(vertices.map(|(x, y)| Point::new(x, y)).to_vec())
    }

    /// The polygon with these vertices \[m\].
    ///
    /// # Errors
    /// See [`Polygon::new`].
    pub fn polygon(vertices: Vec<Point>) -> Result<Self, FootprintError> {
        Polygon::new(vertices).map(Self::Polygon)
    }

    /// Its extent ahead of the centre of rotation \[m\].
    pub(crate) fn foremost_m(&self) -> f64 {
        match self {
            Self::Circle(circle) => circle.radius_m(),
            Self::Polygon(polygon) => {
                polygon.vertices().iter().map(|vertex| vertex.x).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }

    /// True if the footprint covers a point in the robot's frame \[m\]. For a point on the edge of
    /// a polygon, the result may be either.
    pub fn covers(&self, place: Point) -> bool {
        match self {
            Self::Circle(circle) => place.norm() <= circle.radius_m(),
            Self::Polygon(polygon) => {
                holds_point(outline(polygon.vertices().iter().copied()), place)
            }
        }
    }

    /// The footprint scaled around the centre of rotation so that its inscribed radius shrinks by
    /// `by_m`: all of its outline moves inwards, everywhere by at least `by_m` \[m\]. `None` if
    /// nothing would remain, or if the length is not a number of at least 0.
    #[must_use]
    pub fn smaller_by(&self, by_m: f64) -> Option<Self> {
        let radius_m = self.inscribed_radius_m();
        if !(0.0..=radius_m).contains(&by_m) {
            return None;
        }
        match self {
            Self::Circle(_) => Self::circle(radius_m - by_m).ok(),
            Self::Polygon(polygon) => {
                let scale = 1.0 - by_m / radius_m;
                Self::polygon(polygon.vertices.iter().map(|&vertex| vertex * scale).collect()).ok()
            }
        }
    }

    /// Radius of the largest disc around the centre of rotation inside the footprint \[m\]; 0 if
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
}

/// Refuses edges without length, and edges that touch each other anywhere but at a common vertex.
fn check_edges(edges: &[Segment]) -> Result<(), FootprintError> {
    let least_sq = Polygon::LEAST_LENGTH_M * Polygon::LEAST_LENGTH_M;
    if let Some(i) = edges.iter().position(|edge| (edge.b - edge.a).norm_sq() < least_sq) {
        return Err(FootprintError::Repeated(i, (i + 1) % edges.len()));
    }
    for (i, edge) in edges.iter().enumerate() {
        let next = &edges[(i + 1) % edges.len()];
        // The far end of one edge lies on its neighbour: a spike, or no area at all.
        let folds = next.distance_sq_to_point(edge.a) < least_sq
            || edge.distance_sq_to_point(next.b) < least_sq;
        if folds {
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

/// True if two segments cross or touch.
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

/// Formats the radius, or the length and width of a polygon.
impl Display for Footprint {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Circle(circle) => write!(f, "radius {} m", circle.radius_m),
            Self::Polygon(polygon) => {
                let span = |of: fn(&Point) -> f64| {
                    let values = polygon.vertices.iter().map(of);
                    let ends =
                        |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
                    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), ends);
                    // To the millimetre.
                    ((high - low) * 1e3).round() / 1e3
                };
                write!(f, "{} m x {} m", span(|v| v.x), span(|v| v.y))
            }
        }
    }
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

/// The vertices of a star around a point: one at each radius in turn, at equal angles.
#[cfg(test)]
pub(crate) fn star(radii: &[f64], around: (f64, f64)) -> Vec<Point> {
    let step_rad = std::f64::consts::TAU / radii.len() as f64;
    let vertex = |(i, &radius): (usize, &f64)| {
        let (sin, cos) = (step_rad * i as f64).sin_cos();
        Point::new(around.0 + radius * cos, around.1 + radius * sin)
    };
    radii.iter().enumerate().map(vertex).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(vertices: &[[f64; 2]]) -> Result<Footprint, FootprintError> {
        Footprint::polygon(vertices.iter().map(|&vertex| vertex.into()).collect())
    }

    #[test]
    fn a_smaller_footprint_is_inside_by_as_much() {
        let smaller = Footprint::circle(0.2).unwrap().smaller_by(0.05).unwrap();
        assert!((smaller.inscribed_radius_m() - 0.15).abs() < 1e-12);
        let smaller = Footprint::rectangle(0.6, 0.2).unwrap().smaller_by(0.05).unwrap();
        let half = Footprint::rectangle(0.3, 0.1).unwrap();
        assert!((smaller.inscribed_radius_m() - half.inscribed_radius_m()).abs() < 1e-12);
        assert!((smaller.circumscribed_radius_m() - half.circumscribed_radius_m()).abs() < 1e-12);
        for by_m in [0.21, -0.01, f64::NAN] {
            assert_eq!(Footprint::circle(0.2).unwrap().smaller_by(by_m), None);
        }
        assert_eq!(
            Footprint::rectangle(0.6, 0.4).unwrap().smaller_by(0.2),
            None,
            "nothing is left"
        );
    }

    #[test]
    fn radii() {
        let box_ = polygon(&[[0.3, 0.2], [-0.1, 0.2], [-0.1, -0.2], [0.3, -0.2]]).unwrap();
        assert_eq!(box_.inscribed_radius_m(), 0.1);
        assert!((box_.circumscribed_radius_m() - 0.13_f64.sqrt()).abs() < 1e-15);
        assert_eq!(box_.to_string(), "0.4 m x 0.4 m");
        assert_eq!(Footprint::circle(0.18).unwrap().to_string(), "radius 0.18 m");
        assert_eq!(Footprint::rectangle(0.508, 0.43).unwrap().to_string(), "0.508 m x 0.43 m");
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
        assert_eq!(polygon(&twice), Err(FootprintError::Repeated(1, 2)));
        let closed = polygon(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]).unwrap_err();
        let expected = "vertices 3 and 0 of the footprint coincide; leave one out";
        assert!(closed.to_string().starts_with(expected), "{closed}");
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(polygon(&bow), Err(FootprintError::SelfIntersecting(0, 2)));
        let nan = [[0.0, 0.0], [f64::NAN, 1.0], [1.0, 0.0]];
        let error = polygon(&nan).unwrap_err().to_string();
        assert_eq!(error, "vertex 1 of the footprint must lie within 1000 m, got (NaN, 1)");
        assert!(serde_json::from_str::<Footprint>(r#"{"vertices_m": [[0, 0], [1, 0]]}"#).is_err());
        let triangle = polygon(&[[1.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]]).unwrap();
        let text = serde_json::to_string(&triangle).unwrap();
        assert_eq!(serde_json::from_str::<Footprint>(&text).unwrap(), triangle);
    }

    #[test]
    fn a_footprint_has_a_thousand_vertices_at_most() {
        let ring = |count| Footprint::polygon(star(&vec![0.3; count], (0.0, 0.0)));
        assert!(ring(Polygon::MOST_VERTICES).is_ok());
        assert_eq!(ring(101).err(), Some(FootprintError::TooManyVertices(101)));
    }

    #[test]
    fn only_lengths_are_sides_of_a_rectangle() {
        for side_m in [0.0, -1.0, f64::NAN, f64::INFINITY, 1000.1] {
            for (length_m, width_m) in [(side_m, 1.0), (1.0, side_m)] {
                let refused = Footprint::rectangle(length_m, width_m);
                assert!(matches!(refused, Err(FootprintError::Rectangle { .. })), "{side_m}");
            }
        }
        let error = Footprint::rectangle(-0.5, 0.4).unwrap_err().to_string();
        assert!(error.ends_with("above 0 and at most 1000 m, got -0.5 and 0.4"), "{error}");
    }

    #[test]
    fn only_lengths_are_radii() {
        for radius_m in [0.0, 0.4, 1000.0] {
            let circle = Footprint::circle(radius_m).unwrap();
            assert_eq!(circle.inscribed_radius_m(), radius_m);
            let text = serde_json::to_string(&circle).unwrap();
            assert_eq!(text, format!(r#"{{"radius_m":{radius_m:?}}}"#));
            assert_eq!(serde_json::from_str::<Footprint>(&text).unwrap(), circle);
        }
        for radius_m in [-0.1, f64::NAN, f64::INFINITY, 1000.1] {
            assert!(matches!(Footprint::circle(radius_m), Err(FootprintError::Radius(_))));
        }
        assert!(serde_json::from_str::<Footprint>(r#"{"radius_m": -0.4}"#).is_err());
        assert!(toml::from_str::<Footprint>("radius_m = nan").is_err());
    }
}
