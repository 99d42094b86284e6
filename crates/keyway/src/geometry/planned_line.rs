//! The line of a planned path.

use super::{Point, Polyline};
use serde::{Deserialize, Serialize};

/// A line through the waypoints of a planned path, with a flag for each jump point: the points
/// that a jump point search would have on it.
///
/// The first point, the last one and every point at which the line turns must be jump points, so
/// that the line through the jump points alone is the same.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlannedLine {
    polyline: Polyline,
    /// One flag for each point of the line.
    is_jump_point: Vec<bool>,
}

impl PlannedLine {
    /// The line through all waypoints.
    pub const fn polyline(&self) -> &Polyline {
        &self.polyline
    }

    /// The line through all waypoints, without the flags.
    pub fn into_polyline(self) -> Polyline {
        self.polyline
    }

    /// The jump points in order.
    pub fn jump_points(&self) -> impl Iterator<Item = Point> + '_ {
        self.waypoints().filter(|(_, is_jump_point)| *is_jump_point).map(|(point, _)| point)
    }

    /// All waypoints in order, each with a flag for jump points.
    pub fn waypoints(&self) -> impl Iterator<Item = (Point, bool)> + '_ {
        self.polyline.points().iter().copied().zip(self.is_jump_point.iter().copied())
    }
}

/// Builds the line from waypoints in order, each with a flag for jump points.
impl FromIterator<(Point, bool)> for PlannedLine {
    fn from_iter<T: IntoIterator<Item = (Point, bool)>>(waypoints: T) -> Self {
        let (points, is_jump_point) = waypoints.into_iter().unzip();
        Self { polyline: Polyline::new(points), is_jump_point }
    }
}

/// A line that does not come from a planner: every point counts as a jump point.
impl From<Polyline> for PlannedLine {
    fn from(polyline: Polyline) -> Self {
        let is_jump_point = vec![true; polyline.points().len()];
        Self { polyline, is_jump_point }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jump_points_are_some_of_the_waypoints() {
        let points = [0.0, 1.0, 2.0].map(|x| Point::new(x, 0.0));
        let line: PlannedLine = points.into_iter().zip([true, false, true]).collect();
        assert_eq!(line.polyline().points(), points);
        assert_eq!(line.jump_points().collect::<Vec<_>>(), [points[0], points[2]]);
        let given = PlannedLine::from(line.into_polyline());
        assert_eq!(given.jump_points().collect::<Vec<_>>(), points);
    }
}
