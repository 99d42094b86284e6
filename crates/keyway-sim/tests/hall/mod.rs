//! A hall with two walls.

use keyway::geometry::Pose;
use keyway::map::{CellState, GridFrame, OccupancyGrid};

/// A hall of 12 m x 8 m in cells of 5 cm with two walls, between which a robot has to turn twice.
pub(crate) fn hall() -> OccupancyGrid {
    let frame = GridFrame::new(240, 160, 0.05, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let is_wall = (80..84).contains(&cell.x) && cell.y < 110
            || (150..154).contains(&cell.x) && cell.y > 50;
        if is_wall { CellState::Occupied } else { CellState::Free }
    })
}
