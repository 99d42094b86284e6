//! Cells as single numbers.

use super::Cell;

/// A cell of a [`super::SearchMap`] as one number: its bit in the padded rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CellIndex(pub u32);

impl CellIndex {
    /// Index for arrays with [`super::SearchMap::index_count`] entries.
    pub const fn as_usize(self) -> usize {
        self.0 as usize
    }
}

/// Conversion between cells and their indices. Division by the row length is replaced by
/// multiplication with its reciprocal, because searches convert every generated node to a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Numbering {
    /// Number of indices from one row to the next.
    stride: u32,
    /// 2^64 / `stride`, rounded up.
    reciprocal: u64,
}

impl Numbering {
    /// Creates a numbering for rows of `stride` (at least 2) indices, padding included.
    pub(super) const fn new(stride: u32) -> Self {
        Self { stride, reciprocal: u64::MAX / stride as u64 + 1 }
    }

    pub(super) const fn index(self, cell: Cell) -> CellIndex {
        CellIndex((cell.y + 1) as u32 * self.stride + (cell.x + 1) as u32)
    }

    /// Exact for every index: the reciprocal is too large by less than 1, so the product is too
    /// large by less than 2^32 / 2^64, and no quotient is nearer than 1 / `stride` below a whole
    /// number.
    pub(super) const fn cell(self, index: CellIndex) -> Cell {
        let row = ((self.reciprocal as u128 * index.0 as u128) >> 64) as u32;
        Cell::new((index.0 - row * self.stride) as i32 - 1, row as i32 - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn by_division(stride: u32, index: u32) -> Cell {
        Cell::new((index % stride) as i32 - 1, (index / stride) as i32 - 1)
    }

    #[test]
    fn the_ends_of_every_row_of_long_and_short_rows() {
        for stride in [2, 3, 64, 128, 192, 16_448, 46_400, 1 << 20, 1_431_655_616, u32::MAX] {
            let numbering = Numbering::new(stride);
            let rows = u32::MAX / stride;
            for row in [0, 1, rows / 2, rows.saturating_sub(1), rows] {
                let first = row * stride;
                for index in [first, first.saturating_sub(1), first.saturating_add(stride - 1)] {
                    assert_eq!(numbering.cell(CellIndex(index)), by_division(stride, index));
                }
            }
        }
    }

    #[test]
    fn the_corners_of_the_largest_maps() {
        // Padded rows of a square map of 2^31 cells, of the widest and of the highest map.
        for (width, height) in [(46_340, 46_340), (1_431_655_000, 1), (1, 22_000_000)] {
            let frame =
                super::super::GridFrame::new(width, height, 1.0, crate::geometry::Pose::default());
            assert!(frame.is_ok(), "{width} x {height}");
            let stride = (width as u32 + 2).div_ceil(64) * 64;
            let numbering = Numbering::new(stride);
            for x in [-1, 0, width as i32 - 1, width as i32] {
                for y in [-1, 0, height as i32 - 1, height as i32] {
                    let cell = Cell::new(x, y);
                    let index = numbering.index(cell);
                    let expected = (i64::from(y) + 1) * i64::from(stride) + i64::from(x) + 1;
                    assert_eq!(i64::from(index.0), expected, "{cell}");
                    assert_eq!(numbering.cell(index), cell);
                }
            }
        }
    }

    proptest! {
        #[test]
        fn the_reciprocal_divides_exactly(stride in 2u32.., index: u32, rows in 0u32..70_000, off in 0u32..3) {
            let numbering = Numbering::new(stride);
            prop_assert_eq!(numbering.cell(CellIndex(index)), by_division(stride, index));
            // Just below, at, and just above a multiple.
            let near = (rows % (u32::MAX / stride + 1)) * stride;
            let near = near.saturating_add(off).saturating_sub(1);
            prop_assert_eq!(numbering.cell(CellIndex(near)), by_division(stride, near));
        }
    }
}
