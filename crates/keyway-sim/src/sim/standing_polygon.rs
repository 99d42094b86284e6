//! Static polygons.

use keyway::ConfigError;
use keyway::geometry::{Point, Pose};
use keyway::robot::{Footprint, FootprintError};
use serde::{Deserialize, Serialize};

/// A static polygon of any shape with 3 to 100 vertices; the last one is joined to the first. In
/// files and reports it is the list of its vertices, `[x, y]` each \[m\].
///
/// ```
/// use keyway::geometry::Point;
/// use keyway_sim::sim::StandingPolygon;
///
/// let corner = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.2], [0.2, 0.2], [0.2, 1.0], [0.0, 1.0]];
/// let corner = StandingPolygon::new(corner.map(Point::from).to_vec())?;
/// assert_eq!(corner.vertices().len(), 6);
/// # Ok::<(), keyway::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Point>", into = "Vec<Point>")]
pub struct StandingPolygon {
    vertices: Vec<Point>,
    /// The polygon relative to its middle, like the footprint of a robot that faces along the x
    /// axis.
    footprint: Footprint,
    middle: Pose,
}

impl StandingPolygon {
    /// Creates the polygon with these vertices in the world frame \[m\].
    ///
    /// # Errors
    /// Returns an error if there are fewer than 3 or more than 100 vertices, one is not finite or
    /// is farther than a kilometre from the middle, two consecutive vertices coincide, edges
    /// meet, or the area is empty. Error paths begin with `vertices_m`.
    pub fn new(vertices: Vec<Point>) -> Result<Self, ConfigError> {
        for (i, vertex) in vertices.iter().enumerate() {
            for (axis, value) in [vertex.x, vertex.y].into_iter().enumerate() {
                if !value.is_finite() {
                    let path = format!("vertices_m[{i}][{axis}]");
                    return Err(ConfigError::must_be(path, "a finite number", value));
                }
            }
        }
        let first = vertices.first().copied().unwrap_or_default();
        let low = vertices.iter().fold(first, |a, b| Point::new(a.x.min(b.x), a.y.min(b.y)));
        let high = vertices.iter().fold(first, |a, b| Point::new(a.x.max(b.x), a.y.max(b.y)));
        let middle = low.lerp(high, 0.5);
        let around = vertices.iter().map(|&vertex| vertex - middle).collect();
        let footprint = Footprint::polygon(around).map_err(|error| in_words_of_polygons(&error))?;
        Ok(Self { vertices, footprint, middle: Pose::new(middle.x, middle.y, 0.0) })
    }

    /// Vertices in the world frame \[m\].
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    /// True if a point lies in the polygon or on its edge.
    pub fn covers(&self, point: Point) -> bool {
        let (core, _) = self.footprint.core();
        core.distance_to_m(self.middle, point) <= 0.0
    }

    /// The polygon as the footprint and pose of a robot.
    pub(super) const fn placed(&self) -> (&Footprint, Pose) {
        (&self.footprint, self.middle)
    }
}

fn in_words_of_polygons(error: &FootprintError) -> ConfigError {
    let all = |reason: String| ConfigError::new("vertices_m", reason);
    let of = |i: usize, reason: &str| ConfigError::new(format!("vertices_m[{i}]"), reason);
    match error {
        FootprintError::TooFewVertices(count) => all(format!("needs at least 3, got {count}")),
        FootprintError::TooManyVertices(count) => all(format!(
            "has at most 100, got {count}; remove vertices that hardly change the shape"
        )),
        FootprintError::Vertex { index, .. } => {
            of(*index, "must lie within 1000 m of the polygon's middle")
        }
        FootprintError::Repeated(one, other) => all(format!(
            "must differ, but [{one}] and [{other}] coincide (the last one is joined to the first)"
        )),
        FootprintError::Degenerate(i) => of(*i, "is at the tip of a spike without area"),
        FootprintError::SelfIntersecting(one, other) => all(format!(
            "must not touch or cross itself, but the edges from [{one}] and [{other}] do"
        )),
        // Errors that concern only discs and rectangles.
        error => all(error.to_string()),
    }
}

impl TryFrom<Vec<Point>> for StandingPolygon {
    type Error = ConfigError;

    fn try_from(vertices: Vec<Point>) -> Result<Self, ConfigError> {
        Self::new(vertices)
    }
}

