//! Key points \[You2021\]: a smoothed path -> the point that the local planner drives towards.
//!
//! The key points are the turning points of the smoothed path and its goal. The local planner is
//! sent to one after the other; the next one is taken when the robot has come near enough, or,
//! with [`KeyPointsConfig::skip_to_visible`], as soon as the way to it is free.
//!
//! # Source
//! \[You2021\]: section 3, steps (3) and (6), table 3.
//!
//! | paper | here | unit | table 3 |
//! |---|---|---|---|
//! | R2 | `reach_m` | m | 1.5 |
//!
//! # Where this differs from the paper
//! - `skip_to_visible` is not in the paper, whose maps have cells of 1 m: on a fine map, a key
//!   point beyond which the way is already in sight would only slow the robot down.

use crate::geometry::{Point, Polyline};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// Parameters of [`KeyPoints`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct KeyPointsConfig {
    /// R2: a key point is passed within this distance \[m\].
    pub reach_m: f64,
    /// Take the next key point as soon as the straight way to it is free.
    pub skip_to_visible: bool,
}

impl KeyPointsConfig {
    /// As published.
    pub const PAPER: Self = Self { reach_m: 1.5, skip_to_visible: false };

    /// The reach is the robot's radius (at least one cycle of driving): the footprint covers the
    /// key point.
    pub fn for_robot(robot: &Robot) -> Self {
        let reach_m = robot.radius_m.max(robot.limits.v_max_mps * robot.cycle_s);
        Self { reach_m, skip_to_visible: true }
    }
}

/// The key points of a path, and which of them is next.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyPoints {
    points: Vec<Point>,
    next: usize,
}

impl KeyPoints {
    /// The points of a smoothed path after its first one.
    pub fn of(path: &Polyline) -> Self {
        let points = match path.points() {
            [only] => vec![*only],
            points => points.get(1..).unwrap_or_default().to_vec(),
        };
        Self { points, next: 0 }
    }

    /// All key points in order; the last one is the goal.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The current guide point; `None` for an empty path.
    pub fn guide(&self) -> Option<Point> {
        self.points.get(self.next).copied()
    }

    /// Moves on to later key points as long as the current one counts as passed. `is_visible` says
    /// whether the straight way from the robot to a point is free.
    pub fn advance(
        &mut self,
        position: Point,
        config: &KeyPointsConfig,
        is_visible: impl Fn(Point) -> bool,
    ) {
        while let [current, following, ..] = self.points[self.next..] {
            let is_passed = position.distance(current) <= config.reach_m
                || (config.skip_to_visible && is_visible(following));
            if !is_passed {
                break;
            }
            self.next += 1;
        }
    }

    /// Length of the remaining way: to the guide point and on along the path \[m\].
    pub fn remaining_m(&self, position: Point) -> f64 {
        let left = self.points.get(self.next..).unwrap_or_default();
        let along: f64 = left.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        left.first().map_or(0.0, |guide| position.distance(*guide)) + along
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner() -> KeyPoints {
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]];
        KeyPoints::of(&Polyline::new(points.iter().map(|&p| p.into()).collect()))
    }

    #[test]
    fn the_next_point_is_taken_within_reach() {
        let mut keys = corner();
        keys.advance(Point::new(1.0, 0.0), &KeyPointsConfig::PAPER, |_| true);
        assert_eq!(keys.guide(), Some(Point::new(4.0, 0.0)));
        assert_eq!(keys.remaining_m(Point::new(1.0, 0.0)), 6.0);
        keys.advance(Point::new(2.5, 0.0), &KeyPointsConfig::PAPER, |_| false);
        assert_eq!(keys.guide(), Some(Point::new(4.0, 3.0)));
        keys.advance(Point::new(4.0, 3.0), &KeyPointsConfig::PAPER, |_| true);
        assert_eq!(keys.guide(), Some(Point::new(4.0, 3.0)), "the goal stays");
    }

    #[test]
    fn the_next_point_is_taken_when_seen() {
        let mut keys = corner();
        let config = KeyPointsConfig { skip_to_visible: true, ..KeyPointsConfig::PAPER };
        keys.advance(Point::new(1.0, 0.0), &config, |p| p == Point::new(4.0, 3.0));
        assert_eq!(keys.guide(), Some(Point::new(4.0, 3.0)));
    }

    #[test]
    fn degenerate_paths() {
        assert_eq!(KeyPoints::of(&Polyline::default()).guide(), None);
        let only = Point::new(1.0, 1.0);
        assert_eq!(KeyPoints::of(&Polyline::new(vec![only])).guide(), Some(only));
    }
}
