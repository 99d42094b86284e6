//! The cells on diagonals at which a search has an event.

use super::stops::StopBitmaps;
use crate::map::{BitGrid, Cell};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Events of diagonal scans, for each of the four diagonal directions: the cells at which a scan
/// along their row or column ends at a jump point, or at which the diagonal step onward is not
/// free. A search goes from one event to the next, 64 cells at a time.
///
/// Diagonals are stored as rows. A cell whose bit in the padded map is in column X and row Y is
/// bit X of row (X - Y) mod P for diagonals that rise to the east, and of row (X + Y) mod P for
/// those that fall; P is the number of padded rows. So every cell is stored once; a diagonal that
/// leaves the map meets the padding, whose bits are set. Memory: four bits per cell.
#[derive(Clone, Debug)]
pub(crate) struct DiagonalEvents {
    /// Indexed by (to the east, to the north): see [`Self::words`].
    directions: [Vec<u64>; 4],
    /// Padded rows of the map.
    rows: usize,
    /// Bits from one row to the next.
    stride: usize,
    /// Share of free cells with an event.
    share: f64,
}

/// Bits of the map row by row, padding included.
struct Plane {
    words: Vec<u64>,
    words_per_row: usize,
}

impl DiagonalEvents {
    pub(in crate::map) fn new(
        blocked: &BitGrid,
        transposed: &BitGrid,
        stops: &StopBitmaps,
    ) -> Self {
        let east = jumps_upwards(&stops.east, blocked);
        let west = jumps_downwards(&stops.west, blocked);
        let north = jumps_upwards(&stops.north, transposed).transposed();
        let south = jumps_downwards(&stops.south, transposed).transposed();
        let planes = [(&west, &south), (&west, &north), (&east, &south), (&east, &north)];
        let free = u64::from(blocked.width()) * u64::from(blocked.height()) - blocked.count_ones();
        let mut events = 0;
        let mut directions = [const { Vec::new() }; 4];
        for (direction, (row, column)) in planes.into_iter().enumerate() {
            let (to_east, to_north) = (direction & 2 != 0, direction & 1 != 0);
            let plane = Plane::of(row, column, &stops.cramped, (to_east, to_north));
            events += plane.count_outside(blocked);
            directions[direction] = plane.sheared(to_east == to_north);
        }
        let share = events as f64 / (4 * free).max(1) as f64;
        let rows = blocked.height() as usize + 2;
        Self { directions, rows, stride: blocked.stride(), share }
    }

    /// Events of a direction.
    #[inline]
    pub(crate) const fn words<const TO_EAST: bool, const TO_NORTH: bool>(&self) -> &[u64] {
        self.directions[2 * TO_EAST as usize + TO_NORTH as usize].as_slice()
    }

    /// Index of a cell's bit among them.
    #[inline]
    pub(crate) const fn bit<const TO_EAST: bool, const TO_NORTH: bool>(&self, cell: Cell) -> usize {
        let (x, y) = ((cell.x + 1) as usize, (cell.y + 1) as usize);
        let mut row = if TO_EAST == TO_NORTH { x + self.rows - y } else { x + y };
        // Avoids divisions, which are slow; maps are seldom many times as wide as they are high.
        if row >= self.rows {
            row -= self.rows;
            if row >= self.rows {
                row %= self.rows;
            }
        }
        row * self.stride + x
    }

    /// Memory on the heap \[bytes\].
    pub(crate) fn memory_bytes(&self) -> usize {
        self.directions.iter().map(|words| size_of::<u64>() * words.capacity()).sum()
    }
}

impl Plane {
    /// Events of a direction, from the jump points along rows and columns.
    fn of(
        row_jumps: &BitGrid,
        column_jumps: &BitGrid,
        cramped: &BitGrid,
        (to_east, to_north): (bool, bool),
    ) -> Self {
        let words_per_row = cramped.row(0).len();
        let height = cramped.height() as i32;
        let mut words = Vec::with_capacity(words_per_row * (height as usize + 2));
        for y in -1..=height {
            // Row of the 2 x 2 cells that a step needs, which are indexed by their south-western
            // one.
            let block = if to_north { y } else { y - 1 };
            if block < -1 {
                words.extend((0..words_per_row).map(|_| u64::MAX));
                continue;
            }
            let (block, row, column) = (cramped.row(block), row_jumps.row(y), column_jumps.row(y));
            for word in 0..words_per_row {
                let narrow = if to_east {
                    block[word]
                } else {
                    block[word] << 1 | if word == 0 { 1 } else { block[word - 1] >> 63 }
                };
                words.push(narrow | row[word] | column[word]);
            }
        }
        Self { words, words_per_row }
    }

    /// Number of set bits at cells that are not blocked.
    fn count_outside(&self, blocked: &BitGrid) -> u64 {
        let pairs = self.words.iter().zip(blocked.words());
        pairs.map(|(own, blocked)| u64::from((own & !blocked).count_ones())).sum()
    }