impl From<StandingPolygon> for Vec<Point> {
    fn from(polygon: StandingPolygon) -> Self {
        polygon.vertices
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::test_shapes::star;
    use crate::sim::{Obstacle, World};
    use keyway::map::{BitGrid, Cell, GridFrame, OccupancyGrid};
    use keyway::robot::RangeSensor;
    use proptest::prelude::*;

    fn nothing(frame: GridFrame) -> World {
        World::from_known(&OccupancyGrid::all_free(frame), vec![]).unwrap()
    }

    proptest! {
        /// Checks that polygons around cells and hidden cells of the map are equivalent for a
        /// robot and its sensor.
        #[test]
        fn boxes_are_like_the_cells_that_they_cover(
            boxes in prop::collection::vec((0..28i32, 0..18i32, 1..5i32, 1..5i32), 1..4), yaw in -3.1..3.1f64,
            at in (0.0..3.0f64, 0.0..2.0f64, -3.1..3.1f64), radii in prop::collection::vec(0.05..0.4f64, 3..7),
            radius_m in 0.0..0.3f64, reach_m in 0.1..3.0f64,
        ) {
            let frame = GridFrame::new(30, 20, 0.1, Pose::new(4.0, -7.0, yaw)).unwrap();
            let mut hidden = BitGrid::new(30, 20, false);
            let mut polygons = Vec::new();
            for &(x, y, width, height) in &boxes {
                let (right, up) = ((x + width).min(30), (y + height).min(20));
                for cell in (y..up).flat_map(|y| (x..right).map(move |x| Cell::new(x, y))) {
                    hidden.set(cell, true);
                }
                let corners = [(x, y), (right, y), (right, up), (x, up)];
                let corner = |(x, y)| frame.world_from_grid(Point::new(f64::from(x), f64::from(y)));
                polygons.push(StandingPolygon::new(corners.map(corner).to_vec()).unwrap());
            }
            let cells = nothing(frame).with_hidden(&hidden).unwrap();
            let boxes = nothing(frame).with_polygons(polygons);
            let place = frame.world_from_grid(Point::new(at.0 * 10.0, at.1 * 10.0));
            let pose = Pose::new(place.x, place.y, at.2);
            for footprint in [Footprint::polygon(star(&radii, (0.0, 0.0))), Footprint::circle(radius_m)] {
                let footprint = footprint.unwrap();
                let [a_m, b_m] = [&cells, &boxes].map(|world| world.at(0.0).distance(&footprint, pose, reach_m));
                prop_assert!((a_m - b_m).abs() < 1e-9, "{a_m} {b_m}");
                if a_m > 1e-9 && a_m < reach_m {
                    let border_m = cells.at(0.0).border_distance(&footprint, pose);
                    let [a, b] = [&cells, &boxes].map(|world| world.at(0.0).nearest_standing(&footprint, pose));
                    let is_first = a_m < border_m - 1e-9;
                    prop_assert!(!is_first || a == Obstacle::HiddenSquare, "{a:?}");
                    prop_assert!(!is_first || matches!(b, Obstacle::Polygon(_)), "{b:?}");
                }
            }
            let sensor = RangeSensor::new(40, 360.0, 4.0);
            let [a, b] = [&cells, &boxes].map(|world| world.at(0.0).cast(pose, &sensor).ranges_m);
            for (a_m, b_m) in a.into_iter().zip(b) {
                prop_assert!(a_m == b_m || (a_m - b_m).abs() < 1e-9, "{a_m} {b_m}");
            }
        }
    }

    #[test]
    fn what_the_map_shows_is_told_from_what_it_does_not() {
        let known = OccupancyGrid::from_ascii(&[".....", ".....", "#...."]);
        let mut hidden = BitGrid::new(5, 3, false);
        hidden.set(Cell::new(4, 0), true);
        let world = World::from_known(&known, vec![]).unwrap().with_hidden(&hidden).unwrap();
        let point = Footprint::circle(0.0).unwrap();
        let nearest = |x, y| world.at(0.0).nearest_standing(&point, Pose::new(x, y, 0.0));
        assert_eq!(
            (nearest(1.2, 0.5), nearest(3.8, 0.5)),
            (Obstacle::Square, Obstacle::HiddenSquare)
        );
    }

    #[test]
    fn errors_name_the_vertex() {
        let error = |points: &[[f64; 2]]| {
            let points = points.iter().copied().map(Point::from).collect();
            StandingPolygon::new(points).unwrap_err().to_string()
        };
        assert!(error(&[]).contains("vertices_m needs at least 3, got 0"), "{}", error(&[]));
        let nan = error(&[[0.0, 0.0], [1.0, f64::NAN], [1.0, 1.0]]);
        assert!(nan.starts_with("vertices_m[1][1] must be a finite number"), "{nan}");
        let bow = error(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        assert!(bow.contains("the edges from [0] and [2] do"), "{bow}");
        let same = error(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]]);
        assert!(same.contains("[3] and [0] coincide"), "{same}");
        let line = error(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
        assert!(line.contains("spike"), "{line}");
        let far = error(&[[0.0, 0.0], [5e3, 0.0], [5e3, 1.0]]);
        assert!(far.contains("within 1000 m of the polygon's middle"), "{far}");
        let many: Vec<[f64; 2]> =
            (0..101).map(|i| f64::from(i) / 16.2).map(|a| [a.cos(), a.sin()]).collect();
        assert!(error(&many).contains("at most 100, got 101"));
    }
}
