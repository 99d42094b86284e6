//! What a search sees.

use super::dilation::{BlockedNeighbourhood, CLEARANCE_TOLERANCE};
use super::fingerprint::LazyFingerprint;
use super::{BitGrid, Cell, CellState, Clearance, Edit, GridFrame, OccupancyGrid, StopBitmaps};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A cell of a [`SearchMap`] as one number: its bit in the padded rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CellIndex(pub u32);

impl CellIndex {
    /// As an index into arrays with [`SearchMap::index_count`] entries.
    pub const fn as_usize(self) -> usize {
        self.0 as usize
    }
}

/// What a search makes of unknown cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum UnknownPolicy {
    /// They are obstacles.
    #[default]
    Blocked,
    /// They are free.
    Free,
    /// They may be crossed, but each step into one costs [`LayerConfig::unknown_penalty`] times
    /// as much.
    Penalised,
}

/// How the blocked cells of a [`SearchMap`] follow from an [`OccupancyGrid`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct LayerConfig {
    /// What unknown cells are.
    pub unknown: UnknownPolicy,
    /// How many times the usual cost a step into a penalised unknown cell has.
    pub unknown_penalty: u32,
    /// Radius of the robot, or any clearance asked for: a cell is free only when its centre keeps
    /// this distance from every obstacle square, and when a disc of this radius does not leave the
    /// map.
    pub clearance_m: f64,
    /// Obstacle expansion \[cells\] \[Wang2019\]: 1 blocks the 8 neighbours of every obstacle.
    pub expansion_cells: u32,
    /// Collision constraint L \[Yi2024, eq. (2)\]: a cell is free only when its centre is at least
    /// this far from every obstacle's centre in the L1 norm, in reference cells; 0 for none.
    pub l1_constraint: f64,
    /// Side of the reference cell of [`Self::l1_constraint`] \[m\].
    pub reference_cell_m: f64,
}

impl Default for LayerConfig {
    fn default() -> Self {
        Self {
            unknown: UnknownPolicy::Blocked,
            unknown_penalty: 3,
            clearance_m: 0.0,
            expansion_cells: 0,
            l1_constraint: 0.0,
            reference_cell_m: 1.0,
        }
    }
}

/// A value of a [`LayerConfig`] that cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{field} must be {expected}, got {value}")]
pub struct LayerError {
    /// The field.
    pub field: &'static str,
    /// What was expected.
    pub expected: &'static str,
    /// What was given.
    pub value: f64,
}

impl LayerConfig {
    /// No wider neighbourhood than this is blocked around an obstacle \[cells\].
    const MAX_REACH_CELLS: f64 = 100_000.0;

    fn neighbourhood(&self, resolution_m: f64) -> Result<BlockedNeighbourhood, LayerError> {
        let check = |field, value: f64, ok: bool, expected| {
            if ok { Ok(()) } else { Err(LayerError { field, expected, value }) }
        };
        let reach =
            |length_m: f64| length_m >= 0.0 && length_m / resolution_m <= Self::MAX_REACH_CELLS;
        let (clearance, l1, cell) = (self.clearance_m, self.l1_constraint, self.reference_cell_m);
        let length = "a length of at least 0 and at most 100000 cells";
        check("clearance_m", clearance, reach(clearance), length)?;
        check("reference_cell_m", cell, cell > 0.0 && cell.is_finite(), "a positive length")?;
        check("l1_constraint", l1, reach(l1 * cell), length)?;
        let expansion = f64::from(self.expansion_cells);
        check("expansion_cells", expansion, expansion <= Self::MAX_REACH_CELLS, length)?;
        let penalty = f64::from(self.unknown_penalty);
        let expected = "a factor from 1 to 1000";
        check("unknown_penalty", penalty, (1.0..=1000.0).contains(&penalty), expected)?;
        Ok(BlockedNeighbourhood::disc(clearance / resolution_m)
            .union(&BlockedNeighbourhood::square(self.expansion_cells))
            .union(&BlockedNeighbourhood::diamond(l1 * cell / resolution_m)))
    }
}

