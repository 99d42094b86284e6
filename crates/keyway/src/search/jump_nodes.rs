//! The nodes and the open list of a jump point search.

use super::{Arrival, SearchStatistics};
use crate::map::{CellIndex, SearchMap};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Nodes carry, beside path cost and parent, the directions from which they were reached: those
/// still to be expanded and those that were.
///
/// 16 bytes per cell: g, and parent << 32 | epoch << 8 | done << 4 | pending. Nothing is cleared
/// between queries, and pages that no query touches are never touched.
#[derive(Clone, Debug, Default)]
pub struct JumpNodes {
    nodes: Vec<[u64; 2]>,
    epoch: u32,
    /// Key, then larger g (as its complement), then lower index.
    open: BinaryHeap<Reverse<(u64, u64, CellIndex)>>,
    statistics: SearchStatistics,
}

const PENDING: u64 = 0x0f;
const DONE: u64 = 0xf0;
const EPOCH_SHIFT: u32 = 8;
const MAX_EPOCH: u32 = (1 << 24) - 1;

impl JumpNodes {
    /// Forgets the last query and puts `root` into the open list.
    pub(crate) fn start(&mut self, map: &SearchMap, root: CellIndex, key: u64) {
        if self.nodes.len() != map.index_count() || self.epoch == MAX_EPOCH {
            self.nodes = vec![[0; 2]; map.index_count()];
            self.epoch = 0;
        }
        self.epoch += 1;
        self.open.clear();
        self.statistics = SearchStatistics { expanded: 0, generated: 1 };
        self.nodes[root.as_usize()] = [0, u64::from(root.0) << 32 | self.stamp()];
        self.open.push(Reverse((key, u64::MAX, root)));
    }

    /// What was done since [`Self::start`].
    pub(crate) const fn statistics(&self) -> SearchStatistics {
        self.statistics
    }

    /// Heap bytes that are held.
    pub(crate) fn memory_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<[u64; 2]>()
            + self.open.capacity() * size_of::<Reverse<(u64, u64, CellIndex)>>()
    }

    /// Takes the best node from the open list: its index, its path cost, and the directions of
    /// arrival that are to be expanded (none for the root).
    pub(crate) fn expand_best(&mut self) -> Option<(CellIndex, u64, u8)> {
        loop {
            let Reverse((_, complement, at)) = self.open.pop()?;
            let [g, state] = &mut self.nodes[at.as_usize()];
            let pending = *state & PENDING;
            let is_root = (*state >> 32) as u32 == at.0;
            // Out of date: improved since, or expanded by an entry of equal cost.
            if *g != !complement || (pending == 0 && !is_root) {
                continue;
            }
            *state = (*state & !PENDING) | pending << 4;
            self.statistics.expanded += 1;
            return Some((at, *g, pending as u8));
        }
    }

    /// Records a way to a node; true when it is better than any before, or equal from a new
    /// direction.
    pub(crate) fn generate(
        &mut self,
        to: CellIndex,
        g: u64,
        parent: CellIndex,
        arrival: Arrival,
        estimate: u64,
    ) -> bool {
        let stamp = self.stamp();
        let direction = 1_u64 << arrival;
        let [known, state] = &mut self.nodes[to.as_usize()];
        let is_reached = *state as u32 >> EPOCH_SHIFT == stamp as u32 >> EPOCH_SHIFT;
        if is_reached && *known == g {
            // Another shortest way: go on in its directions as well.
            let seen = (*state & PENDING) | (*state & DONE) >> 4;
            if seen & direction != 0 || (*state >> 32) as u32 == to.0 {
                return false;
            }
            let was_open = *state & PENDING != 0;
            *state |= direction;
            if was_open {
                return false;
            }
        } else if is_reached && *known < g {
            return false;
        } else {
            *known = g;
            *state = u64::from(parent.0) << 32 | stamp | direction;
        }
        self.statistics.generated += 1;
        self.open.push(Reverse((g + estimate, !g, to)));
        true
    }

    /// Where the way to a node comes from; `None` for the root.
    pub(crate) fn parent(&self, at: CellIndex) -> Option<CellIndex> {
        let parent = CellIndex((self.nodes[at.as_usize()][1] >> 32) as u32);
        (parent != at).then_some(parent)
    }

    fn stamp(&self) -> u64 {
        u64::from(self.epoch << EPOCH_SHIFT)
    }
}
