//! Monitoring of a drive: the progress, and the rest of the route.

use super::{WayLeft, WayProgress};
use crate::geometry::{Point, Polyline, Segment, Square};
use crate::map::{CellState, CellWindow, Clearance, Edit, GridFrame};
use serde::{Deserialize, Serialize};

/// Time for which the robot has made no progress.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Watch {
    /// Age of the route, or time since the last recovery \[s\].
    pub(super) route_s: f64,
    /// Time for which no admissible motion was found \[s\].
    pub(super) blocked_s: f64,
    /// Time without progress along the rest of the route \[s\].
    pub(super) no_progress_s: f64,
    /// Time for which the robot has waited for a moving obstacle \[s\].
    mover_s: f64,
    progress: WayProgress,
}

impl Watch {
    pub(super) const NEW: Self = Self {
        route_s: 0.0,
        blocked_s: 0.0,
        no_progress_s: 0.0,
        mover_s: 0.0,
        progress: WayProgress::NEW,
    };

    /// Updates the times after a cycle of driving. A decrease of the remaining length by
    /// `progress_m` is progress. While the robot waits for a moving obstacle, the time does not
    /// count for up to `waits_s`, which is 0 otherwise.
    pub(super) fn note_cycle(
        &mut self,
        (left, progress_m): (WayLeft, f64),
        is_blocked: bool,
        waits_s: f64,
        cycle_s: f64,
    ) {
        self.route_s += cycle_s;
        let has_come_on = self.progress.has_progressed(left, progress_m);
        if self.mover_s < waits_s && !has_come_on {
            self.mover_s += cycle_s;
            return;
        }
        self.blocked_s = if is_blocked { self.blocked_s + cycle_s } else { 0.0 };
        if has_come_on {
            (self.no_progress_s, self.mover_s) = (0.0, 0.0);
        } else {
            self.no_progress_s += cycle_s;
        }
    }
}

/// The rest of a route.
#[derive(Clone, Copy, Debug)]
pub(super) struct RestOfRoute<'a> {
    pub(super) path: &'a Polyline,
    /// Progress of the robot along the path \[m\].
    pub(super) covered_m: f64,
}

