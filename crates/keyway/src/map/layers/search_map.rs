//! The map layers that a search reads.

use crate::ConfigError;
use crate::map::cell_index::Numbering;
use crate::map::layers::components::LazyComponents;
use crate::map::layers::config::Neighbourhoods;
use crate::map::layers::diagonals::{DiagonalEvents, LazyDiagonals};
use crate::map::layers::dilation::{BlockedNeighbourhood, CLEARANCE_TOLERANCE};
use crate::map::layers::edited::{EditedWindow, EditedWindows};
use crate::map::layers::fingerprint::LazyFingerprint;
use crate::map::layers::free_ends::FreeEnds;
use crate::map::occupancy::set_shared;
use crate::map::{
    BitGrid, Cell, CellIndex, CellState, CellWindow, Clearance, Components, Connectivity, Edit,
    GridFrame, LayerConfig, OccupancyGrid, StopBitmaps, UnknownPolicy,
};
use std::sync::Arc;

/// The map layers that a search reads: obstacle cells, unknown cells, and blocked cells (row by
/// row and transposed, each with a blocked border around the map).
///
/// [`Self::apply`] keeps everything up to date; a plan rebuilds nothing but the components and,
/// for prepared maps, the fingerprint, and these only after a change. Building costs a few
/// operations per 64 cells and row of the neighbourhood. Memory is nine bits per cell, and 8
/// bytes for each run of free cells in a row once [`Self::components`] are known.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchMap {
    frame: GridFrame,
    config: LayerConfig,
    /// Cells that an obstacle blocks, for each reason of the config and for all of them.
    pub(in crate::map) neighbourhoods: Neighbourhoods,
    neighbourhood: BlockedNeighbourhood,
    obstacles: BitGrid,
    /// Shared with the grid until one of them changes.
    unknown: Arc<BitGrid>,
    blocked: BitGrid,
    blocked_transposed: BitGrid,
    stops: StopBitmaps,
    diagonals: LazyDiagonals,
    pub(in crate::map) free_ends: FreeEnds,
    /// Cells from the map's border in which a disc of the clearance would leave the map.
    border_cells: i32,
    fingerprint: LazyFingerprint,
    numbering: Numbering,
    components: LazyComponents,
    revision: u64,
}

impl SearchMap {
    /// Creates a map with all its layers.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if a number of the config is not usable; the error names its
    /// field.
    pub fn new(grid: &OccupancyGrid, config: LayerConfig) -> Result<Self, ConfigError> {
        let frame = *grid.frame();
        let neighbourhoods = config.neighbourhoods(&frame)?;
        let neighbourhood = neighbourhoods.union();
        config.check_penalty(u64::from(frame.width()) * u64::from(frame.height()))?;
        let obstacles = obstacles(grid, config.unknown);
        let border_cells = border_cells(config.clearance_m / frame.resolution_m());
        let mut blocked = BitGrid::new(frame.width(), frame.height(), true);
        block_border(&mut blocked, border_cells);
        // If the border leaves no cell free there is nothing to add.
        if 2 * i64::from(border_cells) < i64::from(frame.width().min(frame.height())) {
            neighbourhood.stamp_all(&obstacles, &mut blocked);
        }
        let blocked_transposed = blocked.transposed();
        Ok(Self {
            stops: StopBitmaps::new(&blocked, &blocked_transposed),
            diagonals: LazyDiagonals::default(),
            free_ends: FreeEnds::new(config.free_ends_m / frame.resolution_m()),
            unknown: Arc::clone(grid.shared_unknown()),
            revision: grid.revision(),
            frame,
            config,
            neighbourhoods,
            neighbourhood,
            obstacles,
            numbering: Numbering::new(blocked.stride() as u32),
            components: LazyComponents::default(),
            blocked,
            blocked_transposed,
            border_cells,
            fingerprint: LazyFingerprint::default(),
        })
    }

    /// Geometry of the map: size, resolution and origin.
    pub const fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// The config of the layers.
    pub const fn config(&self) -> &LayerConfig {
        &self.config
    }

    /// Obstacle cells: occupied ones, and unknown ones if the policy says so.
    pub const fn obstacles(&self) -> &BitGrid {
        &self.obstacles
    }

    /// Cells that no path may visit; the padding around the map counts as blocked.
    pub const fn blocked(&self) -> &BitGrid {
        &self.blocked
    }

    /// [`Self::blocked`] with columns and rows exchanged.
    pub(crate) const fn blocked_transposed(&self) -> &BitGrid {
        &self.blocked_transposed
    }

