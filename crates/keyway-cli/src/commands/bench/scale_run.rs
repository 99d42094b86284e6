//! One planner on one tiled map.

use crate::args::SizeArgs;
use crate::commands::{THROUGH_UNKNOWN, build_planner};
use crate::error::{CliError, Kind};
use crate::inputs::layers;
use keyway::map::{Cell, CellState, GridFrame, OccupancyGrid, SearchMap, UnknownPolicy};
use keyway::navigate::Stack;
use keyway::plan::Plan;
use keyway::search::{Query, Workspace};
use keyway_lab::measure::timed;
use keyway_sim::report::PlanOutcome;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// One row of `keyway.bench.scale/1`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ScaleRow {
    pub(super) planner: String,
    pub(super) side_cells: u32,
    pub(super) outcome: PlanOutcome,
    pub(super) start: Cell,
    pub(super) goal: Cell,
    pub(super) preparation_ms: f64,
    pub(super) wall_ms: f64,
    pub(super) cpu_ms: Option<f64>,
    pub(super) expanded: u64,
    pub(super) generated: u64,
    pub(super) cost_cells: Option<f64>,
    pub(super) map_bytes: u64,
    pub(super) workspace_bytes: u64,
    pub(super) peak_resident_bytes: Option<u64>,
}

/// Plans once from corner to corner of the map, tiled to a square with this many cells to a side.
pub(super) fn measure(
    base: &OccupancyGrid,
    stack: &Stack,
    side_cells: u32,
    size: &SizeArgs,
) -> Result<ScaleRow, CliError> {
    let grid = tiled(base, side_cells)?;
    let begin = Instant::now();
    let map = layers(&grid, stack.map.clone(), size)?;
    let planner = build_planner(&stack.planner, &map)?;
    let components = map.components(planner.connectivity());
    let preparation_ms = begin.elapsed().as_secs_f64() * 1e3;
    let largest = components.largest().ok_or_else(|| no_free_cell(&grid, &map))?;
    drop(grid);
    let last = side_cells as i32 - 1;
    // The component has a cell, and so a nearest one.
    let corner =
        |cell| map.nearest_of_component(largest, cell, planner.connectivity()).unwrap_or(cell);
    let (start, goal) = (corner(Cell::new(0, 0)), corner(Cell::new(last, last)));
    check_connected(base, start, goal, side_cells)?;
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let query = Query::new(start, goal);
    let (result, times) =
        timed(|| planner.plan_into(&map, &query, &mut workspace, None, &mut plan));
    let (outcome, statistics) = match &result {
        Ok(()) => (PlanOutcome::Found, plan.statistics),
        Err(error) => match PlanOutcome::of(error) {
            (PlanOutcome::Refused, _) => return Err(CliError::new(Kind::Config, error)),
            other => other,
        },
    };
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
        cost_cells: result.is_ok().then(|| plan.cost.cells()),
        map_bytes: (map.memory_bytes() + planner.memory_bytes()) as u64,
        workspace_bytes: workspace.memory_bytes() as u64,
        peak_resident_bytes: peak_resident_bytes(),
    })
}

/// Says why there is nowhere to plan, and what may help.
fn no_free_cell(grid: &OccupancyGrid, map: &SearchMap) -> CliError {
    let is_unknown = grid.unknown().count_ones() > 0;
    let can_open = is_unknown && map.config().unknown == UnknownPolicy::Blocked;
    let hint = if can_open { format!("; {THROUGH_UNKNOWN}") } else { String::new() };
    CliError::new(Kind::Input, format!("no cell of the map is free{hint}")).field("MAP")
}

/// Refuses a map whose largest component ends within one tile: no way would grow with the side.
fn check_connected(
    base: &OccupancyGrid,
    start: Cell,
    goal: Cell,
    side: u32,
) -> Result<(), CliError> {
    let (width, height) = (base.frame().width(), base.frame().height());
    let tile = |cell: Cell| (cell.x as u32 / width, cell.y as u32 / height);
    if tile(start) != tile(goal) || side <= width.max(height) {
        return Ok(());
    }
    let message = "the tiles of this map do not connect, as no free cell of its largest room is at \
                   its border; --unknown free may open it";
    Err(CliError::new(Kind::Input, message).field("MAP"))
}

/// A square of `side` cells: the map, and beside and above it mirror images of it, so that what
/// meets the border of a tile goes on in the next one. Cut off where it ends.
fn tiled(base: &OccupancyGrid, side: u32) -> Result<OccupancyGrid, CliError> {
    let from = base.frame();
    let frame = GridFrame::new(side.into(), side.into(), from.resolution_m(), from.origin())
        .map_err(|error| CliError::new(Kind::Usage, error).field("--sides"))?;
    let columns: Vec<i32> = (0..side).map(|x| mirrored(x, from.width())).collect();
    let rows: Vec<i32> = (0..side).map(|y| mirrored(y, from.height())).collect();
    Ok(OccupancyGrid::from_fn(frame, |cell| {
        let source = Cell::new(columns[cell.x as usize], rows[cell.y as usize]);
        base.state(source).unwrap_or(CellState::Free)
    }))
}

/// 0, 1, ..., `count` - 1, `count` - 1, ..., 1, 0, 0, 1, ...
const fn mirrored(at: u32, count: u32) -> i32 {
    let place = at % (2 * count);
    if place < count { place as i32 } else { (2 * count - 1 - place) as i32 }
}

/// The most memory that this process ever had in use at once, where the system reports it (Linux).
fn peak_resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_mirror_images() {
        let base = OccupancyGrid::from_ascii(&["?..", "..#"]);
        let tiled = tiled(&base, 7).unwrap();
        let drawn: Vec<String> = (0..7)
            .rev()
            .map(|y| {
                let state = |x| tiled.state(Cell::new(x, y)).unwrap();
                (0..7)
                    .map(|x| match state(x) {
                        CellState::Free => '.',
                        CellState::Occupied => '#',
                        CellState::Unknown => '?',
                    })
                    .collect()
            })
            .collect();
        // The map in the lower left corner, its images to the right and above.
        let (even, odd) = ("..##...", "?....??");
        assert_eq!(drawn, [odd, odd, even, even, odd, odd, even]);
    }
}
