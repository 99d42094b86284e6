//! Random obstacles that are not on the map, in growing sets.

use crate::random::Random;
use keyway::map::{Cell, CellState, Edit, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{AStar, GlobalPlanner, Plan};
use keyway::search::{Query, Workspace};
use std::error::Error;
use std::fmt::Write;

const SEED: u64 = 1;
/// Cells around the start and the goal that stay free of obstacles.
const MARGIN: i32 = 2;
/// Maximum number of draws.
const DRAWS: u32 = 100_000;

/// Returns free cells of a square map for obstacles, in the order in which they are added. After
/// each of them, a path remains that cuts no corner of its cell.
pub(crate) fn random_cells(
    grid: &OccupancyGrid,
    query: &Query,
    count: usize,
) -> Result<Vec<Cell>, Box<dyn Error>> {
    let side = grid.frame().width() as i32;
    let (mut random, mut filled, mut cells) = (Random(SEED), grid.clone(), Vec::new());
    for _ in 0..DRAWS {
        if cells.len() == count {
            return Ok(cells);
        }
        let cell = random.cell(side);
        let is_end = [query.start, query.goal].iter().any(|&end| is_near(cell, end));
        if is_end || filled.state(cell) != Some(CellState::Free) {
            continue;
        }
        let mut with_it = filled.clone();
        with_it.apply(&[Edit { cell, state: CellState::Occupied }]);
        if leaves_a_way(&with_it, query)? {
            filled = with_it;
            cells.push(cell);
        }
    }
    Err(format!("{count} obstacles leave no way").into())
}

fn is_near(cell: Cell, end: Cell) -> bool {
    (cell.x - end.x).abs() <= MARGIN && (cell.y - end.y).abs() <= MARGIN
}

fn leaves_a_way(grid: &OccupancyGrid, query: &Query) -> Result<bool, Box<dyn Error>> {
    let map = SearchMap::new(grid, LayerConfig::default())?;
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    Ok(AStar::default().plan_into(&map, query, &mut workspace, None, &mut plan).is_ok())
}

/// Returns the scene file.
pub(crate) fn scene(
    frame: &GridFrame,
    query: &Query,
    cells: &[Cell],
) -> Result<String, std::fmt::Error> {
    let figure = if cells.is_empty() { "figure 10" } else { "figures 11 and 12" };
    let [start, goal] = [query.start, query.goal].map(|cell| frame.world_from_cell(cell));
    let mut text = format!(
        "version = 1\n\
         description = \"[S1], {figure}: {} random obstacles; a reconstruction, see ../README.md\"\n\
         map = \"clutter.map\"\n\
         robot = \"paper\"\n\
         start = [{:?}, {:?}]\n\
         goal = [{:?}, {:?}]\n",
        cells.len(),
        start.x,
        start.y,
        goal.x,
        goal.y
    );
    for &cell in cells {
        let centre = frame.world_from_cell(cell);
        write!(
            text,
            "\n[[unknown]]\nposition = [{:?}, {:?}]\nradius_m = 0.5\n",
            centre.x, centre.y
        )?;
    }
    Ok(text)
}
