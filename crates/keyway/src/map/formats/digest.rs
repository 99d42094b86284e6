//! A number that identifies a map.

use crate::map::OccupancyGrid;

/// 64 bits (FNV-1a), as 16 hexadecimal digits, over the size, the resolution, the origin and the
/// state of every cell. Occupancy values beyond the states, and the count of revisions, do not
/// enter. The same on every platform; not made to withstand forgery.
pub fn digest(grid: &OccupancyGrid) -> String {
    let frame = grid.frame();
    let mut hash = Fnv::new();
    hash.write(&frame.width().to_le_bytes());
    hash.write(&frame.height().to_le_bytes());
    let origin = frame.origin();
    for number in [frame.resolution_m(), origin.x, origin.y, origin.theta] {
        // Adding 0 turns -0 into 0: equal numbers count as equal.
        hash.write(&(number + 0.0).to_bits().to_le_bytes());
    }
    for y in 0..frame.height() as i32 {
        let (occupied, unknown) = (grid.occupied().row(y), grid.unknown().row(y));
        for x in 0..frame.width() as usize {
            // 0 free, 1 occupied, 2 unknown; column x is bit x + 1.
            let bit = |row: &[u64]| row[(x + 1) / 64] >> ((x + 1) % 64) & 1;
            hash.write(&[(bit(occupied) | bit(unknown) << 1) as u8]);
        }
    }
    format!("{:016x}", hash.0)
}

/// Fowler-Noll-Vo 1a with 64 bits.
struct Fnv(u64);

impl Fnv {
    const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{Cell, CellState, Edit, GridFrame};

    #[test]
    fn published_test_vectors() {
        for (text, expected) in [
            ("", 0xcbf2_9ce4_8422_2325),
            ("a", 0xaf63_dc4c_8601_ec8c),
            ("foobar", 0x8594_4171_f739_67e8),
        ] {
            let mut hash = Fnv::new();
            hash.write(text.as_bytes());
            assert_eq!(hash.0, expected, "{text}");
        }
    }

    #[test]
    fn changes_with_cells_and_frame_only() {
        let grid = OccupancyGrid::from_ascii(&["#.?", "..."]);
        let same = digest(&grid);
        assert_eq!(same.len(), 16);
        let mut edited = grid.clone();
        let cell = Cell::new(1, 1);
        edited.apply(&[Edit { cell, state: CellState::Unknown }]);
        assert_ne!(digest(&edited), same);
        edited.apply(&[Edit { cell, state: CellState::Free }]);
        assert_eq!((digest(&edited), edited.revision()), (same.clone(), 2));

        let at = |origin| {
            let frame = GridFrame::new(3, 2, 1.0, origin).unwrap();
            digest(&OccupancyGrid::from_fn(frame, |cell| grid.state(cell).unwrap()))
        };
        assert_eq!(at(Pose::new(-0.0, 0.0, 0.0)), same);
        assert_ne!(at(Pose::new(1.0, 0.0, 0.0)), same);
        assert_ne!(digest(&OccupancyGrid::from_ascii(&["#.", "?.", ".."])), same);
    }
}