impl RestOfRoute<'_> {
    /// Number of points of the path between the robot and its guide point that are tried in place
    /// of the latter.
    const STATIONS: u32 = 32;

    /// The segments ahead of the robot; the first one starts at its progress.
    pub(super) fn segments(&self) -> impl Iterator<Item = Segment> + Clone + '_ {
        let mut begin_m = 0.0;
        self.path.segments().filter_map(move |segment| {
            let (length_m, from_m) = (segment.length(), self.covered_m - begin_m);
            begin_m += length_m;
            let fraction = if from_m > 0.0 { from_m / length_m } else { 0.0 };
            (fraction < 1.0).then(|| Segment::new(segment.a.lerp(segment.b, fraction), segment.b))
        })
    }

    /// The segments that start less than this ahead of the robot along the path \[m\].
    pub(super) fn beginning(&self, length_m: f64) -> impl Iterator<Item = Segment> + Clone + '_ {
        self.segments().scan(0.0, move |along_m, segment| {
            let begins_m = *along_m;
            *along_m += segment.length();
            (begins_m < length_m).then_some(segment)
        })
    }

    /// True if a cell that has just become occupied is closer than `needed_m`.
    ///
    /// Costs a few operations per segment, and per cell for the segments near the bounding window
    /// of all these cells.
    pub(super) fn is_cut(&self, edits: &[Edit], frame: &GridFrame, needed_m: f64) -> bool {
        let marked = || edits.iter().filter(|edit| edit.state == CellState::Occupied);
        let windows = marked().map(|edit| CellWindow { low: edit.cell, high: edit.cell });
        let Some(window) = windows.reduce(|all, cell| all.union(&cell)) else { return false };
        let needed = needed_m / frame.resolution_m();
        let corner = |x: i32, y: i32| Point::new(f64::from(x), f64::from(y));
        let low = corner(window.low.x, window.low.y);
        let middle = low.lerp(corner(window.high.x + 1, window.high.y + 1), 0.5);
        let reach = middle.distance(low) + needed;
        self.segments().any(|segment| {
            let segment =
                Segment::new(frame.grid_from_world(segment.a), frame.grid_from_world(segment.b));
            segment.distance_sq_to_point(middle) < reach * reach
                && marked().any(|edit| {
                    let square = Square { corner: corner(edit.cell.x, edit.cell.y) };
                    segment.distance_sq_to_square(square) < needed * needed
                })
        })
    }

    /// The farthest point of the path, up to `guide_m` along it, to which the straight line from
    /// `position` keeps `clearance_m`; `None` if none of them is farther than `least_m` from
    /// there.
    pub(super) fn farthest_in_sight(
        &self,
        position: Point,
        guide_m: f64,
        [clearance_m, least_m]: [f64; 2],
        obstacles: &Clearance<'_>,
    ) -> Option<Point> {
        let step_m = (guide_m - self.covered_m).max(0.0) / f64::from(Self::STATIONS);
        (0..=Self::STATIONS).rev().find_map(|station| {
            let point = self.path.at_length(self.covered_m + f64::from(station) * step_m)?;
            let is_far = position.distance(point) > least_m;
            let way = Segment::new(position, point);
            (is_far && obstacles.is_clear(way, clearance_m)).then_some(point)
        })
    }

    /// True if another path follows the same route: ahead of the robot, no vertex of either is
    /// farther than `apart_m` from the other.
    pub(super) fn is_same_way(&self, other: &Polyline, apart_m: f64) -> bool {
        let whole = RestOfRoute { path: other, covered_m: 0.0 };
        self.is_along(&whole, apart_m) && whole.is_along(self, apart_m)
    }

    fn is_along(&self, other: &RestOfRoute<'_>, apart_m: f64) -> bool {
        let is_near = |point: Point| {
            other.segments().any(|leg| leg.distance_sq_to_point(point) <= apart_m * apart_m)
        };
        self.segments().all(|segment| is_near(segment.b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Cell, OccupancyGrid};

    fn left(way_m: f64) -> WayLeft {
        WayLeft { way_m, turn_rad: 0.0 }
    }

    fn corner() -> Polyline {
        Polyline::new([[0.5, 0.5], [6.5, 0.5], [6.5, 4.5]].iter().map(|&p| p.into()).collect())
    }

    fn edit(x: i32, y: i32, state: CellState) -> Edit {
        Edit { cell: Cell::new(x, y), state }
    }

    #[test]
    fn cells_near_the_rest_of_the_way_cut_it() {
        let (path, map) = (corner(), OccupancyGrid::from_ascii(&["........"; 6]));
        let rest = RestOfRoute { path: &path, covered_m: 3.0 };
        let is_cut = |edits: &[Edit], needed_m| rest.is_cut(edits, map.frame(), needed_m);
        let occupied = |x, y| edit(x, y, CellState::Occupied);
        // The square from x = 4 to 5 and from y = 1 to 2 is 0.5 m from the route.
        assert!(is_cut(&[occupied(4, 1)], 0.51) && !is_cut(&[occupied(4, 1)], 0.49));
        // 0.5 m from the part behind the robot, 0.707 m from the robot itself.
        assert!(!is_cut(&[occupied(2, 1)], 0.7) && is_cut(&[occupied(2, 1)], 0.72));
        assert!(!is_cut(&[edit(4, 0, CellState::Free)], 1.0) && !is_cut(&[], 1.0));
        assert!(is_cut(&[occupied(0, 5), occupied(6, 3)], 0.1), "the last leg");
    }

    #[test]
    fn what_is_in_sight_replaces_what_is_not() {
        // The wall occludes the end of the path from the robot.
        let map = OccupancyGrid::from_ascii(&[
            "........", "####....", "####....", "####....", "####....", "........",
        ]);
        let obstacles = map_clearance(&map);
        let path = corner();
        let position = Point::new(1.0, 0.6);
        let rest = RestOfRoute { path: &path, covered_m: 0.5 };
        let seen = rest.farthest_in_sight(position, 10.0, [0.2, 0.1], &obstacles).unwrap();
        assert!(seen.x == 6.5 && seen.y > 0.5 && seen.y < 2.0, "{seen:?}");
        // Only points that are closer than the minimum.
        assert_eq!(rest.farthest_in_sight(position, 0.6, [0.2, 0.3], &obstacles), None);
        assert_eq!(rest.farthest_in_sight(position, 10.0, [2.0, 0.1], &obstacles), None);
    }

    fn map_clearance(map: &OccupancyGrid) -> Clearance<'_> {
        Clearance::new(map.frame(), map.occupied())
    }

    #[test]
    fn the_same_way_from_farther_on_is_the_same() {
        let path = corner();
        let rest = RestOfRoute { path: &path, covered_m: 2.0 };
        let way = |points: &[[f64; 2]]| Polyline::new(points.iter().map(|&p| p.into()).collect());
        assert!(rest.is_same_way(&way(&[[2.5, 0.52], [6.45, 0.5], [6.5, 4.5]]), 0.1));
        assert!(!rest.is_same_way(&way(&[[2.5, 0.5], [2.5, 4.5], [6.5, 4.5]]), 0.1));
        assert!(!rest.is_same_way(&way(&[[2.5, 0.5], [5.5, 0.5], [6.5, 4.5]]), 0.1));
    }

    #[test]
    fn progress_is_a_shorter_way() {
        let mut watch = Watch::NEW;
        watch.note_cycle((left(5.0), 0.05), false, 0.0, 0.1);
        watch.note_cycle((left(4.96), 0.05), true, 0.0, 0.1);
        assert!(watch.no_progress_s > 0.0 && watch.blocked_s > 0.0);
        watch.note_cycle((left(4.9), 0.05), false, 0.0, 0.1);
        assert_eq!((watch.no_progress_s, watch.blocked_s), (0.0, 0.0));
        assert!((watch.route_s - 0.3).abs() < 1e-12);
    }

    #[test]
    fn waiting_for_a_mover_counts_only_when_it_takes_long() {
        let mut watch = Watch::NEW;
        watch.note_cycle((left(5.0), 0.05), false, 0.5, 0.1);
        (0..5).for_each(|_| watch.note_cycle((left(5.0), 0.05), true, 0.5, 0.1));
        assert_eq!((watch.blocked_s, watch.no_progress_s), (0.0, 0.0));
        watch.note_cycle((left(5.0), 0.05), true, 0.5, 0.1);
        assert_eq!((watch.blocked_s, watch.no_progress_s), (0.1, 0.1));
        watch.note_cycle((left(4.9), 0.05), false, 0.5, 0.1);
        watch.note_cycle((left(4.9), 0.05), true, 0.5, 0.1);
        assert_eq!(watch.blocked_s, 0.0, "it has come on in between");
    }
}
