//! One side of a best-first search.

use super::{Observer, Side, Step, Successors};
use crate::map::{CellIndex, SearchMap};
use serde::{Deserialize, Serialize};
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// What a search did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SearchStatistics {
    /// Nodes taken from the open list.
    pub expanded: u64,
    /// Nodes put into the open list, or improved there.
    pub generated: u64,
}

/// The node that was just expanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expanded {
    /// The cell.
    pub at: CellIndex,
    /// Its path cost, as a [`super::Cost::key`].
    pub g: u64,
}

/// The open list and the nodes of one side of a search.
///
/// The open list is ordered by key, then larger g, then lower cell index, and dropped lazily: an
/// improved node is pushed again and the older entry skipped. Nodes are 16 bytes in one array per
/// map; they carry the epoch of their query, so a new query clears nothing, and pages that no query
/// touches are never touched.
#[derive(Clone, Debug, Default)]
pub struct Frontier {
    /// g, and parent << 32 | epoch << 1 | closed. Plain arrays, because only those are allocated
    /// as untouched zero pages.
    nodes: Vec<[u64; 2]>,
    epoch: u32,
    open: BinaryHeap<Reverse<OpenNode>>,
    statistics: SearchStatistics,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct OpenNode {
    key: u64,
    g: u64,
    at: CellIndex,
}

impl Ord for OpenNode {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key.cmp(&other.key).then(other.g.cmp(&self.g)).then(self.at.cmp(&other.at))
    }
}

impl PartialOrd for OpenNode {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Frontier {
    const MAX_EPOCH: u32 = (1 << 31) - 1;

    /// Forgets the last query and puts `root` into the open list.
    pub fn start(&mut self, map: &SearchMap, root: CellIndex) {
        if self.nodes.len() != map.index_count() {
            self.nodes = vec![[0; 2]; map.index_count()];
            self.epoch = 0;
        }
        if self.epoch == Self::MAX_EPOCH {
            self.nodes.fill([0; 2]);
            self.epoch = 0;
        }
        self.epoch += 1;
        self.open.clear();
        self.statistics = SearchStatistics { expanded: 0, generated: 1 };
        self.set(root, 0, root, false);
        self.open.push(Reverse(OpenNode { key: 0, g: 0, at: root }));
    }

    /// What was done since [`Self::start`].
    pub const fn statistics(&self) -> SearchStatistics {
        self.statistics
    }

    /// Memory on the heap \[bytes\].
    pub fn memory_bytes(&self) -> usize {
        size_of::<[u64; 2]>() * self.nodes.capacity()
            + size_of::<Reverse<OpenNode>>() * self.open.capacity()
    }

    /// Takes the best node from the open list and puts its successors in. `key` gives the value
    /// by which a node with path cost g is ordered. `None` when the open list is empty.
    ///
    /// Closed nodes are not opened again: with a consistent key their path cost is final.
    pub fn expand_best(
        &mut self,
        map: &SearchMap,
        successors: &impl Successors,
        key: impl Fn(CellIndex, u64) -> u64,
        seen: &mut impl Observer,
    ) -> Option<Expanded> {
        let OpenNode { g, at, .. } = self.pop_current()?;
        let parent = (self.nodes[at.as_usize()][1] >> 32) as u32;
        self.set(at, g, CellIndex(parent), true);
        self.statistics.expanded += 1;
        if seen.is_watching() {
            seen.expanded(Side::Forward, map.cell(at), cells(g));
        }
        successors.for_each(at, |Step { to, cost }| {
            let g = g + cost;
            if !self.improves(to, g) {
                return;
            }
            self.set(to, g, at, false);
            self.statistics.generated += 1;
            self.open.push(Reverse(OpenNode { key: key(to, g), g, at: to }));
            if seen.is_watching() {
                seen.generated(Side::Forward, map.cell(to), cells(g));
            }
        });
        Some(Expanded { at, g })
    }

    /// The cells from the root to `at`, both included, in `path` (which is cleared first).
    pub fn path_into(&self, map: &SearchMap, at: CellIndex, path: &mut Vec<crate::map::Cell>) {
        path.clear();
        let mut at = at;
        loop {
            path.push(map.cell(at));
            let parent = CellIndex((self.nodes[at.as_usize()][1] >> 32) as u32);
            if parent == at {
                break;
            }
            at = parent;
        }
        path.reverse();
    }

    /// The best entry of the open list that is not out of date.
    fn pop_current(&mut self) -> Option<OpenNode> {
        loop {
            let Reverse(node) = self.open.pop()?;
            let [g, state] = self.nodes[node.at.as_usize()];
            let is_open = state as u32 == self.epoch << 1;
            if is_open && g == node.g {
                return Some(node);
            }
        }
    }

    /// True when a node was not reached yet in this query, or is open at a larger cost.
    fn improves(&self, at: CellIndex, g: u64) -> bool {
        let [known, state] = self.nodes[at.as_usize()];
        let stamp = state as u32;
        stamp >> 1 != self.epoch || (stamp & 1 == 0 && g < known)
    }

    fn set(&mut self, at: CellIndex, g: u64, parent: CellIndex, closed: bool) {
        let stamp = self.epoch << 1 | u32::from(closed);
        self.nodes[at.as_usize()] = [g, u64::from(parent.0) << 32 | u64::from(stamp)];
    }
}

/// A fixed-point cost in cells, for observers.
fn cells(g: u64) -> f64 {
    g as f64 / super::Cost::KEY_STRAIGHT as f64
}
