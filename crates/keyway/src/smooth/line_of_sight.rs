//! Line of sight: a line -> the same line with its needless detours cut off.
//!
//! From each kept point the result goes straight to the farthest visible later point: the straight
//! connection stays on the map and keeps the clearance from every obstacle square (exactly, see
//! [`Clearance::is_clear`]; no sampling). The next point of the line is always accepted, so the
//! line stays as it was wherever it is too close to an obstacle itself.
//!
//! # Errors / cost
//! None. From each kept point the line is searched backwards from its end. Few connections are
//! tested, because whole stretches lie in the shadow of an obstacle that was found before
//! ([`Visibility`]).

use super::parameters::SmootherParameters;
use super::required_clearance::RequiredClearance;
use super::stretches::Stretches;
use super::visibility::Visibility;
use super::{Smoothed, Smoother};
use crate::ConfigError;
use crate::geometry::{PlannedLine, Point, Polyline};
use crate::map::Clearance;
use serde::{Deserialize, Serialize};

/// Parameters of [`LineOfSight`]: none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct LineOfSightConfig {}

/// Cuts off detours between points that are visible from each other.
#[derive(Clone, Debug, Default)]
pub struct LineOfSight;

impl LineOfSight {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "line-of-sight";
}

impl SmootherParameters for LineOfSightConfig {
    fn build(&self) -> Result<Box<dyn Smoother + Send + Sync>, ConfigError> {
        Ok(Box::new(LineOfSight))
    }
}

