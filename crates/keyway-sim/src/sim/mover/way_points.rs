//! A motion along a closed path.

use super::{unless_finite, unless_usable_speed};
use keyway::ConfigError;
use keyway::geometry::Point;

/// A motion along a path at constant speed, repeated: around way-points in turn, or along them
/// to and fro. At time 0 the obstacle is at the first way-point. It turns instantly: corners are
/// not rounded.
#[derive(Clone, Debug, PartialEq)]
pub struct WayPoints {
    points: Vec<Point>,
    to_and_fro: bool,
    speed_mps: f64,
    /// One round: the way-points, those of the return path, and the first again.
    course: Vec<Station>,
}

/// A position on the path.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Station {
    position: Point,
    /// Path length before it \[m\].
    driven_m: f64,
}

impl WayPoints {
    /// A path from each way-point to the next, and from the last to the first.
    ///
    /// # Errors
    /// Returns an error if there are fewer than two different points, a number is not finite, or
    /// the speed is not positive or higher than
    /// [`MovingObstacle::FASTEST_MPS`](super::MovingObstacle::FASTEST_MPS). Error paths begin
    /// with `way_points` or `speed_mps`.
    pub fn around(points: Vec<Point>, speed_mps: f64) -> Result<Self, ConfigError> {
        Self::new(points, speed_mps, false)
    }

    /// A path from the first way-point to the last and back.
    ///
    /// # Errors
    /// Those of [`Self::around`].
    pub fn to_and_fro(points: Vec<Point>, speed_mps: f64) -> Result<Self, ConfigError> {
        Self::new(points, speed_mps, true)
    }

    pub(super) fn new(
        points: Vec<Point>,
        speed_mps: f64,
        to_and_fro: bool,
    ) -> Result<Self, ConfigError> {
        ConfigError::unless_positive("speed_mps", speed_mps)?;
        unless_usable_speed("speed_mps", speed_mps)?;
        for (i, &point) in points.iter().enumerate() {
            unless_finite(&format!("way_points[{i}]"), point)?;
        }
        let way_back = points.iter().rev().skip(1).filter(|_| to_and_fro);
        let mut course: Vec<Station> = Vec::new();
        for &position in points.iter().chain(way_back).chain(points.first()) {
            let driven_m = course
                .last()
                .map_or(0.0, |station| station.driven_m + station.position.distance(position));
            course.push(Station { position, driven_m });
        }
        let round_m = course.last().map_or(0.0, |station| station.driven_m);
        if !(round_m > 0.0 && round_m.is_finite()) {
            let expected = "must hold at least two different points, with a path between them of finite length";
            return Err(ConfigError::new("way_points", expected));
        }
        Ok(Self { points, to_and_fro, speed_mps, course })
    }

    /// The way-points, each once.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// True if the obstacle turns back at the last way-point.
    pub const fn is_to_and_fro(&self) -> bool {
        self.to_and_fro
    }

    /// Speed \[m/s\].
    pub const fn speed_mps(&self) -> f64 {
        self.speed_mps
    }

    /// Position at a time \[m\]. Costs a binary search.
    pub fn position(&self, t_s: f64) -> Point {
        let round_m = self.course[self.course.len() - 1].driven_m;
        let driven_m = (self.speed_mps * t_s).rem_euclid(round_m);
        // The first station is at 0, so there is one before; at the end of a round there is none
        // after.
        let after = self.course.partition_point(|station| station.driven_m <= driven_m);
        let from = self.course[after.max(1) - 1];
        let Some(to) = self.course.get(after) else { return from.position };
        let part = (driven_m - from.driven_m) / (to.driven_m - from.driven_m);
        from.position.lerp(to.position, part)
    }
}
