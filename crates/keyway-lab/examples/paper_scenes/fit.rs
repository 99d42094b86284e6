//! The first seeded map on which planners have the published lengths.

use crate::clutter::Clutter;
use crate::random::Random;
use keyway::map::{LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{AStar, GlobalPlanner, Plan};
use keyway::search::{Cost, Query, Workspace};
use std::error::Error;

/// Maximum number of maps that are tried.
const MAPS: u64 = 1_000_000;

/// A planner of a paper's comparison, its query, and the published cost of its path.
pub(crate) struct Baseline {
    planner: Box<dyn GlobalPlanner>,
    query: Query,
    /// Published cost; `None` if a path of any length is enough.
    cost: Option<Cost>,
}

impl Baseline {
    pub(crate) fn new(planner: impl GlobalPlanner + 'static, query: Query, cost: Cost) -> Self {
        Self { planner: Box::new(planner), query, cost: Some(cost) }
    }

    /// Requires a path that cuts no corner.
    pub(crate) fn any_length(query: Query) -> Self {
        Self { planner: Box::new(AStar::default()), query, cost: None }
    }

    fn holds(&self, map: &SearchMap, workspace: &mut Workspace, plan: &mut Plan) -> bool {
        let found = self.planner.plan_into(map, &self.query, workspace, None, plan);
        found.is_ok() && (self.cost.is_none() || plan.cost.steps() == self.cost)
    }
}

/// Returns the first map, by its seed from 1, on which all baselines hold.
pub(crate) fn first_fit(
    clutter: Clutter,
    baselines: &[Baseline],
) -> Result<(u64, OccupancyGrid), Box<dyn Error>> {
    let ends = baselines.iter().flat_map(|baseline| [baseline.query.start, baseline.query.goal]);
    let ends: Vec<_> = ends.collect();
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    for seed in 1..=MAPS {
        let grid = clutter.map(&mut Random(seed), &ends)?;
        let map = SearchMap::new(&grid, LayerConfig::default())?;
        if baselines.iter().all(|baseline| baseline.holds(&map, &mut workspace, &mut plan)) {
            return Ok((seed, grid));
        }
    }
    Err(format!("none of {MAPS} maps has the published lengths").into())
}