    /// Events with diagonals as rows: those that rise to the east, or those that fall.
    fn sheared(&self, rises: bool) -> Vec<u64> {
        let rows = self.words.len() / self.words_per_row;
        let mut sheared = vec![0; self.words.len()];
        let (mut strip, mut next) = (vec![0; rows], vec![0; rows]);
        for word in 0..self.words_per_row {
            for (y, own) in strip.iter_mut().enumerate() {
                *own = self.words[y * self.words_per_row + word];
            }
            // Column i of the strip moves by i rows, in powers of two.
            for (power, moves) in COLUMNS.into_iter().enumerate() {
                let by = (1 << power) % rows;
                let by = if rises { by } else { (rows - by) % rows };
                let (wraps, goes_on) = strip.split_at(by);
                let (up, last) = next.split_at_mut(rows - by);
                let (up_stays, last_stays) = strip.split_at(rows - by);
                merge(up, up_stays, goes_on, moves);
                merge(last, last_stays, wraps, moves);
                std::mem::swap(&mut strip, &mut next);
            }
            let first = 64 * word % rows;
            for row in 0..rows {
                let (from, to) = if rises { (first, row) } else { (row, first) };
                let from = if from >= to { from - to } else { from + rows - to };
                sheared[row * self.words_per_row + word] = strip[from];
            }
        }
        sheared
    }
}

/// Combines two columns of words: bits in `moves` from `comes`, the others from `stays`.
fn merge(own: &mut [u64], stays: &[u64], comes: &[u64], moves: u64) {
    for (own, (stays, comes)) in own.iter_mut().zip(stays.iter().zip(comes)) {
        *own = stays & !moves | comes & moves;
    }
}

/// Masks of the columns of a word whose index has the n-th binary digit set.
const COLUMNS: [u64; 6] = [
    0xaaaa_aaaa_aaaa_aaaa,
    0xcccc_cccc_cccc_cccc,
    0xf0f0_f0f0_f0f0_f0f0,
    0xff00_ff00_ff00_ff00,
    0xffff_0000_ffff_0000,
    0xffff_ffff_0000_0000,
];

/// Cells from which a scan towards higher bits ends at a jump point, not at a blocked cell.
fn jumps_upwards(stops: &BitGrid, blocked: &BitGrid) -> BitGrid {
    let mut jumps = blocked.clone();
    for y in 0..stops.height() as i32 {
        let (stops, blocked) = (stops.row(y), blocked.row(y));
        // True if a scan from the last bit of a word meets a jump point.
        let mut beyond = 0;
        for word in (0..stops.len()).rev() {
            let jump = stops[word] & !blocked[word];
            let (mut known, mut passes) = (jump >> 1 | beyond << 63, !stops[word] >> 1);
            for by in [1, 2, 4, 8, 16, 32] {
                known |= passes & known >> by;
                passes &= passes >> by;
            }
            jumps.set_word(y, word, known);
            beyond = (jump | !stops[word] & known) & 1;
        }
    }
    jumps
}

/// Like [`jumps_upwards`], towards lower bits.
fn jumps_downwards(stops: &BitGrid, blocked: &BitGrid) -> BitGrid {
    let mut jumps = blocked.clone();
    for y in 0..stops.height() as i32 {
        let (stops, blocked) = (stops.row(y), blocked.row(y));
        let mut beyond = 0;
        for word in 0..stops.len() {
            let jump = stops[word] & !blocked[word];
            let (mut known, mut passes) = (jump << 1 | beyond, !stops[word] << 1);
            for by in [1, 2, 4, 8, 16, 32] {
                known |= passes & known << by;
                passes &= passes << by;
            }
            jumps.set_word(y, word, known);
            beyond = (jump | !stops[word] & known) >> 63;
        }
    }
    jumps
}

/// Events of a map, computed once searches have walked enough on it for them to pay: a map that
/// changes all the time, or is searched once, does without.
#[derive(Debug, Default)]
pub(in crate::map) struct LazyDiagonals {
    /// Number of cells on diagonals that searches have walked since the last change.
    walked: AtomicU64,
    known: OnceLock<Option<DiagonalEvents>>,
}

impl LazyDiagonals {
    /// Largest share of free cells with an event at which the events help a jump point search.
    /// Measured: at 0.4 (a maze with corridors of four cells) it takes a tenth fewer
    /// instructions, at 0.9 (clutter) a tenth more.
    const MOST: f64 = 0.5;

    /// Computing the events costs about as much as walking this many cells for each 64 of the
    /// map.
    const CELLS_PER_WORD: u64 = 6;

    /// The events, once they pay.
    pub(in crate::map) fn get(
        &self,
        blocked: &BitGrid,
        transposed: &BitGrid,
        stops: &StopBitmaps,
    ) -> Option<&DiagonalEvents> {
        if let Some(known) = self.known.get() {
            return known.as_ref();
        }
        if self.walked.load(Ordering::Relaxed) < Self::CELLS_PER_WORD * blocked.words().len() as u64
        {
            return None;
        }
        let pays = |events: &DiagonalEvents| events.share <= Self::MOST;
        let new = || Some(DiagonalEvents::new(blocked, transposed, stops)).filter(pays);
        self.known.get_or_init(new).as_ref()
    }

