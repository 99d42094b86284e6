//! The cells on diagonals at which a search has an event.

use super::stops::{StopBitmaps, higher_neighbours, lower_neighbours};
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
    /// Estimated share of free cells with an event.
    share: f64,
}

impl DiagonalEvents {
    pub(in crate::map) fn new(blocked: &BitGrid, stops: &StopBitmaps) -> Self {
        let along_rows = [jumps_to_west(&stops.west, blocked), jumps_to_east(&stops.east, blocked)];
        let rows = blocked.height() as usize + 2;
        let mut counts = Counts::default();
        let mut directions = [const { Vec::new() }; 4];
        for to_north in [false, true] {
            let both = strips(blocked, stops, (&along_rows, to_north), &mut counts);
            for (to_east, strips) in [false, true].into_iter().zip(both) {
                let words = sheared(strips, rows, to_east == to_north);
                directions[2 * usize::from(to_east) + usize::from(to_north)] = words;
            }
        }
        Self { directions, rows, stride: blocked.stride(), share: counts.share() }
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

/// Free cells and events, both summed over the directions. Every seventh row is counted. Seven is
/// odd: in a regular map, walls often lie in every second or fourth row.
#[derive(Debug, Default)]
struct Counts {
    events: u64,
    free: u64,
}

impl Counts {
    const EVERY: i32 = 7;

    /// At the border of a map everything is an event.
    const FIRST: i32 = 3;

    /// Share of free cells with an event; 1 if no free cell was counted.
    fn share(&self) -> f64 {
        if self.free == 0 { 1.0 } else { self.events as f64 / self.free as f64 }
    }

    fn add(&mut self, events: u64, blocked: u64) {
        self.events += u64::from((events & !blocked).count_ones());
        self.free += u64::from((!blocked).count_ones());
    }
}

/// Events of the two directions to the north, or of those to the south: first the one to the west.
/// Each in strips of 64 columns, padding included, the words of a strip from row to row.
///
/// Rows come in the opposite order to that of a scan along a column: a scan from a cell ends at a
/// jump point if the next cell is one, or the scan from there does.
fn strips(
    blocked: &BitGrid,
    stops: &StopBitmaps,
    (along_rows, to_north): (&[Vec<u64>; 2], bool),
    counts: &mut Counts,
) -> [Vec<u64>; 2] {
    let (words_per_row, height) = (blocked.row(0).len(), blocked.height() as i32);
    let rows = height as usize + 2;
    let [mut west, mut east] = [(); 2].map(|()| vec![u64::MAX; words_per_row * rows]);
    let mut along_column = vec![0; words_per_row];
    for row in 0..height {
        let (y, ahead) = if to_north { (height - 1 - row, height - row) } else { (row, row - 1) };
        let (own, next) = (blocked.row(y), blocked.row(ahead));
        // The 2 x 2 cells that a step needs are indexed by their south-western one.
        let block = stops.cramped.row(y.min(ahead));
        let [to_west, to_east] = along_rows
            .each_ref()
            .map(|words| &words[words_per_row * y as usize..][..words_per_row]);
        for word in 0..words_per_row {
            let opens = lower_neighbours(own, word) & !lower_neighbours(next, word)
                | higher_neighbours(own, word) & !higher_neighbours(next, word);
            let passes = !(opens | next[word]);
            let along_column = &mut along_column[word];
            *along_column = opens & !next[word] | passes & *along_column;
            let at = word * rows + y as usize + 1;
            west[at] = lower_neighbours(block, word) | to_west[word] | *along_column;
            east[at] = block[word] | to_east[word] | *along_column;
            if y % Counts::EVERY == Counts::FIRST {
                counts.add(west[at], own[word]);
                counts.add(east[at], own[word]);
            }
        }
    }
    [west, east]
}

/// Strips with diagonals as rows: those that rise to the east, or those that fall. Row by row.
fn sheared(mut strips: Vec<u64>, rows: usize, rises: bool) -> Vec<u64> {
    let words_per_row = strips.len() / rows;
    let (mut sheared, mut next) = (vec![0; strips.len()], vec![0; rows]);
    for (word, strip) in strips.chunks_exact_mut(rows).enumerate() {
        // Column i of the strip moves by i rows, in powers of two. Their number is even, so the
        // result is in the strip again.
        for (power, moves) in COLUMNS.into_iter().enumerate() {
            let by = (1 << power) % rows;
            let by = if rises { by } else { (rows - by) % rows };
            let (from, to) =
                if power % 2 == 0 { (&*strip, &mut next[..]) } else { (&next[..], &mut *strip) };
            let (wraps, goes_on) = from.split_at(by);
            let (up, last) = to.split_at_mut(rows - by);
            let (up_stays, last_stays) = from.split_at(rows - by);
            merge(up, up_stays, goes_on, moves);
            merge(last, last_stays, wraps, moves);
        }
        let first = 64 * word % rows;
        let to = sheared[word..].iter_mut().step_by(words_per_row);
        if rises {
            let (low, high) = strip.split_at(first + 1);
            let from = low.iter().rev().chain(high.iter().rev());
            to.zip(from).for_each(|(to, from)| *to = *from);
        } else {
            let (low, high) = strip.split_at(rows - first);
            let from = high.iter().chain(low);
            to.zip(from).for_each(|(to, from)| *to = *from);
        }
    }
    sheared
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
const _: () = assert!(COLUMNS.len().is_multiple_of(2));

/// Cells from which a scan to the east ends at a jump point, not at a blocked cell. Row by row.
fn jumps_to_east(stops: &BitGrid, blocked: &BitGrid) -> Vec<u64> {
    let words_per_row = blocked.row(0).len();
    let mut jumps = vec![0; words_per_row * stops.height() as usize];
    for (y, jumps) in (0..).zip(jumps.chunks_exact_mut(words_per_row)) {
        // True if a scan from the last bit of a word meets a jump point.
        let mut beyond = 0;
        let row = jumps.iter_mut().zip(stops.row(y).iter().zip(blocked.row(y)));
        for (known, (stops, blocked)) in row.rev() {
            let jump = stops & !blocked;
            let mut passes = !stops >> 1;
            *known = jump >> 1 | beyond << 63;
            for by in [1, 2, 4, 8, 16, 32] {
                *known |= passes & *known >> by;
                passes &= passes >> by;
            }
            beyond = (jump | !stops & *known) & 1;
        }
    }
    jumps
}

/// Like [`jumps_to_east`], to the west.
fn jumps_to_west(stops: &BitGrid, blocked: &BitGrid) -> Vec<u64> {
    let words_per_row = blocked.row(0).len();
    let mut jumps = vec![0; words_per_row * stops.height() as usize];
    for (y, jumps) in (0..).zip(jumps.chunks_exact_mut(words_per_row)) {
        let mut beyond = 0;
        let row = jumps.iter_mut().zip(stops.row(y).iter().zip(blocked.row(y)));
        for (known, (stops, blocked)) in row {
            let (jump, passes) = (stops & !blocked, !stops);
            let after = jump << 1 | beyond;
            // Adding the first bit of a run clears it and the rest of the run.
            let runs = passes & !passes.wrapping_add(passes & after);
            *known = after | runs << 1;
            beyond = (jump | runs) >> 63;
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
    /// Largest estimated share of free cells with an event at which the events help a jump point
    /// search. Measured: at 0.4 (a maze with corridors of four cells) it takes a tenth fewer
    /// instructions, at 0.9 (clutter) a tenth more.
    const MOST: f64 = 0.5;

    /// Computing the events costs about as much as walking this many cells for each 64 of the
    /// map.
    const CELLS_PER_WORD: u64 = 4;

    /// The events, once they pay.
    pub(in crate::map) fn get(
        &self,
        blocked: &BitGrid,
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
        let new = || Some(DiagonalEvents::new(blocked, stops)).filter(pays);
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
