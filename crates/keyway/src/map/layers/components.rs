//! Connected components of the free cells.

use crate::map::{BitGrid, Cell};
use std::ops::Range;
use std::sync::OnceLock;

/// Selects the neighbours with which a cell is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Connectivity {
    /// The four that share a side. Diagonal steps that cut no corner reach no further cells, as
    /// the cells beside such a step are free.
    Four,
    /// All eight: diagonal steps may pass blocked cells.
    Eight,
}

/// The connected components of the free cells of a map, numbered from 0 by their first cell in the
/// order of rows, then columns.
/// The free cells of each row are stored as runs, each with its component; a cell is looked up by
/// binary search in its row. Memory: 8 bytes per run and 4 per row and component.
///
/// Cost of computing them: a few operations per 64 cells and per run (union-find over runs that
/// touch in neighbouring rows).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    /// Index of the first run of each row, followed by the number of runs.
    first_runs: Vec<u32>,
    runs: Vec<Run>,
    /// Number of cells in each component.
    sizes: Vec<u32>,
}

/// A run of adjacent free cells in a row, up to the next blocked one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Run {
    first_column: u32,
    /// During the union-find: an earlier run of the same component, or its own index.
    component: u32,
}

impl Components {
    /// Computes the components of the cells that are not set in `blocked`, whose padding is set.
    pub(in crate::map) fn new(blocked: &BitGrid, connectivity: Connectivity) -> Self {
        let count = (0..blocked.height() as i32).map(|y| run_count(blocked.row(y))).sum();
        let mut first_runs = Vec::with_capacity(blocked.height() as usize + 1);
        let mut runs = Vec::with_capacity(count);
        let mut last_columns = Vec::with_capacity(count);
        first_runs.push(0);
        let mut below = 0..0;
        for y in 0..blocked.height() as i32 {
            let begin = runs.len();
            push_runs(blocked.row(y), &mut runs, &mut last_columns);
            let row = begin..runs.len();
            join_rows(&mut runs, &last_columns, below, row.clone(), connectivity);
            first_runs.push(row.end as u32);
            below = row;
        }
        let sizes = number_components(&mut runs, &last_columns);
        Self { first_runs, runs, sizes }
    }

    /// The component of a free cell of the map. Costs the logarithm of its row's number of runs.
    pub(crate) fn of_free(&self, cell: Cell) -> u32 {
        let row = self.row(cell.y);
        let next = row.partition_point(|run| run.first_column <= cell.x as u32);
        row[next - 1].component
    }

    /// Number of cells in each component.
    pub fn sizes(&self) -> &[u32] {
        &self.sizes
    }

    /// The component with the most cells (ties: the first); `None` if no cell is free.
    pub fn largest(&self) -> Option<u32> {
        let by_size = |&i: &usize| (self.sizes[i], std::cmp::Reverse(i));
        (0..self.sizes.len()).max_by_key(by_size).map(|i| i as u32)
    }

    /// Memory on the heap \[bytes\].
    pub const fn memory_bytes(&self) -> usize {
        size_of::<Run>() * self.runs.capacity()
            + size_of::<u32>() * (self.first_runs.capacity() + self.sizes.capacity())
    }

    /// The cell of a component whose centre is nearest to that of `to`, a cell of the map (ties:
    /// lower row, then lower column); `None` if the component does not exist. Costs a few
    /// operations for each run that is nearer.
    pub(in crate::map) fn nearest(
        &self,
        blocked: &BitGrid,
        component: u32,
        to: Cell,
    ) -> Option<Cell> {
        let mut nearest = Nearest { to, best: None };
        for dy in 0..blocked.height() as i32 {
            if nearest.is_closer_than_row(dy) {
                break;
            }
            let rows = [to.y - dy, to.y + dy];
            for y in rows.into_iter().take(if dy == 0 { 1 } else { 2 }) {
                if y >= 0 && y < blocked.height() as i32 {
                    self.nearest_in_row(blocked, component, y, &mut nearest);
                }
            }
        }
        nearest.best.map(|(_, y, x)| Cell::new(x, y))
    }

    /// Updates `nearest` with the component's nearest cell on either side in row `y`.
    fn nearest_in_row(&self, blocked: &BitGrid, component: u32, y: i32, nearest: &mut Nearest) {
        let (row, x) = (self.row(y), nearest.to.x);
        let (left, right) = row.split_at(row.partition_point(|run| run.first_column <= x as u32));
        let mut beyond = x;
        for run in left.iter().rev() {
            if !nearest.may_be(beyond, y) {
                break;
            }
            let first = run.first_column as i32;
            if run.component == component {
                let end = blocked.first_one_in_span(y, first, x).map_or(x, |blocked| blocked - 1);
                nearest.offer(end, y);
                break;
            }
            beyond = first;
        }
        for run in right {
            let first = run.first_column as i32;
            if !nearest.may_be(first, y) {
                break;
            }
            if run.component == component {
                nearest.offer(first, y);
                break;
            }
        }
    }

    fn row(&self, y: i32) -> &[Run] {
        let first = self.first_runs[y as usize] as usize;
        &self.runs[first..self.first_runs[y as usize + 1] as usize]
    }
}

/// The nearest cell so far: squared distance, row, column.
struct Nearest {
    to: Cell,
    best: Option<(i64, i32, i32)>,
}

