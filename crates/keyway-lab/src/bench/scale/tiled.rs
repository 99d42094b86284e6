//! A map, tiled to a larger one.

use super::ScaleError;
use keyway::map::{Cell, CellState, GridFrame, OccupancyGrid};

/// Returns a square of `side` x `side` cells: the map, with mirror images of it to the right and
/// above, so that structures at the border of a tile continue in the next one. The last tiles are
/// cut off.
pub(super) fn tiled(base: &OccupancyGrid, side: u32) -> Result<OccupancyGrid, ScaleError> {
    let from = base.frame();
    let frame = GridFrame::new(side.into(), side.into(), from.resolution_m(), from.origin())
        .map_err(ScaleError::Side)?;
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
