//! Paths of a planner and a smoother on map layers, with their metrics.

use super::shown::Shown;
use super::unknown;
use keyway::ConfigError;
use keyway::map::{
    Cell, Connectivity, LayerConfig, OccupancyGrid, PublishedConstraints, SearchMap,
};
use keyway::navigate::NavigateError;
use keyway::plan::{Plan, PlannerConfig};
use keyway::route::{RouteQuery, smooth_line};
use keyway::search::{Recording, Workspace};
use keyway::smooth::SmootherConfig;
use keyway_sim::episode::{EpisodeError, RandomObstacles};
use keyway_sim::metrics::PathMetrics;
use keyway_sim::metrics::statistics::Sample;
use keyway_sim::report::{Clock, timed};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Maximum distance between a curve and its chords \[cells\].
const CHORD_CELLS: f64 = 0.05;

/// Setup of a plan.
#[derive(Debug)]
pub struct Planning {
    /// The planner.
    pub planner: PlannerConfig,
    /// The smoother; `None` measures the path cell by cell.
    pub smoother: Option<SmootherConfig>,
    /// Expansion of obstacles on the planner's map \[cells\].
    pub expansion_cells: u32,
    /// L1 constraint of the planner's map \[reference cells\].
    pub l1_constraint: f64,
    /// Real obstacles that are not on the map; the planner does not know them.
    pub unknown: Option<RandomObstacles>,
}

/// A path on one map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Planned {
    /// Nodes taken from the open lists.
    pub expanded: u64,
    /// The path.
    pub path: PathMetrics,
    /// Cells of the planned path that were visited before.
    pub revisited: usize,
    /// Smallest distance from the path to static unknown obstacles \[m\], 0 if it goes through
    /// one; `None` without obstacles.
    pub unknown_clearance_m: Option<f64>,
    /// Relative excess of the path's length over that of
    /// [`Experiment::YARDSTICK`](super::Experiment::YARDSTICK); `None` without the yardstick.
    pub excess: Option<f64>,
    /// Medians of repeated runs; `None` without a clock.
    pub times: Option<PlanTimes>,
}

/// Times of the parts of a plan \[s\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlanTimes {
    /// Deriving the layers from the map, with its components.
    pub layers_s: f64,
    /// The search.
    pub search_s: f64,
    /// Smoothing.
    pub smoothing_s: f64,
}

impl PlanTimes {
    /// Time of search and smoothing.
    pub fn planning_s(self) -> f64 {
        self.search_s + self.smoothing_s
    }

    /// Total time.
    pub fn from_map_s(self) -> f64 {
        self.layers_s + self.planning_s()
    }

    /// Returns the median of each part; `None` without times.
    pub(super) fn medians(times: &[Self]) -> Option<Self> {
        let median = |of: fn(&Self) -> f64| {
            Some(Sample::new(times.iter().map(of).collect()).ok()?.quantile(0.5))
        };
        Some(Self {
            layers_s: median(|times| times.layers_s)?,
            search_s: median(|times| times.search_s)?,
            smoothing_s: median(|times| times.smoothing_s)?,
        })
    }
}

impl Planning {
    /// Plans on the map as it is.
    pub(super) const fn new(planner: PlannerConfig, smoother: Option<SmootherConfig>) -> Self {
        Self { planner, smoother, expansion_cells: 0, l1_constraint: 0.0, unknown: None }
    }

    /// Plans once; `None` without a path. With a clock, a second search on a warmed-up map is
    /// timed. `seed` determines the unknown obstacles.
    ///
    /// # Errors
    /// Returns [`EpisodeError`] if a parameter is invalid.
    pub(super) fn run(
        &self,
        grid: &OccupancyGrid,
        (ends, seed): ([Cell; 2], u64),
        workspace: &mut Workspace,
        clock: Clock<'_>,
    ) -> Result<Option<Planned>, EpisodeError> {
        let (map, layers_s) = timed(clock, || self.layers(grid));
        let map = map?;
        let planner = self.planner.build(&map).map_err(NavigateError::from)?;
        let smoother = self.smoother.as_ref().map(SmootherConfig::build).transpose()?;
        let [from, to] = ends.map(|cell| grid.frame().world_from_cell(cell));
        let query = RouteQuery::new(from, to);
        let mut plan = Plan::default();
        let mut search = || query.search(&map, &*planner, workspace, &mut plan, &mut ());
        // A search without a path is an outcome, not an error.
        if search().is_err() {
            return Ok(None);
        }
        let search_s = if clock.is_some() { timed(clock, search).1 } else { None };
        let line = query.line(&map, &plan);
        let (path, way, smoothing_s) = match smoother {
            None => {
                let path = PathMetrics::of_polyline(line.polyline(), map.clearance());
                (path, line.polyline().clone(), None)
            }
            Some(smoother) => {
                let smooth = || smooth_line(&map, &*smoother, &line, 0.0, &mut ());
                let (smoothed, smoothing_s) = timed(clock, smooth);
                let path = PathMetrics::of_path(&smoothed.path, map.clearance());
                (path, smoothed.path.flattened(chord_m(grid)), smoothing_s)
            }
        };
        let unknown = unknown::standing(self.unknown.as_ref(), grid, (ends, seed))?;
        let times = layers_s.zip(search_s).map(|(layers_s, search_s)| PlanTimes {
            layers_s,
            search_s,
            smoothing_s: smoothing_s.unwrap_or_default(),
        });
        let visited: BTreeSet<(i32, i32)> =
            plan.cells.iter().map(|cell| (cell.x, cell.y)).collect();
        Ok(Some(Planned {
            expanded: plan.statistics.expanded(),
            path,
            revisited: plan.cells.len() - visited.len(),
            unknown_clearance_m: unknown::clearance_m(&way, &unknown),
            excess: None,
            times,
        }))
    }

