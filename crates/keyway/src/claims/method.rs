//! A method of a comparison: map layers, a planner, and a smoother -> a measured path.

use crate::map::{Cell, Connectivity, LayerConfig, OccupancyGrid, SearchMap};
use crate::metrics::PathMetrics;
use crate::plan::{Plan, PlanError, PlannerConfig};
use crate::route::{RouteQuery, smooth_line};
use crate::search::Workspace;
use crate::smooth::SmootherConfig;
use std::collections::BTreeSet;

/// A planner with its layers and a smoother, under the name that claims know it by.
#[derive(Debug)]
pub struct Method {
    /// Its name within the experiment.
    pub name: &'static str,
    /// The planner.
    pub planner: PlannerConfig,
    /// The smoother; `None` measures the path cell by cell.
    pub smoother: Option<SmootherConfig>,
    /// Expansion of obstacles on its map \[cells\].
    pub expansion_cells: u32,
    /// L1 constraint of its map \[reference cells\].
    pub l1_constraint: f64,
    /// Whether a map counts only when this method finds a path on it.
    pub needs_path: bool,
}

/// What a method did on one map.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Nodes taken from the open lists.
    pub expanded: u64,
    /// The path.
    pub path: PathMetrics,
    /// Cells of the planned path that it has been in before.
    pub revisited: usize,
    /// Share by which the path is longer than that of [`Experiment::YARDSTICK`](super::Experiment::YARDSTICK).
    pub excess: Option<f64>,
    /// Medians of repeated runs; `None` without a clock.
    pub times: Option<PlanTimes>,
}

/// How long the parts of a plan took \[s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanTimes {
    /// Deriving the layers from the map, with its components.
    pub layers_s: f64,
    /// The search.
    pub search_s: f64,
    /// Smoothing.
    pub smoothing_s: f64,
}

/// Seconds since any fixed instant.
pub type Clock<'a> = &'a (dyn Fn() -> f64 + 'a);

impl PlanTimes {
    /// Search and smoothing.
    pub fn planning_s(self) -> f64 {
        self.search_s + self.smoothing_s
    }

    /// All of it.
    pub fn from_map_s(self) -> f64 {
        self.layers_s + self.planning_s()
    }
}

impl Method {
    /// On the map as it is.
    pub(super) const fn new(
        name: &'static str,
        planner: PlannerConfig,
        smoother: Option<SmootherConfig>,
    ) -> Self {
        Self { name, planner, smoother, expansion_cells: 0, l1_constraint: 0.0, needs_path: true }
    }

    /// Plans once; `None` without a path. Warm memory and a second search of the same kind make times those of a map that is
    /// in use; without a clock there is but one search.
    ///
    /// # Errors
    /// When a parameter of the method cannot be used.
    pub(super) fn run(
        &self,
        grid: &OccupancyGrid,
        [start, goal]: [Cell; 2],
        workspace: &mut Workspace,
        clock: Option<Clock<'_>>,
    ) -> Result<Option<Outcome>, PlanError> {
        let now = || clock.map_or(0.0, |clock| clock());
        let layers = LayerConfig {
            expansion_cells: self.expansion_cells,
            l1_constraint: self.l1_constraint,
            ..LayerConfig::default()
        };
        let begin_s = now();
        let map = SearchMap::new(grid, layers)?;
        for connectivity in [Connectivity::Four, Connectivity::Eight] {
            map.components(connectivity);
        }
        let layers_s = now() - begin_s;
        let planner = self.planner.build(&map)?;
        let [from, to] = [start, goal].map(|cell| grid.frame().world_from_cell(cell));
        let query = RouteQuery::new(from, to);
        let mut plan = Plan::default();
        // What is not found is an outcome, not an error.
        if query.search(&map, &*planner, workspace, &mut plan, &mut ()).is_err() {
            return Ok(None);
        }
        let mut times = PlanTimes { layers_s, ..PlanTimes::default() };
        if clock.is_some() {
            let begin_s = now();
            query.search(&map, &*planner, workspace, &mut plan, &mut ())?;
            times.search_s = now() - begin_s;
        }
        let line = query.line(&map, &plan);
        let path = match &self.smoother {
            None => PathMetrics::of_polyline(line.polyline(), map.clearance()),
            Some(smoother) => {
                let smoother = smoother.build()?;
                let begin_s = now();
                let smoothed = smooth_line(&map, &*smoother, &line, 0.0, &mut ());
                times.smoothing_s = now() - begin_s;
                PathMetrics::of_path(&smoothed.path, map.clearance())
            }
        };
        let visited: BTreeSet<(i32, i32)> =
            plan.cells.iter().map(|cell| (cell.x, cell.y)).collect();
        Ok(Some(Outcome {
            expanded: plan.statistics.expanded(),
            path,
            revisited: plan.cells.len() - visited.len(),
            excess: None,
            times: clock.map(|_| times),
        }))
    }
}
