//! Report of a smoothed path.

use crate::metrics::PathMetrics;
use keyway::geometry::Polyline;
use keyway::map::SearchMap;
use keyway::route::Route;
use keyway::smooth::SharpCorner;
use serde::Serialize;

/// A smoothed path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SmoothedPart {
    /// Length \[m\].
    pub length_m: f64,
    /// Interior points at which the heading changes. On a curve, each section that bends to one
    /// side counts once.
    pub turns: usize,
    /// Sum of the absolute heading changes \[deg\].
    pub turning_angle_deg: f64,
    /// Points at which the heading jumps (see [`PathMetrics::non_smooth_turns`]).
    pub non_smooth_turns: usize,
    /// Smallest distance to an obstacle's square \[m\]; for curves, a certified lower bound.
    pub min_clearance_m: Option<f64>,
    /// Certified clearance if it is less than the requested one \[m\].
    pub kept_clearance_m: Option<f64>,
    /// Points of the planned line that the path skips.
    pub removed_points: usize,
    /// Corners and control points of the path that are not points of the line.
    pub inserted_points: usize,
    /// Corners that should have been rounded but were not.
    pub sharp_corners: Vec<SharpCorner>,
    /// Corners, and points along the curves \[m\].
    pub waypoints_m: Polyline,
    /// Wall-clock time of smoothing, if measured \[s\].
    pub time_s: Option<f64>,
}

impl SmoothedPart {
    /// Describes the smoothed path of a route on a map; `time_s` is the smoothing time, if
    /// measured.
    pub fn of(route: &Route, map: &SearchMap, time_s: Option<f64>) -> Self {
        let done = &route.smoothing;
        let metrics = PathMetrics::of_path(&done.path, map.clearance());
        Self {
            length_m: metrics.length_m,
            turns: metrics.turns,
            turning_angle_deg: metrics.turning_angle_deg,
            non_smooth_turns: metrics.non_smooth_turns,
            min_clearance_m: metrics.min_clearance_m,
            kept_clearance_m: done.kept_clearance_m,
            removed_points: done.removed_points,
            inserted_points: done.inserted_points,
            sharp_corners: done.sharp_corners.clone(),
            waypoints_m: route.smoothed.clone(),
            time_s,
        }
    }
}
