//! Guides of the local planner: a smoothed route -> the point to drive towards in this cycle.
//!
//! ```
//! use keyway::geometry::{Point, Polyline};
//! use keyway::guide::{GuideConfig, GuideMemory, GuideView};
//! use keyway::map::{Clearance, OccupancyGrid};
//! use keyway::robot::Robot;
//!
//! let map = OccupancyGrid::from_ascii(&["........", "........"]);
//! let path = Polyline::new(vec![Point::new(0.5, 0.5), Point::new(6.5, 0.5), Point::new(7.5, 1.5)]);
//! let guide = GuideConfig::by_name("carrot", &Robot::small()).expect("a name").build()?;
//! let mut memory = GuideMemory::default();
//! let (position, obstacles) = (Point::new(1.0, 0.6), Clearance::new(map.frame(), map.occupied()));
//! let view = GuideView { path: &path, position, obstacles, clearance_m: 0.18 };
//! let guidance = guide.guide(&view, &mut memory).expect("the path is not empty");
//! assert!(guidance.point.x > 1.5 && guidance.point.y == 0.5);
//! assert_eq!(memory.covered_m, 0.5);
//! # Ok::<(), keyway::ConfigError>(())
//! ```

mod carrot;
mod config;
mod goal;
mod key_points;
mod local_goals;
mod parameters;

pub use carrot::{Carrot, CarrotConfig};
pub use config::GuideConfig;
pub use goal::{GoalConfig, GoalGuide};
pub use key_points::{KeyPoints, KeyPointsConfig, PassedWhen};
pub use local_goals::{LocalGoals, LocalGoalsConfig};

use crate::geometry::{Point, Polyline};
use crate::map::Clearance;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;

/// Chooses the point that the local planner drives towards.
///
/// A guide is an immutable configuration; its state along a route is [`GuideMemory`].
///
/// ```
/// use keyway::geometry::{Point, Polyline};
/// use keyway::guide::{Guidance, Guide, GuideMemory, GuideView};
///
/// /// Hands out the points of the route, each until the robot is nearer to it than 0.3 m.
/// #[derive(Debug)]
/// struct Beads;
///
/// impl Guide for Beads {
///     fn guide(&self, view: &GuideView<'_>, memory: &mut GuideMemory) -> Option<Guidance> {
///         let points = view.path.points();
///         while memory.passed + 1 < points.len()
///             && view.position.distance(points[memory.passed]) < 0.3
///         {
///             memory.passed += 1;
///         }
///         let left = points.get(memory.passed..)?;
///         let ahead_m = view.position.distance(*left.first()?);
///         let remaining_m = ahead_m + Polyline::new(left.to_vec()).length_m();
///         Some(Guidance { point: left[0], remaining_m })
///     }
///
///     fn points(&self, path: &Polyline) -> Vec<Point> {
///         path.points().to_vec()
///     }
/// }
///
/// use keyway::map::{Clearance, OccupancyGrid};
///
/// let map = OccupancyGrid::from_ascii(&["....", "....", "...."]);
/// let path = Polyline::new([[0.5, 0.5], [2.5, 0.5], [2.5, 2.5]].map(Point::from).to_vec());
/// let obstacles = Clearance::new(map.frame(), map.occupied());
/// let position = Point::new(0.5, 0.5);
/// let view = GuideView { path: &path, position, obstacles, clearance_m: 0.2 };
/// let guidance = Beads.guide(&view, &mut GuideMemory::default());
/// assert_eq!(guidance, Some(Guidance { point: Point::new(2.5, 0.5), remaining_m: 4.0 }));
/// ```
pub trait Guide: Debug {
    /// The guidance of this cycle; `None` for a path without points.
    fn guide(&self, view: &GuideView<'_>, memory: &mut GuideMemory) -> Option<Guidance>;

    /// The guide points of a path in order, the goal last. Only the goal for a guide whose point
    /// moves along.
    fn points(&self, path: &Polyline) -> Vec<Point>;
}

/// Input of a guide, built by the caller.
#[derive(Clone, Copy, Debug)]
pub struct GuideView<'a> {
    /// The smoothed route.
    pub path: &'a Polyline,
    /// Position of the robot \[m\].
    pub position: Point,
    /// Distances to all obstacles, known and sensed.
    pub obstacles: Clearance<'a>,
    /// Clearance of a straight line that counts as free \[m\].
    pub clearance_m: f64,
}

/// State of a guide from one cycle to the next. Reset for every route.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GuideMemory {
    /// Number of points of [`Guide::points`] that were passed.
    pub passed: usize,
    /// Progress of the robot: arc length from the start of the route \[m\].
    pub covered_m: f64,
}

/// Output of a guide in one cycle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Guidance {
    /// The guide point \[m\].
    pub point: Point,
    /// Remaining path length: to the guide point and on along the route \[m\].
    pub remaining_m: f64,
}
