//! The cells of a map as read from its file.

use super::packed::packed;
use super::{BitGrid, Cell, CellState, GridFrame, OccupancyError, OccupancyThresholds};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A change of one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edit {
    /// The cell.
    pub cell: Cell,
    /// Its new state.
    pub state: CellState,
}

/// An occupancy grid: the state of every cell (occupied, unknown or free), and optionally the
/// occupancy value of the file (0 to 100).
///
/// Memory: two bits per cell, and one byte more if the file has values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "GridParts")]
pub struct OccupancyGrid {
    frame: GridFrame,
    occupied: BitGrid,
    unknown: Arc<BitGrid>,
    values: Option<Values>,
    revision: u64,
}

/// A grid that is not yet validated.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GridParts {
    frame: GridFrame,
    occupied: BitGrid,
    unknown: BitGrid,
    values: Option<Values>,
    revision: u64,
}

impl TryFrom<GridParts> for OccupancyGrid {
    type Error = &'static str;

    fn try_from(parts: GridParts) -> Result<Self, &'static str> {
        let GridParts { frame, occupied, unknown, values, revision } = parts;
        let fits = |bits: &BitGrid| {
            (bits.width(), bits.height()) == (frame.width(), frame.height()) && !bits.padding()
        };
        let cells = frame.cell_count();
        let has_all = values.as_ref().is_none_or(|it| it.numbers.len() as u64 == cells);
        if !(fits(&occupied) && fits(&unknown) && has_all) {
            return Err("the number of cells of a map differs from that of its frame");
        }
        Ok(Self { frame, occupied, unknown: Arc::new(unknown), values, revision })
    }
}

/// The values from which the states of cells were derived.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Values {
    /// Row by row from the bottom; 0 to 100, 255 unknown.
    numbers: Vec<u8>,
    thresholds: OccupancyThresholds,
}

impl OccupancyGrid {
    /// The value of an unknown cell in [`Self::values`].
    pub const UNKNOWN_VALUE: u8 = 255;

    /// A grid of free cells.
    pub fn all_free(frame: GridFrame) -> Self {
        let [occupied, unknown] = no_bits(frame);
        Self::of_bits(frame, occupied, unknown)
    }

    fn of_bits(frame: GridFrame, occupied: BitGrid, unknown: BitGrid) -> Self {
        Self { frame, occupied, unknown: Arc::new(unknown), values: None, revision: 0 }
    }

    /// Creates a grid whose cells are given by `state`.
    pub fn from_fn(frame: GridFrame, mut state: impl FnMut(Cell) -> CellState) -> Self {
        let mut grids = no_bits(frame);
        for y in 0..frame.height() as i32 {
            let (mut occupied, mut unknown) = (0, 0);
            for x in 0..frame.width() as i32 {
                // Column x is bit x + 1; whole words are written.
                let bit = x as usize + 1;
                match state(Cell::new(x, y)) {
                    CellState::Free => {}
                    CellState::Occupied => occupied |= 1_u64 << (bit % 64),
                    CellState::Unknown => unknown |= 1_u64 << (bit % 64),
                }
                if bit % 64 == 63 || bit == frame.width() as usize {
                    write_word(&mut grids, y, bit / 64, [occupied, unknown]);
                    (occupied, unknown) = (0, 0);
                }
            }
        }
        let [occupied, unknown] = grids;
        Self::of_bits(frame, occupied, unknown)
    }