impl Smoother for LineOfSight {
    fn smooth_distinct(
        &self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed {
        let line = line.polyline();
        let smooth = line_of_sight(line, clearance, clearance_m);
        Smoothed::straight(line, &smooth, &RequiredClearance::new(clearance, clearance_m, 0.0))
    }
}

/// The line without its detours, keeping `clearance_m` from obstacles wherever the line keeps it.
pub(super) fn line_of_sight(
    line: &Polyline,
    clearance: &Clearance<'_>,
    clearance_m: f64,
) -> Polyline {
    let points = line.points();
    let stretches = Stretches::new(points, clearance);
    let what_stops = |connection| clearance.obstruction(connection, clearance_m);
    let mut kept: Vec<Point> = points.first().copied().into_iter().collect();
    let mut visibility = Visibility::new(clearance, clearance_m);
    let mut at = 0;
    while at + 1 < points.len() {
        at = visibility.last_seen(&stretches, at, at + 2, what_stops).unwrap_or(at + 1);
        kept.push(points[at]);
    }
    Polyline::new(kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Segment;
    use crate::map::{Cell, LayerConfig, OccupancyGrid, SearchMap};
    use crate::plan::{AStar, GlobalPlanner, Plan};
    use crate::search::{Query, Workspace};
    use proptest::prelude::*;

    fn smoothed(rows: &[&str], points: &[[f64; 2]], clearance_m: f64) -> Vec<[f64; 2]> {
        let grid = OccupancyGrid::from_ascii(rows);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let line = Polyline::new(points.iter().map(|&p| p.into()).collect());
        let smooth = line_of_sight(&line, &clearance, clearance_m);
        smooth.points().iter().map(|&p| p.into()).collect()
    }

    #[test]
    fn goes_straight_where_nothing_stands() {
        let rows = ["....", "....", "...."];
        let line = [[0.5, 0.5], [1.5, 1.5], [2.5, 1.5], [3.5, 1.5]];
        assert_eq!(smoothed(&rows, &line, 0.0), [[0.5, 0.5], [3.5, 1.5]]);
        assert_eq!(smoothed(&rows, &line[..1], 0.0), [[0.5, 0.5]]);
        assert!(smoothed(&rows, &[], 0.0).is_empty());
    }

    #[test]
    fn keeps_the_turn_that_the_clearance_needs() {
        let rows = ["...", "...", "#..", "#.."];
        let line = [[1.5, 0.5], [1.5, 1.5], [1.5, 2.5], [0.5, 3.5]];
        assert_eq!(smoothed(&rows, &line, 0.0), [[1.5, 0.5], [0.5, 3.5]]);
        // The straight line passes the corner (1, 2) at 0.0; with 0.4 m it has to turn.
        assert_eq!(smoothed(&rows, &line, 0.4), [[1.5, 0.5], [1.5, 2.5], [0.5, 3.5]]);
    }

    #[test]
    fn what_was_too_close_stays() {
        let rows = ["....", "##.."];
        let line = [[0.5, 1.1], [1.5, 1.1], [2.5, 1.1]];
        assert_eq!(smoothed(&rows, &line, 0.3), line);
    }

    /// As [`line_of_sight`], with every connection tried.
    fn by_trying(line: &Polyline, clearance: &Clearance<'_>, clearance_m: f64) -> Polyline {
        let points = line.points();
        let mut kept: Vec<Point> = points.first().copied().into_iter().collect();
        let mut at = 0;
        while at + 1 < points.len() {
            let is_seen =
                |&to: &usize| clearance.is_clear(Segment::new(points[at], points[to]), clearance_m);
            at = (at + 2..points.len()).rev().find(is_seen).unwrap_or(at + 1);
            kept.push(points[at]);
        }
        Polyline::new(kept)
    }

    proptest! {
        #[test]
        fn shadows_change_nothing(occupied in prop::collection::vec(prop::bool::weighted(0.06), 40 * 30), yaw in -3.0..3.0f64,
                                  corners in prop::collection::vec((0..80i32, 0..60i32), 2..12),
                                  clearance_m in prop_oneof![Just(0.0), 0.0..0.3f64]) {
            let frame = crate::map::GridFrame::new(40, 30, 0.1, crate::geometry::Pose::new(3.0, -2.0, yaw)).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &occupied);
            let clearance = Clearance::new(grid.frame(), grid.occupied());
            // Straight stretches with intermediate points, some of them on lattice points; some
            // stretches cross obstacles.
            let mut points = Vec::new();
            for pair in corners.windows(2) {
                let ends = [pair[0], pair[1]].map(|(x, y)| Point::new(0.5 * f64::from(x), 0.5 * f64::from(y)));
                let parts = (pair[0].0 - pair[1].0).abs().max((pair[0].1 - pair[1].1).abs()).max(1);
                points.extend((0..=parts).map(|k| {
                    frame.world_from_grid(ends[0].lerp(ends[1], f64::from(k) / f64::from(parts)))
                }));
            }
            let line = Polyline::new(points);
            prop_assert_eq!(line_of_sight(&line, &clearance, clearance_m), by_trying(&line, &clearance, clearance_m));
        }

        #[test]
        fn never_longer_and_as_clear(occupied in prop::collection::vec(prop::bool::weighted(0.2), 15 * 12),
                                     ends in (0i32..15, 0i32..12, 0i32..15, 0i32..12),
                                     clearance_m in prop_oneof![Just(0.0), 0.0..1.2f64]) {
            let frame = crate::map::GridFrame::new(15, 12, 1.0, crate::geometry::Pose::default()).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &occupied);
            let map = SearchMap::new(&grid, LayerConfig { clearance_m, ..LayerConfig::default() }).unwrap();
            let (start, goal) = (Cell::new(ends.0, ends.1), Cell::new(ends.2, ends.3));
            let mut plan = Plan::default();
            let found = AStar::default().plan_into(&map, &Query::new(start, goal),
                &mut Workspace::default(), None, &mut plan);
            prop_assume!(found.is_ok());
            let ends = [start, goal].map(|cell| frame.world_from_cell(cell));
            let line = plan.line(&map, ends[0], ends[1]).into_polyline();
            let smooth = line_of_sight(&line, &map.clearance(), clearance_m);
            prop_assert_eq!(&smooth, &by_trying(&line, &map.clearance(), clearance_m));
            prop_assert!(smooth.length_m() <= line.length_m() + 1e-9);
            prop_assert_eq!(smooth.points().first(), line.points().first());
            prop_assert_eq!(smooth.points().last(), line.points().last());
            for segment in smooth.segments() {
                prop_assert!(map.clearance().is_clear(segment, clearance_m));
            }
            if let Some(nearest) = map.clearance().of_line(&smooth) {
                prop_assert!(nearest >= clearance_m - 1e-9);
            }
        }
    }
}
