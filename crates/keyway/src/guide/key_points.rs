//! Key points \[You2021\]: a smoothed path -> the point that the local planner drives towards.
//!
//! The key points are the turning points of the smoothed path and its goal. The local planner is
//! sent to one after the other. The next one is taken when the robot has come close enough to the
//! current one; with [`KeyPointsConfig::passed_when`] = `in-sight`, as soon as the straight line
//! to the next one is free, and not before. With a look-ahead distance, the point moves on along
//! the route earlier, because a robot that drives towards a nearby point has to creep.
//!
//! # Source
//! \[You2021\]: section 3, steps (3) and (6), table 3.
//!
//! | paper | here | unit | table 3 |
//! |---|---|---|---|
//! | R2 | `reach_m` | m | 1.5 |
//!
//! # Where this differs from the paper
//! - `in-sight` and `look_ahead_m` are not in the paper, whose maps have cells of 1 m. On a fine
//!   map, driving up to a key point would only slow the robot down when the route beyond it is
//!   already in sight. And if a key point is dropped while the next one is still behind a corner,
//!   the robot gets stuck in front of that corner.

use super::carrot::ahead;
use super::parameters::{BoxedGuide, GuideParameters};
use super::{Guidance, Guide, GuideMemory, GuideView};
use crate::ConfigError;
use crate::geometry::{Point, Polyline, Segment};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// Parameters of [`KeyPoints`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct KeyPointsConfig {
    /// R2: a key point is passed within this distance \[m\]. With `in-sight`: within this
    /// distance, the line of sight from the key point itself counts as the robot's.
    pub reach_m: f64,
    /// Condition for taking the next key point: `within-reach` or `in-sight`.
    pub passed_when: PassedWhen,
    /// Minimum distance of the guide point ahead along the route, up to the goal \[m\]. The guide
    /// point is the key point, or the point of the route at this distance if the key point is
    /// closer. 0 for key points alone.
    pub look_ahead_m: f64,
}

/// Condition for a key point to count as passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum PassedWhen {
    /// Within the reach, regardless of line of sight \[You2021\].
    WithinReach,
    /// The straight line to the next key point keeps the clearance. Within the reach, it is
    /// enough that the line from the key point itself is free of obstacles; it need not keep the
    /// clearance.
    InSight,
}

impl KeyPointsConfig {
    /// As published.
    pub const PAPER: Self =
        Self { reach_m: 1.5, passed_when: PassedWhen::WithinReach, look_ahead_m: 0.0 };

    /// In sight. The reach is the distance covered in one cycle at full speed, because no robot
    /// hits a point more exactly than that without slowing down. The look-ahead distance is the
    /// stopping distance from full speed, including one cycle of reaction.
    pub fn for_robot(robot: &Robot) -> Self {
        let reach_m = robot.limits.v_max_mps * robot.cycle_s;
        let look_ahead_m = reach_m + robot.limits.stop_m();
        Self { reach_m, passed_when: PassedWhen::InSight, look_ahead_m }
    }
}

/// Guides along the key points of a route.
#[derive(Clone, Debug)]
pub struct KeyPoints {
    config: KeyPointsConfig,
}

impl KeyPoints {
    /// Its name in stacks and reports.
    pub const NAME: &'static str = "key-points";

    /// Creates the guide.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if the reach is not a positive number, or if the look-ahead
    /// distance is negative.
    pub fn new(config: KeyPointsConfig) -> Result<Self, ConfigError> {
        ConfigError::unless_positive("reach_m", config.reach_m)?;
        ConfigError::unless_not_negative("look_ahead_m", config.look_ahead_m)?;
        Ok(Self { config })
    }
}

/// The points of a path after its first one, which is where the robot starts.
fn key_points(path: &Polyline) -> &[Point] {
    match path.points() {
        only @ [_] => only,
        points => points.get(1..).unwrap_or_default(),
    }
}

impl KeyPoints {
    /// True if the robot has passed the key point `current`, given the one that follows.
    fn is_passed(&self, view: &GuideView<'_>, current: Point, following: Point) -> bool {
        let is_within_reach = view.position.distance(current) <= self.config.reach_m;
        let is_free =
            |from, clearance_m| view.obstacles.is_clear(Segment::new(from, following), clearance_m);
        match self.config.passed_when {
            PassedWhen::WithinReach => is_within_reach,
            PassedWhen::InSight => {
                is_free(view.position, view.clearance_m) || is_within_reach && is_free(current, 0.0)
            }
        }
    }
}

