//! Steps to all cells of the 5 x 5 block around a cell.

use super::neighbours::{CornerRule, GridStep, Successors};
use super::{Cost, Euclidean, Metric, pattern};
use crate::map::{CellIndex, SearchMap};

/// The 24 cells of the 5 x 5 block around a cell that can be reached from it in a straight line:
/// 16 directions, 8 of them with a second, longer step. They are ordered by rows, the lowest
/// first.
///
/// Every cell that the line sweeps must be free. A *knight's* step (2, 1) sweeps (1, 0) and (1, 1)
/// and touches no corner. A double step sweeps the cell in its middle; a diagonal one keeps the
/// corner rule on both halves. Without corner cutting, the swept cells are those whose closed
/// squares the line meets; with it, those whose interior it meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbours24<'m> {
    words: &'m [u64],
    stride: usize,
    reaches: [Reach; 24],
}

/// A step and its conditions.
#[derive(Clone, Copy, Debug)]
struct Reach {
    /// Cells of the 3 x 3 block around the start of the step that must be free, as a [`pattern`].
    near: usize,
    /// Cells outside that block that must be free, as index offsets. They are tested only if the
    /// near ones are free, so they are on the map or in the padding next to it.
    far: [i32; 3],
    to: i32,
    cost: u64,
}

impl<'m> Neighbours24<'m> {
    /// The neighbours on a map with one cost for all cells.
    pub(crate) fn new(map: &'m SearchMap, corners: CornerRule) -> Self {
        let stride = map.blocked().stride();
        let rows = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy)));
        let mut offsets = rows.filter(|&offset| offset != (0, 0));
        let reaches = std::array::from_fn(|_| {
            let (dx, dy) = offsets.next().unwrap_or_default();
            Reach::new(dx, dy, corners, stride as i32)
        });
        Self { words: map.blocked().words(), stride, reaches }
    }

    fn is_free(&self, at: CellIndex) -> bool {
        self.words[at.as_usize() / 64] >> (at.0 % 64) & 1 == 0
    }
}

impl Reach {
    fn new(dx: i32, dy: i32, corners: CornerRule, stride: i32) -> Self {
        let index = |(x, y): (i32, i32)| y * stride + x;
        let is_near = |&(x, y): &(i32, i32)| x.abs() <= 1 && y.abs() <= 1;
        let swept = swept(dx, dy, corners);
        let near = swept.iter().filter(|cell| is_near(cell));
        let mut far = [index((dx, dy)); 3];
        for (slot, &cell) in far.iter_mut().zip(swept.iter().filter(|cell| !is_near(cell))) {
            *slot = index(cell);
        }
        Self {
            near: near.fold(0, |bits, (x, y)| bits | 1 << ((y + 1) * 3 + x + 1)),
            far,
            to: index((dx, dy)),
            cost: length(dx, dy),
        }
    }
}

impl Successors for Neighbours24<'_> {
    fn for_each(&self, at: CellIndex, mut visit: impl FnMut(GridStep)) {
        let blocked = pattern::around(self.words, self.stride, at.as_usize());
        let neighbour = |offset| CellIndex(at.0.wrapping_add_signed(offset));
        for reach in &self.reaches {
            if blocked & reach.near == 0 && reach.far.iter().all(|&o| self.is_free(neighbour(o))) {
                visit(GridStep { to: neighbour(reach.to), cost: reach.cost });
            }
        }
    }
}

/// The cells that must be free for a step, possibly with repetitions: at most 3 of them lie
/// outside the 3 x 3 block.
fn swept(dx: i32, dy: i32, corners: CornerRule) -> [(i32, i32); 7] {
    let (sx, sy) = (dx.signum(), dy.signum());
    // The middle of a double step, or the first cell of a knight's step and then (1, 1).
    let [middle, next, target] = [(dx / 2, dy / 2), (sx, sy), (dx, dy)];
    if dx.abs() == dy.abs() && corners == CornerRule::Forbid {
        [middle, next, (sx, 0), (0, sy), (dx, dy - sy), (dx - sx, dy), target]
    } else {
        [middle, next, target, target, target, target, target]
    }
}

