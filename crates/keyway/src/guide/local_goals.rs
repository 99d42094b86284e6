//! Local goals \[S1\]: a smoothed path -> one point after the other at a fixed spacing along it,
//! the goal last.
//!
//! # Source
//! \[S1\]: the fusion of its planner with the dynamic window approach.
//!
//! | paper | here | unit | value |
//! |---|---|---|---|
//! | spacing of the local goals | `spacing_m` | m | not given; read as 2 |
//! | reached within | `reach_m` | m | not given; read as 0.5 |
//!
//! # Where this differs from the paper
//! - The paper gives neither the spacing of the local goals nor the distance at which one counts as
//!   reached.
//!
//! # Errors / cost
//! [`ConfigError`]. Linear in the segments of the route.

use super::parameters::{BoxedGuide, GuideParameters};
use super::{Guidance, Guide, GuideMemory, GuideView};
use crate::ConfigError;
use crate::geometry::{Point, Polyline};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// Parameters of [`LocalGoals`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LocalGoalsConfig {
    /// Spacing of the local goals along the route \[m\].
    pub spacing_m: f64,
    /// Distance within which the next one is taken \[m\].
    pub reach_m: f64,
}

impl LocalGoalsConfig {
    /// As published; both values are interpretations.
    pub const PAPER: Self = Self { spacing_m: 2.0, reach_m: 0.5 };

    /// Fields for which the paper gives no value: those of [`Self::PAPER`] are interpretations.
    pub const READINGS: &'static [&'static str] = &["spacing_m", "reach_m"];

    /// Spacing: the distance covered at full speed in one cycle plus twice the stopping time. The
    /// reach is half of that, so a robot on its route always has at least as much ahead of it and
    /// does not slow down for a local goal.
    pub fn for_robot(robot: &Robot) -> Self {
        let horizon_s = robot.cycle_s + 2.0 * robot.limits.stop_s();
        let spacing_m = robot.limits.v_max_mps * horizon_s;
        Self { spacing_m, reach_m: 0.5 * spacing_m }
    }
}

/// Guides along points of a route at a fixed spacing.
#[derive(Clone, Debug)]
pub struct LocalGoals {
    config: LocalGoalsConfig,
}

impl LocalGoals {
    /// Its name in stacks and reports.
    pub const NAME: &'static str = "local-goals";

    /// Upper limit on the local goals of a route; more indicate a mistake in the config.
    const MOST: f64 = 1e6;

    /// Creates the guide.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if the spacing or the reach is not a positive number.
    pub fn new(config: LocalGoalsConfig) -> Result<Self, ConfigError> {
        ConfigError::unless_positive("spacing_m", config.spacing_m)?;
        ConfigError::unless_positive("reach_m", config.reach_m)?;
        Ok(Self { config })
    }

    /// Number of local goals of a path of this length: one after each whole spacing that ends
    /// before the goal, and the goal. Rounding adds none.
    fn count(&self, length_m: f64) -> usize {
        let whole = (length_m / self.config.spacing_m * (1.0 - 1e-9)).floor();
        whole.min(Self::MOST) as usize + 1
    }

    /// Arc length of a local goal from the start of the path; the last one is at its end.
    fn along_m(&self, index: usize, count: usize, length_m: f64) -> f64 {
        if index + 1 >= count { length_m } else { (index as f64 + 1.0) * self.config.spacing_m }
    }
}