impl GuideParameters for KeyPointsConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self) -> Result<BoxedGuide, ConfigError> {
        Ok(Box::new(KeyPoints::new(self.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }
}

impl Guide for KeyPoints {
    /// Moves on to later key points as long as the current one counts as passed.
    fn guide(&self, view: &GuideView<'_>, memory: &mut GuideMemory) -> Option<Guidance> {
        let (points, position) = (key_points(view.path), view.position);
        while let Some(&[current, following, ..]) = points.get(memory.passed..) {
            if !self.is_passed(view, current, following) {
                break;
            }
            memory.passed += 1;
        }
        let left = points.get(memory.passed..).unwrap_or_default();
        let mut point = *left.first()?;
        let mut beyond_m = left.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        if self.config.look_ahead_m > 0.0 {
            let ahead = ahead(view, memory, self.config.look_ahead_m)?;
            if ahead.1 < beyond_m {
                (point, beyond_m) = ahead;
            }
        }
        Some(Guidance { point, remaining_m: position.distance(point) + beyond_m })
    }

    fn points(&self, path: &Polyline) -> Vec<Point> {
        key_points(path).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{Cell, CellState, Clearance, GridFrame, OccupancyGrid};

    fn corner() -> Polyline {
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]];
        Polyline::new(points.iter().map(|&p| p.into()).collect())
    }

    /// The guidance at a position in a hall of 9 x 9 m with walls in the given cells.
    fn guidance(
        config: &KeyPointsConfig,
        memory: &mut GuideMemory,
        (x, y): (f64, f64),
        walls: &[Cell],
    ) -> Guidance {
        let frame = GridFrame::new(9, 9, 1.0, Pose::new(-2.5, -2.5, 0.0)).unwrap();
        let map = OccupancyGrid::from_fn(frame, |cell| {
            if walls.contains(&cell) { CellState::Occupied } else { CellState::Free }
        });
        let position = Point::new(x, y);
        let path = corner();
        let view = GuideView {
            path: &path,
            position,
            obstacles: Clearance::new(map.frame(), map.occupied()),
            clearance_m: 0.1,
        };
        KeyPoints::new(config.clone()).unwrap().guide(&view, memory).unwrap()
    }

    #[test]
    fn the_next_point_is_taken_within_reach() {
        let mut memory = GuideMemory::default();
        let mut at = |x, y| guidance(&KeyPointsConfig::PAPER, &mut memory, (x, y), &[]);
        assert_eq!(at(1.0, 0.0), Guidance { point: Point::new(4.0, 0.0), remaining_m: 6.0 });
        assert_eq!(at(2.5, 0.0).point, Point::new(4.0, 3.0));
        assert_eq!(at(4.0, 3.0).point, Point::new(4.0, 3.0), "the goal stays");
        assert_eq!(memory.passed, 1);
    }

    #[test]
    fn the_next_point_is_taken_when_seen() {
        let config =
            KeyPointsConfig { reach_m: 0.1, passed_when: PassedWhen::InSight, look_ahead_m: 0.0 };
        let at = |walls: &[Cell]| {
            guidance(&config, &mut GuideMemory::default(), (1.0, 0.0), walls).point
        };
        assert_eq!(at(&[]), Point::new(4.0, 3.0));
        // The cell from (2.5, 1.5) to (3.5, 2.5) blocks the line.
        assert_eq!(at(&[Cell::new(5, 4)]), Point::new(4.0, 0.0));
    }

    #[test]
    fn a_point_is_driven_to_where_the_next_one_is_hidden() {
        let config =
            KeyPointsConfig { reach_m: 0.1, passed_when: PassedWhen::InSight, look_ahead_m: 0.0 };
        // The cell from (2.5, 1.5) to (3.5, 2.5) occludes the next point until the robot is nearly
        // at this one.
        let behind = |at: (f64, f64), walls: &[Cell]| {
            guidance(&config, &mut GuideMemory::default(), at, walls).point
        };
        let beside = [Cell::new(5, 4)];
        assert_eq!(behind((2.7, -0.5), &beside), Point::new(4.0, 0.0));
        assert_eq!(behind((3.95, 0.0), &beside), Point::new(4.0, 3.0));
        // From (3.5, 1.5) to (4.5, 2.5): on the next leg itself.
        assert_eq!(behind((3.95, 0.0), &[Cell::new(6, 4)]), Point::new(4.0, 0.0));
        let paper = &KeyPointsConfig::PAPER;
        let at = guidance(paper, &mut GuideMemory::default(), (2.7, -0.5), &beside);
        assert_eq!(at.point, Point::new(4.0, 3.0), "R2 alone");
    }

    #[test]
    fn the_point_moves_on_before_a_key_point_is_reached() {
        let config = KeyPointsConfig { look_ahead_m: 1.5, ..KeyPointsConfig::PAPER };
        let config = KeyPointsConfig { reach_m: 0.1, ..config };
        let mut memory = GuideMemory::default();
        let mut at = |x, y| guidance(&config, &mut memory, (x, y), &[]);
        assert_eq!(
            at(1.0, 0.0).point,
            Point::new(4.0, 0.0),
            "farther than the look-ahead distance"
        );
        assert_eq!(at(2.4, 0.0).point, Point::new(4.0, 0.0));
        let ahead = at(3.5, 0.0);
        assert_eq!(ahead.point, Point::new(4.0, 1.0));
        assert!((ahead.remaining_m - (1.25_f64.sqrt() + 2.0)).abs() < 1e-12, "{ahead:?}");
        // It does not go back, and it stops at the goal.
        assert_eq!(at(1.0, 0.0).point, Point::new(4.0, 1.0));
        assert_eq!(at(4.0, 1.0).point, Point::new(4.0, 2.5));
        assert_eq!(at(4.0, 2.0).point, Point::new(4.0, 3.0));
        assert_eq!(at(4.0, 3.0), Guidance { point: Point::new(4.0, 3.0), remaining_m: 0.0 });
    }

    #[test]
    fn degenerate_paths() {
        let map = OccupancyGrid::from_ascii(&["."]);
        let guide = KeyPoints::new(KeyPointsConfig::PAPER).unwrap();
        let at = |path: &Polyline| {
            let position = Point::default();
            let view = GuideView {
                path,
                position,
                obstacles: Clearance::new(map.frame(), map.occupied()),
                clearance_m: 0.1,
            };
            guide.guide(&view, &mut GuideMemory::default()).map(|guidance| guidance.point)
        };
        assert_eq!(at(&Polyline::default()), None);
        let only = Point::new(1.0, 1.0);
        assert_eq!(at(&Polyline::new(vec![only])), Some(only));
        assert_eq!(guide.points(&corner()), [Point::new(4.0, 0.0), Point::new(4.0, 3.0)]);
    }
}