    /// Records the number of cells that a search has walked.
    pub(in crate::map) fn note(&self, cells: u64) {
        self.walked.fetch_add(cells, Ordering::Relaxed);
    }

    /// Discards the events; to be called after a blocked cell has changed.
    pub(in crate::map) fn forget(&mut self) {
        *self = Self::default();
    }

    pub(in crate::map) fn memory_bytes(&self) -> usize {
        self.known.get().and_then(Option::as_ref).map_or(0, DiagonalEvents::memory_bytes)
    }
}

impl Clone for LazyDiagonals {
    fn clone(&self) -> Self {
        let walked = AtomicU64::new(self.walked.load(Ordering::Relaxed));
        Self { walked, known: self.known.clone() }
    }
}

impl PartialEq for LazyDiagonals {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid, SearchMap};
    use crate::search::bit_scan::{is_set, next_one, previous_one};
    use proptest::prelude::*;

    /// True if a scan in a straight direction, cell by cell, ends at a jump point.
    fn ends_at_jump(map: &SearchMap, from: Cell, (dx, dy): (i32, i32)) -> bool {
        let blocked = |x: i32, y: i32| !map.is_free(Cell::new(x, y));
        let Cell { mut x, mut y } = from;
        loop {
            (x, y) = (x + dx, y + dy);
            if blocked(x, y) {
                return false;
            }
            for (sx, sy) in [(dy, dx), (-dy, -dx)] {
                if blocked(x - dx + sx, y - dy + sy) && !blocked(x + sx, y + sy) {
                    return true;
                }
            }
        }
    }

    fn is_event(map: &SearchMap, at: Cell, (dx, dy): (i32, i32)) -> bool {
        let ahead = [(dx, 0), (0, dy), (dx, dy)];
        let is_free = |&(dx, dy): &(i32, i32)| map.is_free(Cell::new(at.x + dx, at.y + dy));
        !ahead.iter().all(is_free)
            || ends_at_jump(map, at, (dx, 0))
            || ends_at_jump(map, at, (0, dy))
    }

    /// Compares the next event of a free cell found cell by cell with that found by bits.
    fn check<const TO_EAST: bool, const TO_NORTH: bool>(
        map: &SearchMap,
        events: &DiagonalEvents,
    ) -> Result<(), TestCaseError> {
        let step = |to: bool| if to { 1 } else { -1 };
        let (dx, dy) = (step(TO_EAST), step(TO_NORTH));
        for from in map.frame().cells().filter(|&cell| map.is_free(cell)) {
            let (words, bit) =
                (events.words::<TO_EAST, TO_NORTH>(), events.bit::<TO_EAST, TO_NORTH>(from));
            prop_assert_eq!(is_set(words, bit), is_event(map, from, (dx, dy)), "at {}", from);
            let found = if TO_EAST { next_one(words, bit) } else { previous_one(words, bit) };
            let mut steps = 1;
            let mut at = Cell::new(from.x + dx, from.y + dy);
            while map.is_free(at) && !is_event(map, at, (dx, dy)) {
                at = Cell::new(at.x + dx, at.y + dy);
                steps += 1;
            }
            prop_assert_eq!(found.abs_diff(bit), steps, "from {}", from);
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn events_follow_the_rule(
            (width, height) in (1i32..150, 1i32..90),
            occupied in prop::collection::vec((0i32..150, 0i32..90), 0..60),
        ) {
            let frame = crate::map::GridFrame::new(
                width as u64, height as u64, 1.0, crate::geometry::Pose::default(),
            ).unwrap();
            let grid = OccupancyGrid::from_fn(frame, |cell| {
                let is_occupied = occupied.contains(&(cell.x, cell.y));
                if is_occupied { crate::map::CellState::Occupied } else { crate::map::CellState::Free }
            });
            let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
            let events = map.diagonal_events();
            check::<true, true>(&map, &events)?;
            check::<false, true>(&map, &events)?;
            check::<false, false>(&map, &events)?;
            check::<true, false>(&map, &events)?;
        }
    }

    /// The events are computed once searches have walked enough, and discarded at the first
    /// change.
    #[test]
    fn they_come_when_they_pay() {
        let mut map = SearchMap::new(
            &OccupancyGrid::from_ascii(&[".....", "..#..", "....."]),
            LayerConfig::default(),
        )
        .unwrap();
        let walked = LazyDiagonals::CELLS_PER_WORD * map.blocked().words().len() as u64;
        map.note_walked(walked - 1);
        assert!(map.diagonals().is_none());
        map.note_walked(1);
        assert!(map.diagonals().is_none(), "something happens nearly everywhere");
        let open = OccupancyGrid::from_ascii(&["................"; 12]);
        map = SearchMap::new(&open, LayerConfig::default()).unwrap();
        map.note_walked(1000);
        assert!(map.diagonals().is_some() && map.clone().diagonals().is_some());
        map.apply(&[crate::map::Edit {
            cell: Cell::new(3, 3),
            state: crate::map::CellState::Occupied,
        }]);
        assert!(map.diagonals().is_none());
    }
}
