//! A path of more than half a million steps whose cost has a closed form.

use crate::planners::{ask, optimal};
use keyway::geometry::Pose;
use keyway::map::{Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::search::{CornerRule, Cost, Query, Workspace};

/// Columns and rows.
const SIZE: i32 = 1500;

/// Every planner gives the cost, from either end.
fn expect(is_free: impl Fn(Cell) -> bool, ends: (Cell, Cell), expected: Cost) {
    let frame = GridFrame::new(SIZE as u64, SIZE as u64, 1.0, Pose::default()).unwrap();
    let state = |cell| if is_free(cell) { CellState::Free } else { CellState::Occupied };
    let grid = OccupancyGrid::from_fn(frame, state);
    let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
    for planner in optimal(CornerRule::Forbid) {
        let mut workspace = Workspace::default();
        for query in [Query::new(ends.0, ends.1), Query::new(ends.1, ends.0)] {
            let plan = ask(&planner, &map, &query, &mut workspace).unwrap().unwrap();
            assert_eq!(plan.cost.steps(), Some(expected), "{planner:?}");
            assert_eq!(plan.cells.len() as u64, 1 + expected.straight + expected.diagonal);
        }
    }
}

/// Corridors one cell wide on the even rows, walls one cell thick on the odd ones, with an opening
/// at the right and at the left end in turn.
///
/// Each of the 750 corridors has 1499 steps; 749 openings connect them, two steps each.
#[test]
fn straight_corridors() {
    let is_free = |cell: Cell| {
        let opening = if cell.y % 4 == 1 { SIZE - 1 } else { 0 };
        cell.y % 2 == 0 || (cell.x == opening && cell.y < SIZE - 1)
    };
    let corridors = SIZE as u64 / 2;
    let straight = corridors * (SIZE as u64 - 1) + (corridors - 1) * 2;
    assert!(straight > 1_000_000);
    // The last of an even number of corridors ends on the left.
    let ends = (Cell::new(0, 0), Cell::new(0, SIZE - 2));
    expect(is_free, ends, Cost::new(straight, 0));
}

/// Corridors that change between two rows every third column, over blocks of 2 x 2 free cells: each
/// change is one diagonal step. A corridor has three rows, the third of which is a wall with an
/// opening at the corridor's end.
///
/// In the columns 3k and 3k + 1 both rows are free (there the corridor changes rows), in 3k + 2
/// only the one in which it continues: the upper one for even k, the lower one for odd k. A
/// corridor is entered in its lower row and reaches its last block in the upper one, from which an
/// opening leads to the next corridor. So each of its 1499 changes of the column is straight
/// except for one in every block before the last. Only the last corridor ends in its lower row, at
/// the goal.
#[test]
fn corridors_with_diagonal_steps() {
    let corridors = SIZE / 3;
    let is_free = |cell: Cell| {
        let (corridor, row) = (cell.y / 3, cell.y % 3);
        let (block, column) = (cell.x / 3, cell.x % 3);
        let end = if corridor % 2 == 0 { SIZE - 1 } else { 0 };
        let is_opening = cell.x == end && corridor + 1 < corridors;
        match row {
            0 => column < 2 || block % 2 == 1,
            1 => column < 2 || block % 2 == 0 || is_opening,
            _ => is_opening,
        }
    };
    let (corridors, blocks, columns) = (corridors as u64, SIZE as u64 / 3, SIZE as u64);
    let turns = corridors - 1;
    let diagonal = turns * (blocks - 1) + blocks;
    let straight = corridors * (columns - 1) - diagonal + turns * 2;
    assert!(straight + diagonal > 500_000 && diagonal > 200_000);
    // The last of an even number of corridors ends on the left.
    let ends = (Cell::new(0, 0), Cell::new(0, SIZE - 3));
    expect(is_free, ends, Cost::new(straight, diagonal));
}
