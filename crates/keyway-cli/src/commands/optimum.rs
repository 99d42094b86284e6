//! What the cheapest path costs, for comparison.

use keyway::map::{Cell, Connectivity, SearchMap};
use keyway::plan::{AStar, AStarConfig, GlobalPlanner, Plan};
use keyway::search::{CornerRule, Query, Workspace};

/// The cost \[cells\] of the cheapest path of straight and diagonal steps between the ends of a path
/// that was found, by A* under the corner rule of the planner that found it.
pub(super) fn optimum_cells(
    map: &SearchMap,
    planner: &dyn GlobalPlanner,
    path: &[Cell],
) -> Option<f64> {
    let corners = match planner.connectivity() {
        Connectivity::Four => CornerRule::Forbid,
        Connectivity::Eight => CornerRule::Allow,
    };
    let astar = AStar::new(AStarConfig { corners, ..AStarConfig::default() });
    let query = Query::new(*path.first()?, *path.last()?);
    let mut plan = Plan::default();
    astar.plan_into(map, &query, &mut Workspace::default(), None, &mut plan).ok()?;
    Some(plan.cost.cells())
}