/// The layers of a map that a search reads: obstacle cells, blocked cells (row by row and
/// transposed, each with a blocked border around the map), penalised cells.
///
/// Everything is kept true by [`Self::apply`]; a plan never rebuilds any of it. Building costs a
/// few operations per 64 cells and row of the neighbourhood; memory is eight
/// bits per cell, one more with penalised cells.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchMap {
    frame: GridFrame,
    config: LayerConfig,
    neighbourhood: BlockedNeighbourhood,
    obstacles: BitGrid,
    blocked: BitGrid,
    blocked_transposed: BitGrid,
    stops: StopBitmaps,
    penalised: Option<BitGrid>,
    /// Cells from the map's border in which a disc of the clearance would leave the map.
    border_cells: i32,
    fingerprint: LazyFingerprint,
    revision: u64,
}

impl SearchMap {
    /// Derives all layers.
    ///
    /// # Errors
    /// When a number of the config is not usable; the error names its field.
    pub fn new(grid: &OccupancyGrid, config: LayerConfig) -> Result<Self, LayerError> {
        let frame = *grid.frame();
        let neighbourhood = config.neighbourhood(frame.resolution_m())?;
        let obstacles = obstacles(grid, config.unknown);
        let border_cells = border_cells(config.clearance_m / frame.resolution_m());
        let mut blocked = BitGrid::new(frame.width(), frame.height(), true);
        block_border(&mut blocked, border_cells);
        neighbourhood.stamp_all(&obstacles, &mut blocked);
        let blocked_transposed = blocked.transposed();
        Ok(Self {
            stops: StopBitmaps::new(&blocked, &blocked_transposed),
            penalised: (config.unknown == UnknownPolicy::Penalised).then(|| grid.unknown().clone()),
            revision: grid.revision(),
            frame,
            config,
            neighbourhood,
            obstacles,
            blocked,
            blocked_transposed,
            border_cells,
            fingerprint: LazyFingerprint::default(),
        })
    }

    /// Where the grid lies.
    pub const fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// The config that the layers follow.
    pub const fn config(&self) -> &LayerConfig {
        &self.config
    }

    /// Cells that hold an obstacle: occupied ones, and unknown ones where the policy says so.
    pub const fn obstacles(&self) -> &BitGrid {
        &self.obstacles
    }

    /// Cells that no path may visit; the padding around the map counts as blocked.
    pub const fn blocked(&self) -> &BitGrid {
        &self.blocked
    }

    /// [`Self::blocked`] with columns and rows exchanged.
    pub const fn blocked_transposed(&self) -> &BitGrid {
        &self.blocked_transposed
    }

    /// Where straight scans of a jump point search stop.
    pub const fn stops(&self) -> &StopBitmaps {
        &self.stops
    }

    /// Cells into which a step costs more, if any.
    pub const fn penalised(&self) -> Option<&BitGrid> {
        self.penalised.as_ref()
    }

    /// Counts the calls of [`Self::apply`] that changed a cell.
    pub const fn revision(&self) -> u64 {
        self.revision
    }

