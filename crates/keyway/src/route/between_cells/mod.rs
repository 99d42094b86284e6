//! Routes through passages whose middle lies between the centres of cells.
//!
//! A path on a grid leads from centre to centre, so a disc that fits through a passage only along
//! its middle has a path only where that middle is a row of centres. But whatever way the disc
//! takes, the cells that it passes have centres no farther than half a diagonal away: on a map that
//! keeps so much less, there is a path. Its points are moved to where there is room (`room.rs`),
//! and where there is none, the gap is closed for the next attempt.
//!
//! # Cost
//! A search for each attempt, each of which closes all gaps on its path that are too narrow; where
//! not even the map that keeps less joins the ends, a look at its components.

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

/// Halvings of the range of the room that a way may have.
const HALVINGS: u32 = 4;

/// A cell's centre is no farther than this from any point of the cell \[cells\].
const HALF_DIAGONAL: f64 = FRAC_1_SQRT_2;

/// The clearance \[m\] of a map on which cells are joined wherever a disc of `clearance_m` can go.
pub fn looser_clearance_m(frame: &GridFrame, clearance_m: f64) -> f64 {
    (clearance_m - HALF_DIAGONAL * frame.resolution_m()).max(0.0)
}

/// The route that is wanted of [`plan_between_cells`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetweenCells {
    /// Distance that it keeps from obstacles and from the map's border \[m\].
    pub clearance_m: f64,
    /// Number of paths that are tried, each of which costs a search.
    pub attempts: u32,
}

/// Plans a route that keeps a clearance, wherever between the cells' centres it has to be for
/// that; `None` where none was found. Where there is room, it keeps more, up to half the diagonal
/// of a cell. Near its ends it may come as near to obstacles as [`EndRule`](super::EndRule) allows.
///
/// `looser` has a clearance of [`looser_clearance_m`]; some of its cells are blocked in between,
/// and free again at the end. A budget is for all attempts together. Meant for what
/// [`plan_route`](super::plan_route) has found no path for: the route is not the shortest one.
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

/// A way with room.
struct Way {
    points: Vec<Point>,
    /// Room that it keeps \[m\], but for its ends.
    kept_m: f64,
    /// Room that all of it has to keep \[m\], its ends too.
    needed_m: f64,
}

impl Way {
    /// The way near a path of cells that keeps as much as it can, at least `clearance_m`; the gaps
    /// that are too narrow, if there is none.
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

    /// The smoothed route, or the way itself where the smoothed one keeps less than it must.
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
