//! Line of sight: a line -> the same line with its detours around nothing cut off.
//!
//! From each kept point the line goes straight to the farthest later point that can be seen from
//! there: the straight connection stays on the map and keeps the clearance from every obstacle
//! square (exactly, see [`Clearance::is_clear`]; no sampling). The next point of the line is always
//! accepted, so where the line itself is too close to an obstacle it stays as it was.
//!
//! # Errors / cost
//! None. At most n tests per kept point for a line of n points, each as long as the connection.

use crate::geometry::{Point, Polyline, Segment};
use crate::map::Clearance;

/// Smooths `line`, keeping `clearance_m` from obstacles wherever the line keeps it.
pub fn line_of_sight(line: &Polyline, clearance: &Clearance<'_>, clearance_m: f64) -> Polyline {
    let points = line.points();
    let mut kept: Vec<Point> = points.first().copied().into_iter().collect();
    let mut at = 0;
    while at + 1 < points.len() {
        at = farthest_visible(points, at, clearance, clearance_m);
        kept.push(points[at]);
    }
    Polyline::new(kept)
}

fn farthest_visible(
    points: &[Point],
    from: usize,
    clearance: &Clearance<'_>,
    clearance_m: f64,
) -> usize {
    (from + 2..points.len())
        .rev()
        .find(|&to| clearance.is_clear(Segment::new(points[from], points[to]), clearance_m))
        .unwrap_or(from + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
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

    proptest! {
        #[test]
        fn never_longer_and_as_clear(occupied in prop::collection::vec(prop::bool::weighted(0.2), 15 * 12),
                                     ends in (0i32..15, 0i32..12, 0i32..15, 0i32..12),
                                     clearance_m in prop_oneof![Just(0.0), 0.0..1.2f64]) {
            let mut each = occupied.iter();
            let frame = crate::map::GridFrame::new(15, 12, 1.0, crate::geometry::Pose::default()).unwrap();
            let grid = OccupancyGrid::from_fn(frame, |_| match each.next() {
                Some(true) => crate::map::CellState::Occupied,
                _ => crate::map::CellState::Free,
            });
            let map = SearchMap::new(&grid, LayerConfig { clearance_m, ..LayerConfig::default() }).unwrap();
            let (start, goal) = (Cell::new(ends.0, ends.1), Cell::new(ends.2, ends.3));
            let mut plan = Plan::default();
            let found = AStar::default().plan_into(&map, &Query::new(start, goal),
                &mut Workspace::default(), None, &mut plan);
            prop_assume!(found.is_ok());
            let line = plan.line(&map, frame.world_from_cell(start), frame.world_from_cell(goal));
            let smooth = line_of_sight(&line, &map.clearance(), clearance_m);
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