    /// A number for the size and the blocked cells, which tells whether what was prepared for a map
    /// still holds. Computed at the first call, and at the first one after [`Self::apply`] has
    /// changed an obstacle.
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint.get(&self.blocked)
    }

    /// Exact distances to this map's obstacles.
    pub const fn clearance(&self) -> Clearance<'_> {
        Clearance::new(&self.frame, &self.obstacles)
    }

    /// Memory of all layers on the heap \[bytes\].
    pub fn memory_bytes(&self) -> usize {
        let StopBitmaps { east, west, north, south, cramped } = &self.stops;
        let layers = [&self.obstacles, &self.blocked, &self.blocked_transposed];
        let always = layers.into_iter().chain([east, west, north, south, cramped]);
        always.chain(&self.penalised).map(BitGrid::memory_bytes).sum()
    }

    /// True when a path may visit the cell; false outside the map.
    pub fn is_free(&self, cell: Cell) -> bool {
        !self.blocked.get(cell)
    }

    /// One more than the largest [`CellIndex`] of this map, padding included.
    pub fn index_count(&self) -> usize {
        self.blocked.stride() * (self.frame.height() as usize + 2)
    }

    /// The index of a cell of the map (or of the padding next to it).
    pub fn index(&self, cell: Cell) -> CellIndex {
        CellIndex((cell.y + 1) as u32 * self.blocked.stride() as u32 + (cell.x + 1) as u32)
    }

    /// The cell of an index.
    pub fn cell(&self, index: CellIndex) -> Cell {
        let stride = self.blocked.stride() as u32;
        Cell::new((index.0 % stride) as i32 - 1, (index.0 / stride) as i32 - 1)
    }

    /// The free cell whose centre is nearest to `cell`'s centre (ties: lower row, then lower
    /// column), or for a cell outside the map to the nearest cell of the map; `None` when every cell
    /// is blocked. Costs as many cells as lie within the distance.
    pub fn nearest_free(&self, cell: Cell) -> Option<Cell> {
        let (width, height) = (self.frame.width() as i32, self.frame.height() as i32);
        let cell = Cell::new(cell.x.clamp(0, width - 1), cell.y.clamp(0, height - 1));
        let mut best: Option<(i64, Cell)> = None;
        for ring in 0..width.max(height) {
            if best.is_some_and(|(distance_sq, _)| i64::from(ring).pow(2) > distance_sq) {
                break;
            }
            for candidate in self.ring_cells(cell, ring).filter(|&c| self.is_free(c)) {
                let (dx, dy) = (i64::from(candidate.x - cell.x), i64::from(candidate.y - cell.y));
                let key = (dx * dx + dy * dy, (candidate.y, candidate.x));
                if best.is_none_or(|(d, c)| key < (d, (c.y, c.x))) {
                    best = Some((key.0, candidate));
                }
            }
        }
        best.map(|(_, cell)| cell)
    }

    /// The cells of the map at Chebyshev distance `ring` from one of its cells.
    fn ring_cells(&self, centre: Cell, ring: i32) -> impl Iterator<Item = Cell> {
        let (width, height) = (self.frame.width() as i32, self.frame.height() as i32);
        let sides = move |at: i32, count: i32| {
            let both = [at - ring, at + ring];
            let kept = both.into_iter().take(if ring == 0 { 1 } else { 2 });
            kept.filter(move |&side| side >= 0 && side < count)
        };
        let columns = (centre.x - ring).max(0)..=(centre.x + ring).min(width - 1);
        let rows = (centre.y - ring + 1).max(0)..=(centre.y + ring - 1).min(height - 1);
        let in_rows = sides(centre.y, height)
            .flat_map(move |y| columns.clone().map(move |x| Cell::new(x, y)));
        let in_columns =
            sides(centre.x, width).flat_map(move |x| rows.clone().map(move |y| Cell::new(x, y)));
        in_rows.chain(in_columns)
    }

    /// Changes cells, and with them every derived layer. Edits outside the map are ignored.
    ///
    /// Cost: a new obstacle stamps its neighbourhood (one row operation per row); a removed one
    /// tests each cell of the neighbourhood again.
    pub fn apply(&mut self, edits: &[Edit]) {
        let mut changed = false;
        let frame = self.frame;
        for edit in edits.iter().filter(|edit| frame.contains(edit.cell)) {
            if let Some(penalised) = &mut self.penalised {
                changed |= penalised.set(edit.cell, edit.state == CellState::Unknown);
            }
            let obstacle = match edit.state {
                CellState::Occupied => true,
                CellState::Unknown => self.config.unknown == UnknownPolicy::Blocked,
                CellState::Free => false,
            };
            if self.obstacles.set(edit.cell, obstacle) {
                changed = true;
                if obstacle {
                    self.stamp(edit.cell);
                } else {
                    self.unstamp(edit.cell);
                }
                self.update_stops(edit.cell);
                self.fingerprint.forget();
            }
        }
        self.revision += u64::from(changed);
    }

    fn stamp(&mut self, cell: Cell) {
        self.neighbourhood.stamp(cell, &mut self.blocked);
        // The neighbourhood is symmetric under the exchange of the axes.
        self.neighbourhood.stamp(Cell::new(cell.y, cell.x), &mut self.blocked_transposed);
    }

    fn unstamp(&mut self, removed: Cell) {
        let reach = self.neighbourhood.reach();
        for y in removed.y - reach..=removed.y + reach {
            for x in removed.x - reach..=removed.x + reach {
                let cell = Cell::new(x, y);
                let blocked =
                    self.near_border(cell) || self.neighbourhood.is_blocked(cell, &self.obstacles);
                self.blocked.set(cell, blocked);
                self.blocked_transposed.set(Cell::new(y, x), blocked);
            }
        }
    }

    fn update_stops(&mut self, changed: Cell) {
        let reach = self.neighbourhood.reach();
        let low = Cell::new(changed.x - reach, changed.y - reach);
        let high = Cell::new(changed.x + reach, changed.y + reach);
        self.stops.update(&self.blocked, &self.blocked_transposed, low, high);
    }

    fn near_border(&self, cell: Cell) -> bool {
        let b = self.border_cells;
        let (width, height) = (self.frame.width() as i32, self.frame.height() as i32);
        cell.x < b || cell.y < b || cell.x >= width - b || cell.y >= height - b
    }
}

