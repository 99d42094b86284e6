//! Path of one robot among random obstacles, and a check that the robot still has a path.

use keyway::ConfigError;
use keyway::geometry::{PlannedLine, Point, Polyline};
use keyway::map::{Cell, CellState, Edit, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{GlobalPlanner, Jps, LazyThetaStar, Plan};
use keyway::robot::Footprint;
use keyway::search::{Query, Workspace};
use keyway::smooth::{Smoother, Taut};

/// Tolerance for flattening the bends of a path \[m\].
const FLAT_M: f64 = 0.01;

/// A robot's path from its start via its way-points to its goal.
pub(super) struct Lane {
    /// Layers of the map with all obstacles added so far, for the robot's inscribed radius.
    map: SearchMap,
    ends: Vec<Point>,
    /// Path on the original map; empty if there is none.
    pub(super) way: Polyline,
    pub(super) inscribed_m: f64,
    /// Free distance from the ends to the edge of any obstacle \[m\].
    free_ends_m: f64,
    workspace: Workspace,
}

impl Lane {
    /// Creates the lane of a robot. `ends` are all positions that the robot has to visit, in
    /// order; `free_ends_m` is the free margin around its footprint there.
    pub(super) fn of(
        known: &OccupancyGrid,
        footprint: &Footprint,
        ends: Vec<Point>,
        free_ends_m: f64,
    ) -> Result<Self, ConfigError> {
        let inscribed_m = footprint.inscribed_radius_m();
        // The robot fits at its stops, however close they are to an obstacle.
        let layers = LayerConfig {
            clearance_m: inscribed_m,
            free_ends_m: inscribed_m,
            ..LayerConfig::default()
        };
        let mut map = SearchMap::new(known, layers).map_err(|error| error.within("robot"))?;
        let cells: Vec<Cell> = ends.iter().map(|&end| map.frame().cell_near(end)).collect();
        map.free_ends(&cells);
        let mut lane = Self {
            map,
            ends,
            way: Polyline::default(),
            inscribed_m,
            free_ends_m: free_ends_m + footprint.circumscribed_radius_m(),
            workspace: Workspace::default(),
        };
        if let Some(legs) = lane.legs(&LazyThetaStar::default()) {
            let clearance = lane.map.clearance();
            let taut = |leg| Taut.smooth(leg, &clearance, inscribed_m).path.flattened(FLAT_M);
            let points = legs.iter().flat_map(|leg| taut(leg).points().to_vec()).collect();
            lane.way = Polyline::new(points).merged();
        }
        Ok(lane)
    }

    /// True if a path exists on the original map.
    pub(super) fn has_way(&self) -> bool {
        self.way.length_m() > 0.0
    }

    /// Adds obstacles, or removes them again.
    pub(super) fn set(&mut self, cells: &[Cell], state: CellState) {
        let edits: Vec<Edit> = cells.iter().map(|&cell| Edit { cell, state }).collect();
        self.map.apply(&edits);
    }

    /// True if a path exists around all added obstacles, or if there was none on the original
    /// map.
    pub(super) fn still_has_way(&mut self) -> bool {
        !self.has_way() || self.legs(&Jps).is_some()
    }

    /// True if a disc of `radius_m` leaves the ends free at its nearest position; `apart_m`
    /// returns the distance of an end from this position.
    pub(super) fn leaves_ends(&self, radius_m: f64, apart_m: impl Fn(Point) -> f64) -> bool {
        self.ends.iter().all(|&end| apart_m(end) >= self.free_ends_m + radius_m)
    }

    /// Plans a line from each end to the next; `None` if a leg has no path.
    fn legs(&mut self, planner: &dyn GlobalPlanner) -> Option<Vec<PlannedLine>> {
        let mut plan = Plan::default();
        let mut leg = |pair: &[Point]| {
            let [from, to] = [pair[0], pair[1]].map(|end| self.map.frame().cell_from_world(end));
            let query = Query::new(from?, to?);
            planner.plan_into(&self.map, &query, &mut self.workspace, None, &mut plan).ok()?;
            Some(plan.line(&self.map, pair[0], pair[1]))
        };
        self.ends.windows(2).map(&mut leg).collect()
    }
}
