//! Routes through passages whose centreline lies between the centres of cells.
//!
//! A grid path leads from centre to centre, so a disc that fits through a passage only along its
//! centreline has a grid path only if that centreline is a row of centres. But the cells that any
//! path of the disc passes have centres at most half a diagonal away from it. On a map whose
//! clearance is smaller by that much, a path therefore exists. Its points are moved until they
//! keep the full clearance (`room.rs`). If that is impossible, the gap is closed for the next
//! attempt.
//!
//! # Cost
//! One search per attempt. Each attempt closes all gaps on its path that are too narrow. If not
//! even the map of smaller clearance connects start and goal, the cost is a component look-up.

mod pinch;
mod room;

use super::{Route, RouteQuery, StageObserver, smooth_line};
use crate::geometry::{Path, PlannedLine, Point, Polyline};
use crate::map::{Cell, Clearance, GridFrame, SearchMap};
use crate::plan::{GlobalPlanner, Plan};
use crate::search::{IfUnreachable, Workspace};
use crate::smooth::{Smoothed, Smoother, Unsmoothed};
use pinch::Pinch;
use room::{CHORD_CELLS, Room};
use std::f64::consts::FRAC_1_SQRT_2;

/// Bisection steps in the search for the largest clearance that the path can keep.
const HALVINGS: u32 = 4;

/// Largest distance of a point of a cell from the cell's centre \[cells\].
const HALF_DIAGONAL: f64 = FRAC_1_SQRT_2;

/// Clearance of a map on which cells are connected wherever a disc of `clearance_m` can pass
/// \[m\].
pub fn looser_clearance_m(frame: &GridFrame, clearance_m: f64) -> f64 {
    (clearance_m - HALF_DIAGONAL * frame.resolution_m()).max(0.0)
}

/// The route requested of [`plan_between_cells`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetweenCells {
    /// Distance to obstacles and to the map's border \[m\].
    pub clearance_m: f64,
    /// Maximum number of attempts, each of which costs a search.
    pub attempts: u32,
}

/// Plans a route that keeps a clearance and need not follow cell centres; `None` if none was
/// found. In open space the route keeps more, up to half the diagonal of a cell. Near its start
/// and goal it may be as close to obstacles as [`EndRule`](super::EndRule) allows.
///
/// `looser` has a clearance of [`looser_clearance_m`]. Some of its cells are blocked in the
/// meantime and freed again at the end. A budget covers all attempts together. Intended for
/// queries for which [`plan_route`](super::plan_route) has found no path: the route is not the
/// shortest one.
pub fn plan_between_cells(
    looser: &mut SearchMap,
    wanted: BetweenCells,
    planner: &dyn GlobalPlanner,
    smoother: &dyn Smoother,
    query: &RouteQuery,
    workspace: &mut Workspace,
    stages: &mut dyn StageObserver,
) -> Option<Route> {
    let mut query = RouteQuery { if_unreachable: IfUnreachable::Fail, ..*query };
    let mut closed = Vec::new();
    let mut way = None;
    for _ in 0..wanted.attempts {
        let mut plan = Plan::default();
        if query.search(looser, planner, workspace, &mut plan, stages).is_err() {
            break;
        }
        let expanded = plan.statistics.expanded();
        query.budget = query.budget.map(|budget| budget.saturating_sub(expanded));
        match Way::along(looser.clearance(), &query, &plan.cells, wanted.clearance_m) {
            Ok(found) => {
                way = Some((found, plan));
                break;
            }
            Err(pinches) => {
                let cells = cells_to_close(&pinches, looser);
                if cells.is_empty() {
                    break;
                }
                looser.close(&cells);
                closed.extend(cells);
            }
        }
    }
    looser.open(&closed);
    let (way, plan) = way?;
    way.route(looser, plan, smoother, stages)
}

fn cells_to_close(pinches: &[Pinch], map: &SearchMap) -> Vec<Cell> {
    let mut cells: Vec<Cell> = pinches.iter().flat_map(Pinch::cells).collect();
    cells.retain(|&cell| map.is_free(cell));
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// A path that keeps a clearance.
struct Way {
    points: Vec<Point>,
    /// Clearance kept \[m\], except near start and goal.
    kept_m: f64,
    /// Clearance that the whole path must keep \[m\], near start and goal too.
    needed_m: f64,
}

impl Way {
    /// The path near a path of cells that keeps the largest clearance found, at least
    /// `clearance_m`; the gaps that are too narrow if none exists.
    fn along(
        clearance: Clearance<'_>,
        query: &RouteQuery,
        cells: &[Cell],
        clearance_m: f64,
    ) -> Result<Self, Vec<Pinch>> {
        let resolution_m = clearance.frame().resolution_m();
        let ends = [query.start, query.goal]
            .map(|end| (end, query.ends.room_m(clearance, end, clearance_m)));
        let line = |kept_m: f64| Room::new(clearance, kept_m).line(cells, ends);
        let (mut low_m, mut high_m) =
            (clearance_m + CHORD_CELLS * resolution_m, clearance_m + HALF_DIAGONAL * resolution_m);
        let mut points = line(low_m)?;
        for _ in 0..HALVINGS {
            let kept_m = 0.5 * (low_m + high_m);
            match line(kept_m) {
                Ok(wider) => (low_m, points) = (kept_m, wider),
                Err(_) => high_m = kept_m,
            }
        }
        let needed_m = ends.iter().fold(clearance_m, |least_m, end| least_m.min(end.1));
        Ok(Self { points, kept_m: low_m, needed_m })
    }

    /// The smoothed route, or the unsmoothed path if the smoothed one violates the required
    /// clearance.
    fn route(
        self,
        map: &SearchMap,
        plan: Plan,
        smoother: &dyn Smoother,
        stages: &mut dyn StageObserver,
    ) -> Option<Route> {
        let line = PlannedLine::from(Polyline::new(self.points).merged());
        let chord_m = CHORD_CELLS * map.frame().resolution_m();
        let route_of = |smoothing: Smoothed| {
            let smoothed = smoothing.path.flattened(chord_m);
            let is_clear = map.clearance().is_clear_path(&Path::from(&smoothed), self.needed_m);
            is_clear.then_some((smoothing, smoothed))
        };
        let smoothing = smooth_line(map, smoother, &line, self.kept_m, stages);
        let (smoothing, smoothed) = route_of(smoothing)
            .or_else(|| route_of(Unsmoothed.smooth(&line, &map.clearance(), self.kept_m)))?;
        Some(Route { plan, line, smoothing, smoothed, clearance_m: self.kept_m })
    }
}