/// Blocks the cells at most `cells` columns or rows from the border.
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

/// Columns next to the border whose cells' centres are nearer to it than the clearance.
fn border_cells(clearance_cells: f64) -> i32 {
    (clearance_cells * (1.0 - CLEARANCE_TOLERANCE) - 0.5).max(0.0).ceil() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use proptest::prelude::*;

    fn map(rows: &[&str], config: LayerConfig) -> SearchMap {
        SearchMap::new(&OccupancyGrid::from_ascii(rows), config).unwrap()
    }

    fn with_clearance(clearance_m: f64) -> LayerConfig {
        LayerConfig { clearance_m, ..LayerConfig::default() }
    }

    #[test]
    fn unknown_policies() {
        let rows = ["#?."];
        let blocked = |unknown| {
            let map = map(&rows, LayerConfig { unknown, ..LayerConfig::default() });
            (0..3).map(|x| !map.is_free(Cell::new(x, 0))).collect::<Vec<_>>()
        };
        assert_eq!(blocked(UnknownPolicy::Blocked), [true, true, false]);
        assert_eq!(blocked(UnknownPolicy::Free), [true, false, false]);
        assert_eq!(blocked(UnknownPolicy::Penalised), [true, false, false]);
    }

    #[test]
    fn a_disc_may_not_leave_the_map() {
        let open = ["....."; 5];
        assert!(map(&open, with_clearance(0.5)).is_free(Cell::new(0, 2)));
        let inflated = map(&open, with_clearance(0.6));
        assert!(!inflated.is_free(Cell::new(0, 2)) && inflated.is_free(Cell::new(1, 1)));
        assert_eq!(map(&open, with_clearance(9.0)).nearest_free(Cell::new(0, 0)), None);
    }

    #[test]
    fn names_the_bad_field() {
        let grid = OccupancyGrid::from_ascii(&["."]);
        let error = SearchMap::new(&grid, with_clearance(f64::NAN)).unwrap_err();
        assert_eq!(error.field, "clearance_m");
        let penalty = LayerConfig { unknown_penalty: 0, ..LayerConfig::default() };
        assert_eq!(SearchMap::new(&grid, penalty).unwrap_err().field, "unknown_penalty");
    }

    #[test]
    fn nearest_free_cell() {
        let map = map(&["##.##", "#####", "###.#"], LayerConfig::default());
        assert_eq!(map.nearest_free(Cell::new(0, 0)), Some(Cell::new(2, 2)));
        assert_eq!(map.nearest_free(Cell::new(4, 1)), Some(Cell::new(3, 0)));
        assert_eq!(map.nearest_free(Cell::new(2, 2)), Some(Cell::new(2, 2)));
        assert_eq!(map.nearest_free(Cell::new(40, -3)), Some(Cell::new(3, 0)));
        assert_eq!(map.nearest_free(Cell::new(i32::MIN, i32::MAX)), Some(Cell::new(2, 2)));
    }

    fn any_state() -> impl Strategy<Value = CellState> {
        prop_oneof![
            4 => Just(CellState::Free),
            1 => Just(CellState::Occupied),
            1 => Just(CellState::Unknown)
        ]
    }

    fn any_config() -> impl Strategy<Value = LayerConfig> {
        let unknown = prop_oneof![
            Just(UnknownPolicy::Blocked),
            Just(UnknownPolicy::Free),
            Just(UnknownPolicy::Penalised)
        ];
        (unknown, 0.0..0.25f64, 0u32..2, 0.0..2.5f64).prop_map(|(unknown, clearance_m, e, l1)| {
            LayerConfig {
                unknown,
                clearance_m,
                expansion_cells: e,
                l1_constraint: l1,
                reference_cell_m: 0.1,
                ..LayerConfig::default()
            }
        })
    }

    proptest! {
        #[test]
        fn a_cell_is_free_iff_every_rule_holds(states in prop::collection::vec(any_state(), 9 * 7),
                                               config in any_config()) {
            let frame = GridFrame::new(9, 7, 0.1, Pose::default()).unwrap();
            let mut each = states.iter();
            let grid = OccupancyGrid::from_fn(frame, |_| *each.next().unwrap());
            let map = SearchMap::new(&grid, config.clone()).unwrap();
            for cell in frame.cells() {
                let (cx, cy) = (f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5);
                let c = config.clearance_m - 1e-9;
                let border = cx.min(cy).min(9.0 - cx).min(7.0 - cy) * 0.1;
                let mut free = border >= c;
                for o in frame.cells() {
                    let solid = match grid.state(o).unwrap() {
                        CellState::Occupied => true,
                        CellState::Unknown => config.unknown == UnknownPolicy::Blocked,
                        CellState::Free => false,
                    };
                    let (dx, dy) = ((cell.x - o.x).abs(), (cell.y - o.y).abs());
                    let gap = |d: i32| (f64::from(d) - 0.5).max(0.0) * 0.1;
                    let near = (dx, dy) == (0, 0)
                        || gap(dx).hypot(gap(dy)) < c
                        || dx.max(dy) <= config.expansion_cells as i32
                        || f64::from(dx + dy) < config.l1_constraint - 1e-9;
                    free &= !(solid && near);
                }
                prop_assert_eq!(map.is_free(cell), free, "{}", cell);
            }
        }

        #[test]
        fn edits_give_what_a_rebuild_gives(states in prop::collection::vec(any_state(), 12 * 8),
                                           config in any_config(),
                                           edits in prop::collection::vec((0i32..13, 0i32..9, any_state()), 0..30)) {
            let frame = GridFrame::new(12, 8, 0.1, Pose::default()).unwrap();
            let mut each = states.iter();
            let mut grid = OccupancyGrid::from_fn(frame, |_| *each.next().unwrap());
            let mut map = SearchMap::new(&grid, config.clone()).unwrap();
            let edits: Vec<Edit> = edits.into_iter()
                .map(|(x, y, state)| Edit { cell: Cell::new(x, y), state }).collect();
            grid.apply(&edits);
            map.apply(&edits);
            let rebuilt = SearchMap::new(&grid, config).unwrap();
            prop_assert_eq!(map.blocked(), rebuilt.blocked());
            prop_assert_eq!(map.blocked_transposed(), rebuilt.blocked_transposed());
            prop_assert_eq!(map.obstacles(), rebuilt.obstacles());
            prop_assert_eq!(map.penalised(), rebuilt.penalised());
        }

        #[test]
        fn indices_and_cells_are_inverse(x in -1i32..=70, y in -1i32..=3) {
            let map = SearchMap::new(&OccupancyGrid::all_free(
                GridFrame::new(70, 3, 1.0, Pose::default()).unwrap()), LayerConfig::default()).unwrap();
            let index = map.index(Cell::new(x, y));
            prop_assert_eq!(map.cell(index), Cell::new(x, y));
            prop_assert!(index.as_usize() < map.index_count());
        }
    }
}
