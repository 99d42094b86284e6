//! The way of one robot among random obstacles, and whether it still has one.

use keyway::ConfigError;
use keyway::geometry::{PlannedLine, Point, Polyline};
use keyway::map::{Cell, CellState, Edit, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{GlobalPlanner, Jps, LazyThetaStar, Plan};
use keyway::robot::Footprint;
use keyway::search::{Query, Workspace};
use keyway::smooth::{Smoother, Taut};

/// How exactly the bends of a way are followed \[m\].
const FLAT_M: f64 = 0.01;

/// A robot's way from its start by its way-points to its goal.
pub(super) struct Lane {
    /// Around what the map shows and what was added since, for the robot's inscribed radius.
    map: SearchMap,
    ends: Vec<Point>,
    /// Around what the map shows; empty where there is none.
    pub(super) way: Polyline,
    pub(super) inscribed_m: f64,
    /// From the ends to the rim of any obstacle \[m\].
    free_ends_m: f64,
    workspace: Workspace,
}

impl Lane {
    /// `ends` are all places that the robot has to be at, in their order; `free_ends_m` is what is kept free around its footprint there.
    pub(super) fn of(
        known: &OccupancyGrid,
        footprint: &Footprint,
        ends: Vec<Point>,
        free_ends_m: f64,
    ) -> Result<Self, ConfigError> {
        let inscribed_m = footprint.inscribed_radius_m();
        // The robot stands at its ends, however near they are to something.
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

    /// Whether there is a way on the map.
    pub(super) fn has_way(&self) -> bool {
        self.way.length_m() > 0.0
    }

    /// Adds obstacles, or takes them away again.
    pub(super) fn set(&mut self, cells: &[Cell], state: CellState) {
        let edits: Vec<Edit> = cells.iter().map(|&cell| Edit { cell, state }).collect();
        self.map.apply(&edits);
    }

    /// Whether it has a way around all that was added. One that never had a way has lost none.
    pub(super) fn still_has_way(&mut self) -> bool {
        !self.has_way() || self.legs(&Jps).is_some()
    }

    /// Whether everything within `radius_m` around the nearest of places is off the ends; `apart_m` is how far an end is from it.
    pub(super) fn leaves_ends(&self, radius_m: f64, apart_m: impl Fn(Point) -> f64) -> bool {
        self.ends.iter().all(|&end| apart_m(end) >= self.free_ends_m + radius_m)
    }

    /// A line from each end to the next; `None` where there is none.
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