    /// Cells at which the straight scans of a jump point search stop.
    pub(crate) const fn stops(&self) -> &StopBitmaps {
        &self.stops
    }

    /// The cells on diagonals at which a search has an event. Costs some hundred operations per
    /// 64 cells.
    pub(crate) fn diagonal_events(&self) -> DiagonalEvents {
        DiagonalEvents::new(&self.blocked, &self.stops)
    }

    /// Cached [`Self::diagonal_events`], available once jump point searches have walked enough
    /// for them to pay.
    pub(crate) fn diagonals(&self) -> Option<&DiagonalEvents> {
        self.diagonals.get(&self.blocked, &self.stops)
    }

    /// Records the number of cells on diagonals that a search has walked.
    pub(crate) fn note_walked(&self, cells: u64) {
        self.diagonals.note(cells);
    }

    /// Unknown cells, whatever the policy for them.
    pub fn unknown(&self) -> &BitGrid {
        &self.unknown
    }

    /// Cells that cost extra to enter, if any.
    pub fn penalised(&self) -> Option<&BitGrid> {
        match self.config.unknown {
            UnknownPolicy::Penalised => Some(&self.unknown),
            UnknownPolicy::Blocked | UnknownPolicy::Free => None,
        }
    }

    /// Number of occupied cells from `low` to `high` (both included, clipped to the map). Unknown
    /// cells do not count, even if they are obstacles. Costs an operation per 64 cells.
    pub(crate) fn occupied_between(&self, low: Cell, high: Cell) -> u64 {
        let count = |bits: &BitGrid| -> u64 {
            let rows = low.y.max(0)..=high.y.min(self.frame.height() as i32 - 1);
            rows.map(|y| u64::from(bits.count_in_span(y, low.x, high.x))).sum()
        };
        match self.config.unknown {
            // With this policy every unknown cell is an obstacle.
            UnknownPolicy::Blocked => count(&self.obstacles) - count(&self.unknown),
            UnknownPolicy::Free | UnknownPolicy::Penalised => count(&self.obstacles),
        }
    }

    /// Counts the calls of [`Self::apply`] and [`Self::free_ends`] that changed a cell.
    pub const fn revision(&self) -> u64 {
        self.revision
    }

