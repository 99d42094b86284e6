//! The steps from a cell and their costs.

use super::{Cost, pattern};
use crate::map::{BitGrid, CellIndex, Connectivity, SearchMap};
use serde::{Deserialize, Serialize};

/// The rule for diagonal steps past blocked side neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum CornerRule {
    /// Corners are not cut: both cells beside a diagonal step must be free (the rule of the
    /// MovingAI benchmarks, and the only one that is safe for a robot of non-zero size).
    #[default]
    Forbid,
    /// Corners may be cut, even between two blocked cells: only the target cell must be free.
    Allow,
}

impl CornerRule {
    /// Name in configs and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Forbid => "forbid",
            Self::Allow => "allow",
        }
    }

    /// Connectivity of the steps under this rule.
    pub const fn connectivity(self) -> Connectivity {
        match self {
            Self::Forbid => Connectivity::Four,
            Self::Allow => Connectivity::Eight,
        }
    }
}

/// One step of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridStep {
    /// The target cell.
    pub to: CellIndex,
    /// The cost of the step, as a [`Cost::key`].
    pub cost: u64,
}

/// The steps from each cell.
pub trait Successors {
    /// Calls `visit` for every step from `at`, in a fixed order.
    fn for_each(&self, at: CellIndex, visit: impl FnMut(GridStep));
}

/// The cost of steps, as a factor on their length.
pub trait StepCost {
    /// The cost factor of a step between two neighbours.
    fn factor(&self, from: CellIndex, to: CellIndex) -> u64;
}

/// The uniform cost: every step costs its length.
#[derive(Clone, Copy, Debug)]
pub struct Uniform;

impl StepCost for Uniform {
    fn factor(&self, _: CellIndex, _: CellIndex) -> u64 {
        1
    }
}

/// A step into a penalised (unknown) cell costs a multiple of its length.
#[derive(Clone, Copy, Debug)]
pub struct UnknownCost<'m> {
    penalised: &'m BitGrid,
    factor: u64,
}

impl<'m> UnknownCost<'m> {
    /// The penalised cells of a map and the factor of its config; `None` if the map has none.
    pub fn of(map: &'m SearchMap) -> Option<Self> {
        let factor = u64::from(map.config().unknown_penalty);
        map.penalised().map(|penalised| Self { penalised, factor })
    }
}

impl StepCost for UnknownCost<'_> {
    fn factor(&self, _: CellIndex, to: CellIndex) -> u64 {
        let bit = to.as_usize();
        if self.penalised.words()[bit / 64] >> (bit % 64) & 1 == 1 { self.factor } else { 1 }
    }
}

/// Costs for a search from the goal: its step from a to b is the robot's step from b to a.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reversed<C>(pub(crate) C);

impl<C: StepCost> StepCost for Reversed<C> {
    fn factor(&self, from: CellIndex, to: CellIndex) -> u64 {
        self.0.factor(to, from)
    }
}

/// The available steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moves {
    /// To the 4 side neighbours.
    Four,
    /// To the 4 side and the 4 corner neighbours, under a corner rule.
    Eight(CornerRule),
}

/// The free neighbours of a cell, east first, counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub struct Neighbours<'m, C> {
    words: &'m [u64],
    stride: usize,
    /// The open directions among all 8, for each pattern of the 3 x 3 cells around a cell.
    open_directions: &'static [u8; 512],
    offsets: [i32; 8],
    cost: C,
}

impl<'m, C> Neighbours<'m, C> {
    /// Creates the neighbour iteration for a map.
    pub fn new(map: &'m SearchMap, moves: Moves, cost: C) -> Self {
        let stride = map.blocked().stride();
        let s = stride as i32;
        Self {
            words: map.blocked().words(),
            stride,
            open_directions: match moves {
                Moves::Four => &STRAIGHT_ONLY,
                Moves::Eight(CornerRule::Forbid) => &WITHOUT_CUTTING,
                Moves::Eight(CornerRule::Allow) => &WITH_CUTTING,
            },
            offsets: [1, s + 1, s, s - 1, -1, -s - 1, -s, 1 - s],
            cost,
        }
    }
}

impl<C: StepCost> Successors for Neighbours<'_, C> {
    fn for_each(&self, at: CellIndex, mut visit: impl FnMut(GridStep)) {
        let mut open =
            self.open_directions[pattern::around(self.words, self.stride, at.as_usize())];
        while open != 0 {
            let direction = open.trailing_zeros() as usize;
            open &= open - 1;
            let to = CellIndex(at.0.wrapping_add_signed(self.offsets[direction]));
            let is_diagonal = direction % 2 == 1;
            let length = if is_diagonal { Cost::KEY_DIAGONAL } else { Cost::KEY_STRAIGHT };
            visit(GridStep { to, cost: length * self.cost.factor(at, to) });
        }
    }
}

