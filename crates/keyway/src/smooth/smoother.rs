//! The smoother interface: a line -> a path that keeps a clearance.

use super::Smoothed;
use crate::geometry::PlannedLine;
use crate::map::Clearance;
use std::fmt::Debug;

/// Smooths lines. A smoother is an immutable configuration that was validated on construction.
///
/// ```
/// use keyway::geometry::{Path, PlannedLine, Point, Polyline};
/// use keyway::map::{Clearance, OccupancyGrid};
/// use keyway::smooth::{Smoothed, Smoother};
///
/// /// Straight on to the goal, whatever is in the way.
/// #[derive(Debug)]
/// struct BeeLine;
///
/// impl Smoother for BeeLine {
///     fn smooth_distinct(&self, line: &PlannedLine, _: &Clearance<'_>, _: f64) -> Smoothed {
///         let points = line.polyline().points();
///         let ends = points.first().into_iter().chain(points.last()).copied();
///         let path = Path::from(&Polyline::new(ends.collect()));
///         Smoothed { path, ..Smoothed::default() }
///     }
/// }
///
/// let map = OccupancyGrid::from_ascii(&["....", "....", "...."]);
/// let clearance = Clearance::new(map.frame(), map.occupied());
/// let points = [[0.5, 0.5], [0.5, 2.5], [0.5, 2.5], [3.5, 2.5]].map(Point::from);
/// let line = Polyline::new(points.to_vec());
/// let done = BeeLine.smooth(&line.into(), &clearance, 0.2);
/// assert_eq!(done.path.length_m(), 13f64.sqrt());
/// ```
pub trait Smoother: Debug {
    /// The smoothing itself, called by [`Self::smooth`]. The points of the line are finite,
    /// successive points differ, both ends are jump points, and `clearance_m` is a number of at
    /// least 0.
    fn smooth_distinct(
        &self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed;

    /// Smooths the line of a plan, or any other line (`PlannedLine::from(polyline)`). Non-finite
    /// and repeated points are dropped. The result has the same start and goal as the line and is
    /// never longer.
    ///
    /// It keeps `clearance_m`, or the smoother's own safe distance if that is larger (with
    /// [`BendsKeep::Clearance`](super::BendsKeep::Clearance), only straight stretches keep the
    /// safe distance), wherever the line did. Otherwise [`Smoothed::kept_clearance_m`] reports the
    /// distance that is kept. A negative clearance counts as 0.
    fn smooth(&self, line: &PlannedLine, clearance: &Clearance<'_>, clearance_m: f64) -> Smoothed {
        self.smooth_distinct(&distinct(line), clearance, clearance_m.max(0.0))
    }
}

/// The line without non-finite and repeated points; its ends are jump points.
fn distinct(line: &PlannedLine) -> PlannedLine {
    let mut waypoints: Vec<_> = line.waypoints().filter(|(point, _)| point.is_finite()).collect();
    waypoints.dedup_by(|(point, is_jump_point), (kept, keeps)| {
        *keeps |= point == kept && *is_jump_point;
        point == kept
    });
    for end in [0, waypoints.len().saturating_sub(1)] {
        if let Some((_, is_jump_point)) = waypoints.get_mut(end) {
            *is_jump_point = true;
        }
    }
    waypoints.into_iter().collect()
}