    /// Hash of the size and the blocked cells, which shows if data prepared for a map are still
    /// valid. Computed at the first call, and at the first one after [`Self::apply`] has changed
    /// an obstacle.
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint.get(&self.blocked)
    }

    /// Lifts clearance, expansion and constraint in the discs of
    /// [`crate::map::LayerConfig::free_ends_m`] around these cells, replacing those given before.
    /// A cell whose centre lies in a disc (border included) is blocked only if it is an obstacle,
    /// also after later edits. Does nothing if the radius is 0; cells outside the map are
    /// ignored.
    ///
    /// Data prepared for a map take its discs into account. Costs a test of each cell of the
    /// discs.
    pub fn free_ends(&mut self, ends: &[Cell]) {
        if self.config().free_ends_m == 0.0 {
            return;
        }
        let frame = *self.frame();
        let inside = ends.iter().copied().filter(|&cell| frame.contains(cell)).collect();
        let before = self.free_ends.replace(inside);
        let (now, reach) = (self.free_ends.ends().to_vec(), self.free_ends.reach());
        let mut changed = false;
        // If one disc may cover the map, all cells are tested for it, and once is enough.
        let is_whole = reach >= frame.width().max(frame.height()) as i32;
        let count = if is_whole { 1 } else { usize::MAX };
        for end in before.into_iter().chain(now).take(count) {
            let window = self.influenced(&CellWindow { low: end, high: end }, reach);
            if self.test_cells(&window) {
                self.blocked_cells_changed(&window);
                changed = true;
            }
        }
        if changed {
            self.count_revision();
        }
    }

    /// Exact distances to this map's obstacles.
    pub const fn clearance(&self) -> Clearance<'_> {
        Clearance::new(&self.frame, &self.obstacles)
    }

    /// Connected components of the free cells. Computed at the first call, and at the first one
    /// after [`Self::apply`] has changed a blocked cell; call it beforehand if no query should
    /// wait for it.
    pub fn components(&self, connectivity: Connectivity) -> &Components {
        self.components.get(&self.blocked, connectivity)
    }

    /// Heap memory of all layers, and of the components computed so far \[bytes\]; that of
    /// unknown cells may be shared with the grid.
    pub fn memory_bytes(&self) -> usize {
        let StopBitmaps { east, west, north, south, cramped } = &self.stops;
        let layers = [&self.obstacles, &*self.unknown, &self.blocked, &self.blocked_transposed];
        let layers = layers.into_iter().chain([east, west, north, south, cramped]);
        layers.map(BitGrid::memory_bytes).sum::<usize>()
            + self.components.memory_bytes()
            + self.diagonals.memory_bytes()
    }

    /// State of a cell in the map; free outside the map.
    pub fn state(&self, cell: Cell) -> CellState {
        if self.unknown.get(cell) {
            CellState::Unknown
        } else if self.obstacles.get(cell) {
            CellState::Occupied
        } else {
            CellState::Free
        }
    }

    /// True when a path may visit the cell; false outside the map.
    pub fn is_free(&self, cell: Cell) -> bool {
        !self.blocked.get(cell)
    }

    /// One more than the largest [`CellIndex`] of this map, padding included.
    pub fn index_count(&self) -> usize {
        self.blocked.stride() * (self.frame.height() as usize + 2)
    }

    /// The index of a cell of the map (or of the adjacent padding).
    pub fn index(&self, cell: Cell) -> CellIndex {
        self.numbering.index(cell)
    }

    /// The cell with an index.
    pub fn cell(&self, index: CellIndex) -> Cell {
        self.numbering.cell(index)
    }

    /// Changes cells and every derived layer. Edits outside the map are ignored.
    ///
    /// Cost: a new obstacle stamps its neighbourhood (one row operation per row). Around removed
    /// ones the neighbourhoods are recomputed, 64 cells at a time, once for all edits that are
    /// near each other. Allocates nothing.
    pub fn apply(&mut self, edits: &[Edit]) {
        let (mut changed, mut edited) = (false, EditedWindows::default());
        let frame = self.frame;
        for edit in edits.iter().filter(|edit| frame.contains(edit.cell)) {
            changed |= set_shared(&mut self.unknown, edit.cell, edit.state == CellState::Unknown);
            let obstacle = match edit.state {
                CellState::Occupied => true,
                CellState::Unknown => self.config.unknown == UnknownPolicy::Blocked,
                CellState::Free => false,
            };
            if self.obstacles.set(edit.cell, obstacle) {
                changed = true;
                edited.note(edit.cell, !obstacle);
                if obstacle {
                    self.stamp(edit.cell);
                }
            }
        }
        let reach = self.neighbourhood.reach();
        for EditedWindow { window, is_cleared } in edited.iter() {
            let influenced = self.influenced(&window, reach);
            if is_cleared {
                self.derive(&influenced);
            }
            self.blocked_cells_changed(&influenced);
        }
        self.revision += u64::from(changed);
    }

    /// Blocks cells regardless of obstacles. An edit near them may free them again.
    pub(crate) fn close(&mut self, cells: &[Cell]) {
        self.set_blocked(cells, |_, _| true);
    }

    /// Frees closed cells unless something else blocks them.
    pub(crate) fn open(&mut self, cells: &[Cell]) {
        self.set_blocked(cells, Self::follows_blocked);
    }

    fn set_blocked(&mut self, cells: &[Cell], is_blocked: impl Fn(&Self, Cell) -> bool) {
        for &cell in cells {
            let blocked = is_blocked(self, cell);
            if self.blocked.set(cell, blocked) {
                self.blocked_transposed.set(Cell::new(cell.y, cell.x), blocked);
                self.blocked_cells_changed(&CellWindow { low: cell, high: cell });
                self.count_revision();
            }
        }
    }

    /// The cells that changes in a window may influence.
    fn influenced(&self, window: &CellWindow, reach: i32) -> CellWindow {
        let last = [self.frame.width() as i32 - 1, self.frame.height() as i32 - 1];
        let low = |at: i32| (at - reach).max(0);
        let high = |at: i32, last: i32| at.saturating_add(reach).min(last);
        CellWindow {
            low: Cell::new(low(window.low.x), low(window.low.y)),
            high: Cell::new(high(window.high.x, last[0]), high(window.high.y, last[1])),
        }
    }

    fn stamp(&mut self, cell: Cell) {
        self.neighbourhood.stamp(cell, &mut self.blocked);
        // The neighbourhood is symmetric under the exchange of the axes.
        self.neighbourhood.stamp(Cell::new(cell.y, cell.x), &mut self.blocked_transposed);
        let reach = self.neighbourhood.reach();
        if self.free_ends.are_near(cell, reach) {
            self.test_cells(&self.influenced(&CellWindow { low: cell, high: cell }, reach));
        }
    }

    /// Recomputes the blocked cells of a window.
    fn derive(&mut self, window: &CellWindow) {
        let is_narrow = self.neighbourhood.reach() <= BlockedNeighbourhood::MOST_WORD_REACH;
        if is_narrow && self.free_ends.ends().is_empty() {
            self.derive_words(window);
        } else {
            self.test_cells(window);
        }
    }

    /// Like [`Self::derive`], cell by cell; returns true if a cell changed.
    fn test_cells(&mut self, window: &CellWindow) -> bool {
        let mut changed = false;
        for cell in window.cells() {
            let blocked = self.follows_blocked(cell);
            changed |= self.blocked.set(cell, blocked);
            self.blocked_transposed.set(Cell::new(cell.y, cell.x), blocked);
        }
        changed
    }

    /// Like [`Self::derive`], 64 cells at a time. Column x is bit x + 1 of a row.
    fn derive_words(&mut self, window: &CellWindow) {
        let bit = |column: i32| (column + 1) as usize;
        for y in window.low.y..=window.high.y {
            for word in bit(window.low.x) / 64..=bit(window.high.x) / 64 {
                let near = self.neighbourhood.word(&self.obstacles, y, word);
                let blocked = near | self.border_word(y, word);
                let before = self.blocked.row(y)[word];
                self.blocked.set_word(y, word, blocked);
                let mut changed = blocked ^ before;
                while changed != 0 {
                    let place = changed.trailing_zeros();
                    let x = (64 * word) as i32 + place as i32 - 1;
                    self.blocked_transposed.set(Cell::new(y, x), blocked >> place & 1 == 1);
                    changed &= changed - 1;
                }
            }
        }
    }

    /// The bits of a word that are blocked because of the border, or are padding.
    fn border_word(&self, y: i32, word: usize) -> u64 {
        let (width, height) = (self.frame.width() as i32, self.frame.height() as i32);
        let b = self.border_cells.min(width);
        if y < b || y >= height - b {
            return u64::MAX;
        }
        // The bits before the first free column, and from the one after the last free column on.
        let first = 64 * word as i64;
        let below = |bit: i64| match bit - first {
            ..=0 => 0,
            1..=63 => (1 << (bit - first)) - 1,
            _ => u64::MAX,
        };
        below(i64::from(b) + 1) | !below(i64::from(width - b) + 1)
    }

    /// True if a cell is blocked according to obstacles and config alone.
    fn follows_blocked(&self, cell: Cell) -> bool {
        let in_zone =
            || self.near_border(cell) || self.neighbourhood.is_blocked(cell, &self.obstacles);
        self.obstacles.get(cell) || (!self.free_ends.contain(cell) && in_zone())
    }

    /// Updates the layers derived from blocked cells, after some cells of a window have changed.
    pub(in crate::map) fn blocked_cells_changed(&mut self, window: &CellWindow) {
        let CellWindow { low, high } = *window;
        self.stops.update(&self.blocked, &self.blocked_transposed, low, high);
        self.diagonals.forget();
        self.fingerprint.forget();
        self.components.forget();
    }

    /// Increments the revision of the layers.
    pub(in crate::map) const fn count_revision(&mut self) {
        self.revision += 1;
    }

    pub(in crate::map) fn near_border(&self, cell: Cell) -> bool {
        let b = self.border_cells;
        let (width, height) = (self.frame.width() as i32, self.frame.height() as i32);
        cell.x < b || cell.y < b || cell.x >= width - b || cell.y >= height - b
    }
}

/// Blocks the cells in the `cells` columns and rows next to the border.
fn block_border(blocked: &mut BitGrid, cells: i32) {
    let (width, height) = (blocked.width() as i32, blocked.height() as i32);
    if cells == 0 {
        return;
    }
    for y in 0..height {
        if y < cells || y >= height - cells {
            blocked.fill_span(y, 0, width - 1);
        } else {
            blocked.fill_span(y, 0, cells - 1);
            blocked.fill_span(y, width - cells, width - 1);
        }
    }
}

fn obstacles(grid: &OccupancyGrid, unknown: UnknownPolicy) -> BitGrid {
    let mut obstacles = grid.occupied().clone();
    if unknown == UnknownPolicy::Blocked {
        obstacles.merge(grid.unknown());
    }
    obstacles
}

/// Number of columns next to the border whose cells' centres are nearer to it than the clearance.
fn border_cells(clearance_cells: f64) -> i32 {
    (clearance_cells * (1.0 - CLEARANCE_TOLERANCE) - 0.5).max(0.0).ceil() as i32
}

#[cfg(test)]
#[path = "search_map_tests.rs"]
mod tests;