    /// Returns the content of a picture of a plan; `None` without a path.
    ///
    /// # Errors
    /// As for [`Self::run`].
    pub(super) fn shown(
        &self,
        grid: &OccupancyGrid,
        (ends, seed): ([Cell; 2], u64),
    ) -> Result<Option<Shown>, EpisodeError> {
        let map = self.layers(grid)?;
        let planner = self.planner.build(&map).map_err(NavigateError::from)?;
        let [from, to] = ends.map(|cell| grid.frame().world_from_cell(cell));
        let query = RouteQuery::new(from, to);
        let Ok(on_cells) = query.on_cells(&map) else { return Ok(None) };
        let (mut workspace, mut search) = (Workspace::default(), Recording::default());
        let mut plan = Plan::default();
        let found =
            planner.plan_into(&map, &on_cells, &mut workspace, Some(&mut search), &mut plan);
        if found.is_err() {
            return Ok(None);
        }
        let planned = query.line(&map, &plan);
        let line = match &self.smoother {
            None => planned.polyline().clone(),
            Some(smoother) => {
                let smoothed = smooth_line(&map, &*smoother.build()?, &planned, 0.0, &mut ());
                smoothed.path.flattened(chord_m(grid))
            }
        };
        let obstacles = unknown::standing(self.unknown.as_ref(), grid, (ends, seed))?;
        let movers = Vec::new();
        Ok(Some(Shown { line, search: Some(search), run: None, part: None, obstacles, movers }))
    }

    fn layers(&self, grid: &OccupancyGrid) -> Result<SearchMap, ConfigError> {
        let layers = LayerConfig {
            published: PublishedConstraints {
                expansion_cells: self.expansion_cells,
                l1_constraint: self.l1_constraint,
                ..PublishedConstraints::NONE
            },
            ..LayerConfig::default()
        };
        let map = SearchMap::new(grid, layers)?;
        for connectivity in [Connectivity::Four, Connectivity::Eight] {
            map.components(connectivity);
        }
        Ok(map)
    }
}

/// Maximum distance between a curve and its chords \[m\].
fn chord_m(grid: &OccupancyGrid) -> f64 {
    CHORD_CELLS * grid.frame().resolution_m()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::planners::JPS;
    use crate::claims::{Measure, MethodResult};
    use keyway::plan::BidirectionalJpsConfig;
    use keyway_sim::episode::RandomUnknown;

    /// Smallest known path of the paper's search that doubles back: (2, 0), (1, 0), (0, 0), (1, 0),
    /// (2, 0).
    #[test]
    fn cells_that_are_visited_again() {
        let rows = ["S....", "#....", ".....", ".....", "....#", ".#...", "....G"];
        let rows = rows.map(|row| row.replace(['S', 'G'], "."));
        let grid = OccupancyGrid::from_ascii(&rows.each_ref().map(String::as_str));
        let revisited = |planner| {
            let planning = Planning::new(planner, None);
            let ends = [Cell::new(0, 6), Cell::new(4, 0)];
            let found = planning.run(&grid, (ends, 1), &mut Workspace::default(), None).unwrap();
            found.unwrap().revisited
        };
        let moving = PlannerConfig::BidirectionalJps(BidirectionalJpsConfig::PAPER);
        assert_eq!((revisited(moving), revisited(JPS)), (2, 0));
    }

    /// The disc of the seed is on the path, which is a straight line.
    #[test]
    fn what_stands_on_the_path() {
        let grid = OccupancyGrid::from_ascii(&["...................."; 9]);
        let unknown = RandomObstacles {
            unknown: Some(RandomUnknown { count: 1, radius_m: [0.1; 2] }),
            near_way_m: 0.0,
            moving: None,
            free_ends_m: 0.5,
        };
        let run = |unknown| {
            let planning = Planning { unknown, ..Planning::new(JPS, None) };
            let ends = [Cell::new(0, 4), Cell::new(19, 4)];
            let found = planning.run(&grid, (ends, 1), &mut Workspace::default(), None).unwrap();
            let found = found.unwrap();
            let way_clearance = Measure::WayClearance;
            [found.unknown_clearance_m, way_clearance.of(Some(&MethodResult::Planned(found)))]
        };
        assert_eq!((run(Some(unknown)), run(None)), ([Some(0.0); 2], [None; 2]));
    }

    #[test]
    fn the_median_counts() {
        let of = |s: f64| PlanTimes { layers_s: s, search_s: 2.0 * s, smoothing_s: 3.0 * s };
        assert_eq!(PlanTimes::medians(&[of(9.0), of(1.0), of(2.0)]), Some(of(2.0)));
        assert_eq!((of(2.0).planning_s(), of(2.0).from_map_s()), (10.0, 12.0));
        assert_eq!(PlanTimes::medians(&[]), None);
    }
}