static WITHOUT_CUTTING: [u8; 512] = open_directions(Moves::Eight(CornerRule::Forbid));
static WITH_CUTTING: [u8; 512] = open_directions(Moves::Eight(CornerRule::Allow));
static STRAIGHT_ONLY: [u8; 512] = open_directions(Moves::Four);

/// For every pattern of blocked cells, the open directions: bit k for direction k.
const fn open_directions(moves: Moves) -> [u8; 512] {
    let mut table = [0; 512];
    let mut pattern = 0;
    while pattern < 512 {
        let mut direction = 0;
        while direction < 8 {
            let mut open = !pattern::is_blocked(pattern, direction);
            if direction % 2 == 1 {
                let before = pattern::is_blocked(pattern, direction - 1);
                let after = pattern::is_blocked(pattern, direction + 1);
                open = open
                    && match moves {
                        Moves::Four => false,
                        Moves::Eight(CornerRule::Forbid) => !before && !after,
                        Moves::Eight(CornerRule::Allow) => true,
                    };
            }
            if open {
                table[pattern] |= 1 << direction;
            }
            direction += 1;
        }
        pattern += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Cell, LayerConfig, OccupancyGrid, UnknownPolicy};

    fn neighbours(rows: &[&str], at: Cell, corners: CornerRule) -> Vec<(i32, i32)> {
        neighbours_by(rows, at, Moves::Eight(corners))
    }

    fn neighbours_by(rows: &[&str], at: Cell, moves: Moves) -> Vec<(i32, i32)> {
        let grid = OccupancyGrid::from_ascii(rows);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let mut found = Vec::new();
        Neighbours::new(&map, moves, Uniform).for_each(map.index(at), |step| {
            let to = map.cell(step.to);
            let length = Cost::octile(to.x.abs_diff(at.x), to.y.abs_diff(at.y));
            assert_eq!(step.cost, length.key());
            found.push((to.x - at.x, to.y - at.y));
        });
        found
    }

    #[test]
    fn all_eight_counter_clockwise() {
        let all = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
        assert_eq!(neighbours(&["...", "...", "..."], Cell::new(1, 1), CornerRule::Forbid), all);
    }

    #[test]
    fn corners() {
        let rows = [".#.", "...", "..#"];
        let forbid = neighbours(&rows, Cell::new(1, 1), CornerRule::Forbid);
        assert_eq!(forbid, [(1, 0), (-1, 0), (-1, -1), (0, -1)]);
        let allow = neighbours(&rows, Cell::new(1, 1), CornerRule::Allow);
        assert_eq!(allow, [(1, 0), (1, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1)]);
    }

    #[test]
    fn four_straight_ones() {
        let rows = [".#.", "...", "..."];
        let four = neighbours_by(&rows, Cell::new(1, 1), Moves::Four);
        assert_eq!(four, [(1, 0), (-1, 0), (0, -1)]);
    }

    #[test]
    fn the_map_ends_at_its_border_in_every_word_position() {
        for width in [1, 61, 62, 63, 64, 65, 126, 127, 128, 129] {
            let row = ".".repeat(width);
            let rows = [row.as_str(), row.as_str()];
            for x in 0..width as i32 {
                let found = neighbours(&rows, Cell::new(x, 0), CornerRule::Forbid);
                let sides = i32::from(x > 0) + i32::from(x + 1 < width as i32);
                assert_eq!(found.len() as i32, 1 + 2 * sides, "column {x} of {width}");
            }
        }
    }

    #[test]
    fn unknown_cells_cost_their_factor() {
        let grid = OccupancyGrid::from_ascii(&["?."]);
        let config = LayerConfig {
            unknown: UnknownPolicy::Penalised,
            unknown_penalty: 5,
            ..LayerConfig::default()
        };
        let map = SearchMap::new(&grid, config).unwrap();
        let cost = UnknownCost::of(&map).unwrap();
        let (unknown, known) = (map.index(Cell::new(0, 0)), map.index(Cell::new(1, 0)));
        assert_eq!((cost.factor(known, unknown), cost.factor(unknown, known)), (5, 1));
        let back = Reversed(cost);
        assert_eq!((back.factor(known, unknown), back.factor(unknown, known)), (1, 5));
    }
}