    /// Creates a grid from one byte per cell, which `state` converts to a state; `row` returns
    /// the bytes of row y, one per column. Costs some 3 instructions per cell.
    pub(super) fn from_rows<'a>(
        frame: GridFrame,
        row: impl Fn(usize) -> &'a [u8],
        state: impl Fn(u8) -> CellState + Copy,
    ) -> Self {
        let mut grids = no_bits(frame);
        for y in 0..frame.height() as usize {
            let bytes = row(y);
            debug_assert_eq!(bytes.len(), frame.width() as usize);
            // Column x is bit x + 1, so that the first word has one byte less.
            let (early, rest) = bytes.split_at(bytes.len().min(63));
            for (word, bytes) in std::iter::once(early).chain(rest.chunks(64)).enumerate() {
                let bits = |of| packed(bytes, |byte| state(byte) == of) << u32::from(word == 0);
                let states = [CellState::Occupied, CellState::Unknown];
                write_word(&mut grids, y as i32, word, states.map(bits));
            }
        }
        let [occupied, unknown] = grids;
        Self::of_bits(frame, occupied, unknown)
    }

    /// Creates a grid from occupancy values from 0 to 100, row by row from the bottom, which
    /// `thresholds` convert to states. The values are kept.
    ///
    /// # Errors
    /// Returns [`OccupancyError`] if there is not exactly one value per cell, or if the values
    /// are usually a mistake ([`OccupancyThresholds::check`]).
    pub fn from_values(
        frame: GridFrame,
        values: Vec<u8>,
        thresholds: OccupancyThresholds,
    ) -> Result<Self, OccupancyError> {
        thresholds.check(&values)?;
        Self::from_known_values(frame, values, thresholds)
    }

    /// Like [`Self::from_values`], for values that have been a map before: none is taken for a
    /// mistake.
    ///
    /// # Errors
    /// Returns [`OccupancyError`] if there is not exactly one value per cell.
    pub fn from_known_values(
        frame: GridFrame,
        values: Vec<u8>,
        thresholds: OccupancyThresholds,
    ) -> Result<Self, OccupancyError> {
        let (expected, got) = (frame.cell_count(), values.len() as u64);
        if got != expected {
            return Err(OccupancyError::Count { expected, got });
        }
        Ok(Self::from_value_per_cell(frame, values, thresholds))
    }

    /// Creates a grid from values; requires exactly one per cell.
    pub(super) fn from_value_per_cell(
        frame: GridFrame,
        numbers: Vec<u8>,
        thresholds: OccupancyThresholds,
    ) -> Self {
        let width = frame.width() as usize;
        let row = |y: usize| &numbers[y * width..(y + 1) * width];
        let mut grid = Self::from_rows(frame, row, |value| thresholds.state(value));
        grid.values = Some(Values { numbers, thresholds });
        grid
    }

    /// Creates a grid from flags of occupied cells, row by row from the bottom; the others are
    /// free.
    #[cfg(test)]
    pub(crate) fn from_occupied(frame: GridFrame, occupied: &[bool]) -> Self {
        let mut each = occupied.iter();
        Self::from_fn(frame, |_| match each.next() {
            Some(true) => CellState::Occupied,
            _ => CellState::Free,
        })
    }

    /// Creates a grid of 1 m cells from a drawing, top row first: `.` free, `?` unknown, anything
    /// else occupied. Meant for tests and examples.
    ///
    /// # Panics
    /// Panics if the rows are empty or differ in length.
    pub fn from_ascii(rows: &[&str]) -> Self {
        let width = rows.first().map_or(0, |row| row.len());
        assert!(rows.iter().all(|row| row.len() == width), "rows differ in length");
        let frame =
            GridFrame::new(width as u64, rows.len() as u64, 1.0, crate::geometry::Pose::default())
                .expect("a drawing has at least one cell");
        let row = |y: usize| rows[rows.len() - 1 - y].as_bytes();
        Self::from_rows(frame, row, |letter| match letter {
            b'.' => CellState::Free,
            b'?' => CellState::Unknown,
            _ => CellState::Occupied,
        })
    }

    /// Geometry of the grid: size, resolution and origin.
    pub const fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Occupied cells.
    pub const fn occupied(&self) -> &BitGrid {
        &self.occupied
    }

    /// Unknown cells.
    pub fn unknown(&self) -> &BitGrid {
        &self.unknown
    }

    /// Unknown cells, shared until either side changes one.
    pub(super) const fn shared_unknown(&self) -> &Arc<BitGrid> {
        &self.unknown
    }

    /// The occupancy values of the file, row by row from the bottom: 0 to 100, and
    /// [`Self::UNKNOWN_VALUE`].
    pub fn values(&self) -> Option<&[u8]> {
        self.values.as_ref().map(|values| values.numbers.as_slice())
    }

    /// The thresholds that converted [`Self::values`] to states; `None` without values.
    pub fn thresholds(&self) -> Option<OccupancyThresholds> {
        self.values.as_ref().map(|values| values.thresholds)
    }

    /// Number of calls of [`Self::apply`] that changed a cell.
    pub const fn revision(&self) -> u64 {
        self.revision
    }

    /// The state of a cell; `None` outside the grid.
    pub fn state(&self, cell: Cell) -> Option<CellState> {
        self.frame.contains(cell).then(|| {
            if self.occupied.get(cell) {
                CellState::Occupied
            } else if self.unknown.get(cell) {
                CellState::Unknown
            } else {
                CellState::Free
            }
        })
    }

    /// Changes cells; edits outside the grid are ignored. Increments the revision if a cell
    /// changed.
    pub fn apply(&mut self, edits: &[Edit]) {
        let mut changed = false;
        let frame = self.frame;
        for edit in edits.iter().filter(|edit| frame.contains(edit.cell)) {
            changed |= self.write(edit.cell, edit.state);
            if let Some(Values { numbers, thresholds }) = &mut self.values {
                let index =
                    edit.cell.y as usize * self.frame.width() as usize + edit.cell.x as usize;
                if thresholds.state(numbers[index]) != edit.state {
                    numbers[index] = match edit.state {
                        CellState::Free => 0,
                        CellState::Occupied => 100,
                        CellState::Unknown => Self::UNKNOWN_VALUE,
                    };
                }
            }
        }
        self.revision += u64::from(changed);
    }

    fn write(&mut self, cell: Cell, state: CellState) -> bool {
        let occupied = self.occupied.set(cell, state == CellState::Occupied);
        let unknown = set_shared(&mut self.unknown, cell, state == CellState::Unknown);
        occupied || unknown
    }
}

