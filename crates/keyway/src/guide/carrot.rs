//! Carrot: the point of the route a look-ahead distance ahead of the robot's progress.
//!
//! It moves along with the robot, so the robot follows the route itself and not only its corners.
//! Progress is the arc length of the nearest point of the route and never decreases.
//!
//! # Source
//! The carrot of [`crate::local::Follower`], \[Coulter1992\], for any local planner.
//!
//! # Errors / cost
//! [`ConfigError`]. Linear in the segments of the route.

use super::parameters::{BoxedGuide, GuideParameters};
use super::{Guidance, Guide, GuideMemory, GuideView};
use crate::ConfigError;
use crate::geometry::{Point, Polyline};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// Parameters of [`Carrot`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CarrotConfig {
    /// Look-ahead distance along the route \[m\].
    pub look_ahead_m: f64,
}

impl CarrotConfig {
    /// One cell of 1 m, for the paths of \[ZhuYin2024\]. The paper does not say how its robot
    /// follows a path.
    pub const PAPER: Self = Self { look_ahead_m: 1.0 };

    /// Fields for which the paper gives no value: those of [`Self::PAPER`] are interpretations.
    pub const READINGS: &'static [&'static str] = &["look_ahead_m"];

    /// Look-ahead distance: the distance covered at full speed in one cycle plus twice the
    /// stopping time.
    pub fn for_robot(robot: &Robot) -> Self {
        let horizon_s = robot.cycle_s + 2.0 * robot.limits.stop_s();
        Self { look_ahead_m: robot.limits.v_max_mps * horizon_s }
    }
}

/// Guides along the route at a fixed distance ahead.
#[derive(Clone, Debug)]
pub struct Carrot {
    config: CarrotConfig,
}

impl Carrot {
    /// Its name in stacks and reports.
    pub const NAME: &'static str = "carrot";

    /// Creates the guide.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if the look-ahead distance is not a positive number.
    pub fn new(config: CarrotConfig) -> Result<Self, ConfigError> {
        ConfigError::unless_positive("look_ahead_m", config.look_ahead_m)?;
        Ok(Self { config })
    }
}

/// The point of the route `ahead_m` beyond the robot's progress, and the remaining length from
/// there to the end \[m\].
pub(super) fn ahead(
    view: &GuideView<'_>,
    memory: &mut GuideMemory,
    ahead_m: f64,
) -> Option<(Point, f64)> {
    memory.covered_m = view.path.nearest_along(view.position, memory.covered_m, ahead_m);
    let along_m = memory.covered_m + ahead_m;
    Some((view.path.at_length(along_m)?, (view.path.length_m() - along_m).max(0.0)))
}

impl GuideParameters for CarrotConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self) -> Result<BoxedGuide, ConfigError> {
        Ok(Box::new(Carrot::new(self.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        Self::READINGS
    }
}

impl Guide for Carrot {
    fn guide(&self, view: &GuideView<'_>, memory: &mut GuideMemory) -> Option<Guidance> {
        let (point, beyond_m) = ahead(view, memory, self.config.look_ahead_m)?;
        Some(Guidance { point, remaining_m: view.position.distance(point) + beyond_m })
    }

    fn points(&self, path: &Polyline) -> Vec<Point> {
        path.points().last().copied().into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Clearance, OccupancyGrid};

    #[test]
    fn moves_along_and_stops_at_the_goal() {
        let map = OccupancyGrid::from_ascii(&["."]);
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]];
        let path = Polyline::new(points.iter().map(|&p| p.into()).collect());
        let carrot = Carrot::new(CarrotConfig { look_ahead_m: 1.0 }).unwrap();
        let mut memory = GuideMemory::default();
        let mut at = |x, y| {
            let position = Point::new(x, y);
            let view = GuideView {
                path: &path,
                position,
                obstacles: Clearance::new(map.frame(), map.occupied()),
                clearance_m: 0.1,
            };
            carrot.guide(&view, &mut memory).unwrap()
        };
        assert_eq!(at(0.5, 0.0), Guidance { point: Point::new(1.5, 0.0), remaining_m: 6.5 });
        // 3.5 m along, the carrot is half a metre around the corner.
        let _ = at(1.5, 0.1);
        let _ = at(2.5, 0.1);
        assert_eq!(at(3.5, 0.0).point, Point::new(4.0, 0.5));
        // Back to the beginning: the carrot stays.
        assert_eq!(at(0.0, 0.0).point, Point::new(4.0, 0.5));
        for y in [0.5, 1.5, 2.5] {
            let _ = at(4.0, y);
        }
        let last = at(4.0, 2.9);
        assert!(last.point == Point::new(4.0, 3.0) && (last.remaining_m - 0.1).abs() < 1e-12);
        assert_eq!(carrot.points(&path), [Point::new(4.0, 3.0)]);
        let view = GuideView {
            path: &Polyline::default(),
            position: Point::default(),
            obstacles: Clearance::new(map.frame(), map.occupied()),
            clearance_m: 0.1,
        };
        assert_eq!(carrot.guide(&view, &mut GuideMemory::default()), None);
    }
}
