//! Result of one planner on one tiled map.

use super::{ScaleError, ScaleRequest, ScaleTask};
use crate::measure::timed;
use keyway::map::{Cell, OccupancyGrid, SearchMap, UnknownPolicy};
use keyway::plan::{Plan, PlanError};
use keyway::search::{Query, SearchStatistics, Workspace};
use keyway_sim::report::PlanOutcome;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// One row of `keyway.bench.scale/1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScaleRow {
    /// Name of the planner.
    pub planner: String,
    /// Side of the map \[cells\].
    pub side_cells: u32,
    /// Result of the query.
    pub outcome: PlanOutcome,
    /// Start: the cell of the largest component that is nearest to the lower left corner.
    pub start: Cell,
    /// Goal: the cell of the largest component that is nearest to the upper right corner.
    pub goal: Cell,
    /// Time of deriving the map's layers and its components \[ms\].
    pub preparation_ms: f64,
    /// Wall-clock time of the query \[ms\].
    pub wall_ms: f64,
    /// CPU time of the query \[ms\]; `None` if the platform does not report it.
    pub cpu_ms: Option<f64>,
    /// Nodes taken from the open list.
    pub expanded: u64,
    /// Nodes put on the open list, or improved there.
    pub generated: u64,
    /// Cost of the path \[cells\]; `None` without a path.
    pub cost_cells: Option<f64>,
    /// Memory of the layers, the components and the planner \[bytes\].
    pub map_bytes: u64,
    /// Memory that the search reserved \[bytes\].
    pub workspace_bytes: u64,
    /// Peak resident memory of the process \[bytes\]; `None` if the platform does not report it.
    pub peak_resident_bytes: Option<u64>,
}

/// Plans once from corner to corner of a tiled map.
pub(super) fn measure(
    request: &ScaleRequest<'_>,
    grid: OccupancyGrid,
    ScaleTask { planner, side_cells }: ScaleTask,
) -> Result<ScaleRow, ScaleError> {
    let stack = &request.stacks[planner];
    let begin = Instant::now();
    let map = request.size.layers(&grid, stack.map.clone()).map_err(ScaleError::Layers)?;
    let planner = stack.planner.build(&map).map_err(ScaleError::Planner)?;
    let components = map.components(planner.connectivity());
    let preparation_ms = begin.elapsed().as_secs_f64() * 1e3;
    let largest = components.largest().ok_or_else(|| no_free_cell(&grid, &map))?;
    // The peak memory is that of the planner alone.
    drop(grid);
    let last = side_cells as i32 - 1;
    // The component has a cell, so a nearest one exists.
    let corner =
        |cell| map.nearest_of_component(largest, cell, planner.connectivity()).unwrap_or(cell);
    let (start, goal) = (corner(Cell::new(0, 0)), corner(Cell::new(last, last)));
    check_connected(request.map, [start, goal], side_cells)?;
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let query = Query::new(start, goal);
    let (result, times) =
        timed(|| planner.plan_into(&map, &query, &mut workspace, None, &mut plan));
    let is_found = result.is_ok();
    let (outcome, statistics) = outcome_of(result, &plan)?;
    Ok(ScaleRow {
        planner: planner.name().to_owned(),
        side_cells,
        outcome,
        start,
        goal,
        preparation_ms,
        wall_ms: times.wall_us() / 1e3,
        cpu_ms: times.cpu_us().map(|cpu_us| cpu_us / 1e3),
        expanded: statistics.expanded(),
        generated: statistics.generated(),
        cost_cells: is_found.then(|| plan.cost.cells()),
        map_bytes: (map.memory_bytes() + planner.memory_bytes()) as u64,
        workspace_bytes: workspace.memory_bytes() as u64,
        peak_resident_bytes: peak_resident_bytes(),
    })
}

fn outcome_of(
    result: Result<(), PlanError>,
    plan: &Plan,
) -> Result<(PlanOutcome, SearchStatistics), ScaleError> {
    let Err(error) = result else { return Ok((PlanOutcome::Found, plan.statistics)) };
    match PlanOutcome::of(&error) {
        (PlanOutcome::Refused, _) => Err(ScaleError::Refused(error)),
        other => Ok(other),
    }
}

fn no_free_cell(grid: &OccupancyGrid, map: &SearchMap) -> ScaleError {
    let is_unknown = grid.unknown().count_ones() > 0;
    let is_unknown_blocked = is_unknown && map.config().unknown == UnknownPolicy::Blocked;
    ScaleError::NoFreeCell { is_unknown_blocked }
}

/// Refuses a map whose largest component ends within one tile.
fn check_connected(base: &OccupancyGrid, ends: [Cell; 2], side: u32) -> Result<(), ScaleError> {
    let (width, height) = (base.frame().width(), base.frame().height());
    let [start, goal] = ends.map(|cell| (cell.x as u32 / width, cell.y as u32 / height));
    if start != goal || side <= width.max(height) { Ok(()) } else { Err(ScaleError::Apart) }
}

/// Returns the peak resident memory of this process so far, if the system reports it (Linux).
fn peak_resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kibibytes * 1024)
}