/// The length of a step, as a [`Cost::key`]; that of a knight's step is rounded down.
fn length(dx: i32, dy: i32) -> u64 {
    let (dx, dy) = (dx.unsigned_abs(), dy.unsigned_abs());
    if dx == 0 || dy == 0 || dx == dy {
        Cost::octile(dx, dy).key()
    } else {
        Euclidean.length(dx, dy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Cell, LayerConfig, OccupancyGrid};
    use proptest::prelude::*;

    fn reached(rows: &[&str], at: Cell, corners: CornerRule) -> Vec<(i32, i32)> {
        let grid = OccupancyGrid::from_ascii(rows);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let mut found = Vec::new();
        Neighbours24::new(&map, corners).for_each(map.index(at), |step| {
            let to = map.cell(step.to);
            found.push((to.x - at.x, to.y - at.y));
        });
        found
    }

    #[test]
    fn all_24_row_by_row() {
        let found = reached(&["....."; 5], Cell::new(2, 2), CornerRule::Forbid);
        let rows = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy)));
        assert_eq!(found, rows.filter(|&offset| offset != (0, 0)).collect::<Vec<_>>());
    }

    #[test]
    fn lengths_by_hand() {
        // q = 93 222 358: 1 and 2 cells; p = 131 836 323: sqrt(2) and 2 sqrt(2).
        assert_eq!([length(1, 0), length(0, -2)], [93_222_358, 186_444_716]);
        assert_eq!([length(-1, 1), length(2, -2)], [131_836_323, 263_672_646]);
        // q sqrt(5) = 208 451 529.4.
        assert_eq!([length(2, 1), length(-1, 2)], [208_451_529; 2]);
    }

    /// Around (2, 2), with (3, 2) blocked: all steps past it are gone.
    #[test]
    fn a_blocked_neighbour() {
        let rows = [".....", ".....", "...#.", ".....", "....."];
        let gone = |corners| {
            let left = reached(&rows, Cell::new(2, 2), corners);
            let all = reached(&["....."; 5], Cell::new(2, 2), corners);
            all.into_iter().filter(|offset| !left.contains(offset)).collect::<Vec<_>>()
        };
        let swept = [(2, -1), (1, 0), (2, 0), (2, 1)];
        assert_eq!(gone(CornerRule::Allow), swept);
        let cut = [(2, -2), (1, -1), (2, -1), (1, 0), (2, 0), (1, 1), (2, 1), (2, 2)];
        assert_eq!(gone(CornerRule::Forbid), cut);
    }

    /// True if the segment from the centre of (0, 0) to that of `to` meets the square of a cell:
    /// its interior, or with `closed` its border as well. All numbers are multiples of 1/4, so
    /// exact.
    fn meets(to: (i32, i32), cell: (i32, i32), closed: bool) -> bool {
        let (mut low, mut high) = (0.0f64, 1.0f64);
        let mut inside = true;
        for (d, c) in [(to.0, cell.0), (to.1, cell.1)] {
            let (d, c) = (f64::from(d), f64::from(c));
            if d == 0.0 {
                inside &= c.abs() < 0.5;
                continue;
            }
            let ends = [(c - 0.5) / d, (c + 0.5) / d];
            low = low.max(ends[0].min(ends[1]));
            high = high.min(ends[0].max(ends[1]));
        }
        inside && (low < high || closed && low == high)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

        #[test]
        fn a_step_is_a_free_segment(width in 1i32..8, height in 1i32..8, columns in 0i32..130,
                                    bits: u64, at in (0i32..8, 0i32..8)) {
            let at = Cell::new(at.0 % width + columns, at.1 % height);
            // Free columns on the left vary the bit position within its words.
            let is_free = |x: i32, y: i32| {
                let (x, inside) = (x - columns, x >= 0 && y >= 0 && x < width + columns && y < height);
                let is_at = (x + columns, y) == (at.x, at.y);
                inside && (is_at || x < 0 || bits >> (y * 8 + x) & 1 == 0)
            };
            let rows: Vec<String> = (0..height).rev().map(|y| {
                (0..width + columns).map(|x| if is_free(x, y) { '.' } else { '#' }).collect()
            }).collect();
            let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
            let window: Vec<(i32, i32)> = (-2..=2).flat_map(|y| (-2..=2).map(move |x| (x, y))).collect();
            for corners in [CornerRule::Forbid, CornerRule::Allow] {
                let is_open = |&to: &(i32, i32)| to != (0, 0) && window.iter().all(|&(x, y)| {
                    let meets = meets(to, (x, y), corners == CornerRule::Forbid);
                    !meets || is_free(at.x + x, at.y + y)
                });
                let expected: Vec<_> = window.iter().copied().filter(is_open).collect();
                prop_assert_eq!(reached(&rows, at, corners), expected, "{} {}", at, rows.join("\n"));
            }
        }
    }
}