/// Bit grids without occupied and unknown cells. Their memory is touched only when a bit is set.
fn no_bits(frame: GridFrame) -> [BitGrid; 2] {
    std::array::from_fn(|_| BitGrid::new(frame.width(), frame.height(), false))
}

/// Writes a word of each grid that has no bit in it yet.
fn write_word(grids: &mut [BitGrid; 2], y: i32, word: usize, bits: [u64; 2]) {
    for (grid, bits) in grids.iter_mut().zip(bits).filter(|(_, bits)| *bits != 0) {
        grid.set_word(y, word, bits);
    }
}

/// Sets a bit of a grid that others may share, without changing their copy. Returns true if it
/// was different.
#[inline]
pub(super) fn set_shared(bits: &mut Arc<BitGrid>, cell: Cell, value: bool) -> bool {
    bits.get(cell) != value && copied_and_set(bits, cell, value)
}

/// Separate from the test above, which nearly always finds nothing to do.
#[cold]
#[inline(never)]
fn copied_and_set(bits: &mut Arc<BitGrid>, cell: Cell, value: bool) -> bool {
    Arc::make_mut(bits).set(cell, value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn drawing_top_row_first() {
        let grid = OccupancyGrid::from_ascii(&["#.?", "..."]);
        assert_eq!(grid.state(Cell::new(0, 1)), Some(CellState::Occupied));
        assert_eq!(grid.state(Cell::new(2, 1)), Some(CellState::Unknown));
        assert_eq!(grid.state(Cell::new(0, 0)), Some(CellState::Free));
        assert_eq!(grid.state(Cell::new(3, 0)), None);
    }

    proptest! {
        #[test]
        fn rows_of_bytes_are_cells(width in 1u64..200, height in 1u64..4, bytes in prop::collection::vec(any::<u8>(), 800)) {
            let frame = GridFrame::new(width, height, 1.0, crate::geometry::Pose::default()).unwrap();
            let (columns, thresholds) = (width as usize, OccupancyThresholds::default());
            let grid = OccupancyGrid::from_rows(
                frame, |y| &bytes[y * columns..(y + 1) * columns], |value| thresholds.state(value),
            );
            let expected = OccupancyGrid::from_fn(frame, |cell| {
                thresholds.state(bytes[cell.y as usize * columns + cell.x as usize])
            });
            prop_assert_eq!(grid, expected);
        }
    }

    #[test]
    fn edits_count_revisions_and_keep_values_up_to_date() {
        let frame = *OccupancyGrid::from_ascii(&["..."]).frame();
        let from =
            |values| OccupancyGrid::from_values(frame, values, OccupancyThresholds::default());
        let mut grid = from(vec![20, 100, 255]).unwrap();
        let edit = |x, state| Edit { cell: Cell::new(x, 0), state };
        grid.apply(&[edit(0, CellState::Free), edit(9, CellState::Occupied)]);
        assert_eq!((grid.revision(), grid.values().unwrap()[0]), (0, 20));
        grid.apply(&[edit(0, CellState::Occupied), edit(2, CellState::Free)]);
        assert_eq!((grid.revision(), grid.values()), (1, Some(&[100, 100, 0][..])));
        assert_eq!(grid.state(Cell::new(2, 0)), Some(CellState::Free));
        assert_eq!(from(vec![0, 100]), Err(OccupancyError::Count { expected: 3, got: 2 }));
        assert_eq!(from(vec![0, 1, 1]), Err(OccupancyError::Mask { largest: 1 }));
    }

    #[test]
    fn a_wall_of_90_is_a_wall() {
        use CellState::{Free, Occupied, Unknown};
        let frame = *OccupancyGrid::from_ascii(&["....."]).frame();
        let values = vec![0, 90, 50, 25, 255];
        let thresholds = OccupancyThresholds::default();
        let grid = OccupancyGrid::from_values(frame, values, thresholds).unwrap();
        let states: Vec<_> = frame.cells().filter_map(|cell| grid.state(cell)).collect();
        assert_eq!(states, [Free, Occupied, Unknown, Free, Unknown]);
        assert_eq!(grid.thresholds(), Some(thresholds));
    }
}
