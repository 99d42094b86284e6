//! What a search sees.

use super::cell_index::Numbering;
use super::components::LazyComponents;
use super::dilation::{BlockedNeighbourhood, CLEARANCE_TOLERANCE};
use super::fingerprint::LazyFingerprint;
use super::{
    BitGrid, Cell, CellIndex, CellState, Clearance, Components, Connectivity, Edit, GridFrame,
    LayerConfig, LayerError, OccupancyGrid, StopBitmaps, UnknownPolicy,
};

/// The layers of a map that a search reads: obstacle cells, blocked cells (row by row and
/// transposed, each with a blocked border around the map), penalised cells.
///
/// Everything is kept true by [`Self::apply`]; a plan never rebuilds any of it but the components and, for
/// prepared maps, the fingerprint, after a change. Building costs a few operations per 64 cells and row of the neighbourhood; memory
/// is eight bits per cell, one more with penalised cells, and 8 bytes for each run of free cells in
/// a row once [`Self::components`] are known.
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
    numbering: Numbering,
    components: LazyComponents,
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
        config.check_penalty(u64::from(frame.width()) * u64::from(frame.height()))?;
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
            numbering: Numbering::new(blocked.stride() as u32),
            components: LazyComponents::default(),
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

    /// Which free cells can be reached from which. Computed at the first call, and at the first one
    /// after [`Self::apply`] has changed a blocked cell; call it beforehand where a query shall not
    /// wait for it.
    pub fn components(&self, connectivity: Connectivity) -> &Components {
        self.components.get(&self.blocked, connectivity)
    }

    /// Memory of all layers, and of the components that are known, on the heap \[bytes\].
    pub fn memory_bytes(&self) -> usize {
        let StopBitmaps { east, west, north, south, cramped } = &self.stops;
        let layers = [&self.obstacles, &self.blocked, &self.blocked_transposed];
        let always = layers.into_iter().chain([east, west, north, south, cramped]);
        let layers: usize = always.chain(&self.penalised).map(BitGrid::memory_bytes).sum();
        layers + self.components.memory_bytes()
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
        self.numbering.index(cell)
    }

    /// The cell of an index.
    pub fn cell(&self, index: CellIndex) -> Cell {
        self.numbering.cell(index)
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
                self.components.forget();
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
