//! Random maps as the papers draw them: black blocks of a few cells, scattered over a square.

use crate::random::Random;
use keyway::geometry::Pose;
use keyway::map::{Cell, CellState, FrameError, GridFrame, OccupancyGrid};

/// Maximum number of cells along each side of a block.
const LARGEST_BLOCK: i32 = 3;

/// Blocks of 1 x 1 to 3 x 3 cells, added until they cover a share of the map.
#[derive(Clone, Copy)]
pub(crate) struct Clutter {
    /// Cells along each side of the map, of 1 m.
    pub(crate) side: i32,
    /// Minimum covered share.
    pub(crate) percent: i32,
}

impl Clutter {
    /// Generates a map in which the cells of `free` are free.
    pub(crate) fn map(
        self,
        random: &mut Random,
        free: &[Cell],
    ) -> Result<OccupancyGrid, FrameError> {
        let mut is_covered = vec![false; (self.side * self.side) as usize];
        let index = |cell: Cell| (cell.y * self.side + cell.x) as usize;
        let mut covered = 0;
        while 100 * covered < self.percent * self.side * self.side {
            let corner = random.cell(self.side);
            let (width, height) =
                (1 + random.below(LARGEST_BLOCK), 1 + random.below(LARGEST_BLOCK));
            let rows = (corner.y..corner.y + height).filter(|&y| y < self.side);
            let columns = || (corner.x..corner.x + width).filter(|&x| x < self.side);
            for cell in rows.flat_map(|y| columns().map(move |x| Cell::new(x, y))) {
                if !is_covered[index(cell)] && !free.contains(&cell) {
                    is_covered[index(cell)] = true;
                    covered += 1;
                }
            }
        }
        let frame = GridFrame::new(self.side as u64, self.side as u64, 1.0, Pose::default())?;
        Ok(OccupancyGrid::from_fn(frame, |cell| {
            if is_covered[index(cell)] { CellState::Occupied } else { CellState::Free }
        }))
    }
}