impl Nearest {
    fn key(&self, x: i32, y: i32) -> (i64, i32, i32) {
        let (dx, dy) = (i64::from(x) - i64::from(self.to.x), i64::from(y) - i64::from(self.to.y));
        (dx * dx + dy * dy, y, x)
    }

    fn is_closer_than_row(&self, dy: i32) -> bool {
        self.best.is_some_and(|(distance_sq, ..)| distance_sq < i64::from(dy) * i64::from(dy))
    }

    fn may_be(&self, x: i32, y: i32) -> bool {
        self.best.is_none_or(|(distance_sq, ..)| self.key(x, y).0 <= distance_sq)
    }

    fn offer(&mut self, x: i32, y: i32) {
        let key = self.key(x, y);
        if self.best.is_none_or(|best| key < best) {
            self.best = Some(key);
        }
    }
}

/// Bits of the free cells of a word whose neighbour one bit lower is blocked. The first cell of a
/// row is padding, so that nothing is carried into it.
fn first_bits(row: &[u64], word: usize) -> u64 {
    let carry = if word > 0 { !row[word - 1] >> 63 } else { 0 };
    !row[word] & !(!row[word] << 1 | carry)
}

/// Like [`first_bits`], for the neighbour one bit higher.
fn last_bits(row: &[u64], word: usize) -> u64 {
    let carry = row.get(word + 1).map_or(0, |next| !next << 63);
    !row[word] & !(!row[word] >> 1 | carry)
}

fn run_count(row: &[u64]) -> usize {
    (0..row.len()).map(|word| first_bits(row, word).count_ones() as usize).sum()
}

/// Appends the runs of a padded row, each a component of its own, and their last columns.
fn push_runs(row: &[u64], runs: &mut Vec<Run>, last_columns: &mut Vec<u32>) {
    for word in 0..row.len() {
        // Column x is bit x + 1.
        let base = word as u32 * 64;
        for bit in bits(first_bits(row, word)) {
            let component = runs.len() as u32;
            runs.push(Run { first_column: base + bit - 1, component });
        }
        last_columns.extend(bits(last_bits(row, word)).map(|bit| base + bit - 1));
    }
}

/// The set bits of a word, lowest first.
fn bits(mut word: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        (word != 0).then(|| {
            let bit = word.trailing_zeros();
            word &= word - 1;
            bit
        })
    })
}

/// Joins the runs of two neighbouring rows that touch.
fn join_rows(
    runs: &mut [Run],
    last_columns: &[u32],
    below: Range<usize>,
    above: Range<usize>,
    connectivity: Connectivity,
) {
    let reach = u32::from(connectivity == Connectivity::Eight);
    let (mut a, mut b) = (below.start, above.start);
    while a < below.end && b < above.end {
        let (last_a, last_b) = (last_columns[a], last_columns[b]);
        if runs[a].first_column <= last_b + reach && runs[b].first_column <= last_a + reach {
            join(runs, a as u32, b as u32);
        }
        // The next run of the row that ends first is beyond the reach of the other one.
        if last_a < last_b {
            a += 1;
        } else {
            b += 1;
        }
    }
}

/// Merges the components of two runs: the earlier root becomes the root of both.
fn join(runs: &mut [Run], a: u32, b: u32) {
    let (a, b) = (root(runs, a), root(runs, b));
    runs[a.max(b) as usize].component = a.min(b);
}

/// Root of a run's component, the first run known so far; compresses the path.
fn root(runs: &mut [Run], mut run: u32) -> u32 {
    loop {
        let parent = runs[run as usize].component;
        if parent == run {
            return run;
        }
        runs[run as usize].component = runs[parent as usize].component;
        run = parent;
    }
}

/// Replaces roots by component numbers, and counts the cells of each.
fn number_components(runs: &mut [Run], last_columns: &[u32]) -> Vec<u32> {
    let mut sizes = Vec::new();
    for i in 0..runs.len() {
        let Run { first_column, component: parent } = runs[i];
        // Roots are the first runs of their components, and parents come before their children.
        let component = if parent as usize == i {
            sizes.push(0);
            sizes.len() as u32 - 1
        } else {
            runs[parent as usize].component
        };
        runs[i].component = component;
        sizes[component as usize] += last_columns[i] + 1 - first_column;
    }
    sizes
}

/// The components of a map's free cells, each connectivity computed on first use. Equality
/// ignores this cache.
#[derive(Clone, Debug, Default)]
pub(in crate::map) struct LazyComponents {
    four: OnceLock<Components>,
    eight: OnceLock<Components>,
}

impl LazyComponents {
    pub(in crate::map) fn get(&self, blocked: &BitGrid, connectivity: Connectivity) -> &Components {
        let known = match connectivity {
            Connectivity::Four => &self.four,
            Connectivity::Eight => &self.eight,
        };
        known.get_or_init(|| Components::new(blocked, connectivity))
    }

    /// Discards the components; to be called after a blocked cell has changed.
    pub(in crate::map) fn forget(&mut self) {
        *self = Self::default();
    }

    pub(in crate::map) fn memory_bytes(&self) -> usize {
        let known = [self.four.get(), self.eight.get()];
        known.into_iter().flatten().map(Components::memory_bytes).sum()
    }
}

impl PartialEq for LazyComponents {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

#[cfg(test)]
#[path = "components_tests.rs"]
mod tests;