impl GuideParameters for LocalGoalsConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self) -> Result<BoxedGuide, ConfigError> {
        Ok(Box::new(LocalGoals::new(self.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        Self::READINGS
    }
}

impl Guide for LocalGoals {
    fn guide(&self, view: &GuideView<'_>, memory: &mut GuideMemory) -> Option<Guidance> {
        let length_m = view.path.length_m();
        let count = self.count(length_m);
        loop {
            let along_m = self.along_m(memory.passed, count, length_m);
            let point = view.path.at_length(along_m)?;
            let distance_m = view.position.distance(point);
            if distance_m > self.config.reach_m || memory.passed + 1 >= count {
                return Some(Guidance { point, remaining_m: distance_m + length_m - along_m });
            }
            memory.passed += 1;
        }
    }

    fn points(&self, path: &Polyline) -> Vec<Point> {
        let length_m = path.length_m();
        let count = self.count(length_m);
        let along_m = |index| self.along_m(index, count, length_m);
        (0..count).filter_map(|index| path.at_length(along_m(index))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Clearance, OccupancyGrid};

    fn line(points: &[[f64; 2]]) -> Polyline {
        Polyline::new(points.iter().map(|&p| p.into()).collect())
    }

    fn at(path: &Polyline, memory: &mut GuideMemory, x: f64, y: f64) -> Option<Guidance> {
        let map = OccupancyGrid::from_ascii(&["."]);
        let obstacles = Clearance::new(map.frame(), map.occupied());
        let view = GuideView { path, position: Point::new(x, y), obstacles, clearance_m: 0.1 };
        LocalGoals::new(LocalGoalsConfig::PAPER).unwrap().guide(&view, memory)
    }

    #[test]
    fn every_two_metres_and_the_goal() {
        let guide = LocalGoals::new(LocalGoalsConfig::PAPER).unwrap();
        let points = |path: &Polyline| {
            guide.points(path).into_iter().map(<[f64; 2]>::from).collect::<Vec<_>>()
        };
        // 7 m with a corner after 3 m.
        let path = line(&[[0., 0.], [3., 0.], [3., 4.]]);
        assert_eq!(points(&path), [[2., 0.], [3., 1.], [3., 3.], [3., 4.]]);
        // The goal is not given twice.
        assert_eq!(points(&line(&[[0., 0.], [4., 0.]])), [[2., 0.], [4., 0.]]);
        assert_eq!(points(&line(&[[0., 0.], [0.5, 0.]])), [[0.5, 0.]]);
        assert_eq!(points(&line(&[[1., 1.]])), [[1., 1.]]);
        assert!(points(&Polyline::default()).is_empty());
    }

    #[test]
    fn the_next_one_is_taken_within_half_a_metre() {
        let path = line(&[[0., 0.], [3., 0.], [3., 4.]]);
        let mut memory = GuideMemory::default();
        let mut at = |x, y| at(&path, &mut memory, x, y).unwrap();
        assert_eq!(at(0.0, 0.0), Guidance { point: Point::new(2.0, 0.0), remaining_m: 7.0 });
        assert_eq!(at(1.4, 0.0).point, Point::new(2.0, 0.0));
        let next = at(1.5, 0.0);
        assert_eq!(next.point, Point::new(3.0, 1.0));
        assert!((next.remaining_m - (1.5_f64.hypot(1.0) + 3.0)).abs() < 1e-12);
        // Back at the beginning: what was passed stays passed.
        assert_eq!(at(0.0, 0.0).point, Point::new(3.0, 1.0));
        assert_eq!(at(3.0, 1.0).point, Point::new(3.0, 3.0));
        assert_eq!(at(3.0, 3.9).point, Point::new(3.0, 3.0), "each in its turn");
        assert_eq!(at(3.0, 3.5).point, Point::new(3.0, 4.0));
        assert_eq!(at(3.0, 4.0), Guidance { point: Point::new(3.0, 4.0), remaining_m: 0.0 });
    }

    #[test]
    fn degenerate_paths() {
        let mut memory = GuideMemory::default();
        assert_eq!(at(&Polyline::default(), &mut memory, 0.0, 0.0), None);
        let only = at(&line(&[[1., 1.]]), &mut memory, 1.0, 3.0).unwrap();
        assert_eq!(only, Guidance { point: Point::new(1.0, 1.0), remaining_m: 2.0 });
        let refused = |spacing_m, reach_m| {
            LocalGoals::new(LocalGoalsConfig { spacing_m, reach_m }).unwrap_err().path
        };
        assert_eq!(
            (refused(0.0, 1.0), refused(1.0, f64::NAN)),
            ("spacing_m".into(), "reach_m".into())
        );
    }
}
