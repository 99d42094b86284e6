//! The nodes and the open list of a jump point search.

use super::bucket_queue::BucketQueue;
use super::jump_points::{Arrival, Arrivals};
use super::node_pages::NodePages;
use crate::map::{CellIndex, SearchMap};
use crate::search::{Cost, SearchMemory, SideStatistics};

/// Nodes with path cost, parent and the directions from which they were reached: those still to be
/// expanded and those already expanded.
///
/// 16 bytes: g, and parent << 32 | epoch << 8 | done << 4 | pending. A node that is improved after
/// its expansion is expanded again.
#[derive(Clone, Debug, Default)]
pub(super) struct JumpNodes {
    nodes: NodePages,
    open: BucketQueue,
    /// Cost of the best path to the goal so far, and the last node before the goal.
    solution: Option<(u64, CellIndex)>,
    statistics: SideStatistics,
}

/// Most queries need no more; a fleet of robots pays for them once per robot.
const MOST_WARM_NODES: usize = 1 << 15;
const PENDING: u64 = 0x0f;
const DONE: u64 = 0xf0;
const EPOCH_SHIFT: u32 = 8;
const _: () = assert!(NodePages::EPOCH_BITS + EPOCH_SHIFT == 32);

/// A node to be expanded.
#[derive(Clone, Copy, Debug)]
pub(super) struct JumpNode {
    pub(super) index: CellIndex,
    pub(super) g: u64,
    /// Directions of arrival that have not been expanded yet; none for the root.
    pub(super) arrivals: Arrivals,
}

impl JumpNodes {
    /// Touches the memory that most queries on a map need.
    pub(super) fn warm_up(&mut self, map: &SearchMap) {
        let cells = map.index_count();
        self.nodes.warm_up(cells, (cells / 16).min(MOST_WARM_NODES));
        self.open.warm_up(cells / 8, (cells / 128).min(MOST_WARM_NODES / 8));
    }

    /// Clears the last query and inserts `root` into the open list; `key` is its estimate.
    pub(super) fn start(&mut self, map: &SearchMap, root: CellIndex, key: u64) {
        self.nodes.start(map.index_count());
        // A leg is no longer than the two sides of the map, and with a consistent estimate f rises
        // by no more than twice its length.
        let sides = u64::from(map.frame().width()) + u64::from(map.frame().height());
        self.open.start(key, 2 * sides * Cost::KEY_STRAIGHT, map.index_count() / 8);
        self.solution = None;
        self.statistics = SideStatistics { expanded: 0, generated: 1 };
        let stamp = self.stamp();
        *self.nodes.touch(root.as_usize()) = [0, u64::from(root.0) << 32 | stamp];
        self.open.push(key, root.0);
    }

    /// Counters since [`Self::start`].
    pub(super) const fn statistics(&self) -> SideStatistics {
        self.statistics
    }

    /// Takes a node from the lowest bucket of the open list. `None` if no node can lead to a
    /// better solution.
    pub(super) fn expand_best(&mut self, estimate: impl Fn(CellIndex) -> u64) -> Option<JumpNode> {
        loop {
            let index = CellIndex(self.open.pop()?);
            let [g, state] = self.nodes.touch(index.as_usize());
            let pending = *state & PENDING;
            let is_root = (*state >> 32) as u32 == index.0;
            if let Some((best, _)) = self.solution {
                if self.open.is_past(best) {
                    return None;
                }
                if *g + estimate(index) >= best {
                    continue;
                }
            }
            // Already expanded through another entry, and not improved since.
            if pending == 0 && !is_root {
                continue;
            }
            *state = (*state & !PENDING) | pending << 4;
            self.statistics.expanded += 1;
            return Some(JumpNode { index, g: *g, arrivals: pending as Arrivals });
        }
    }

    /// Records a path to a node. Returns the lowest known path cost of the node, and true if it
    /// was put into the open list.
    pub(super) fn generate(
        &mut self,
        to: CellIndex,
        g: u64,
        parent: CellIndex,
        arrival: Arrival,
        estimate: u64,
    ) -> (u64, bool) {
        let stamp = self.stamp();
        let direction = 1_u64 << arrival;
        let [known, state] = self.nodes.touch(to.as_usize());
        let is_reached = *state as u32 >> EPOCH_SHIFT == stamp as u32 >> EPOCH_SHIFT;
        if is_reached && *known < g {
            return (*known, false);
        }
        if is_reached && *known == g {
            // Another shortest path: continue in its directions as well.
            let seen = (*state & PENDING) | (*state & DONE) >> 4;
            let is_root = (*state >> 32) as u32 == to.0;
            let was_open = *state & PENDING != 0;
            if seen & direction != 0 || is_root {
                return (g, false);
            }
            *state |= direction;
            if was_open {
                return (g, false);
            }
        } else {
            *known = g;
            *state = u64::from(parent.0) << 32 | stamp | direction;
        }
        // A node that cannot improve the solution is not needed.
        let is_useful = self.solution.is_none_or(|(best, _)| g + estimate < best);
        if is_useful {
            self.statistics.generated += 1;
            self.open.push(g + estimate, to.0);
        }
        (g, is_useful)
    }

    /// Records a path to the goal; true if it is the best so far.
    pub(super) fn reach_goal(&mut self, g: u64, parent: CellIndex) -> bool {
        let is_best = self.solution.is_none_or(|(best, _)| g < best);
        if is_best {
            self.statistics.generated += 1;
            self.solution = Some((g, parent));
        }
        is_best
    }

    /// The last node before the goal on the best path.
    pub(super) fn last_before_goal(&self) -> Option<CellIndex> {
        self.solution.map(|(_, parent)| parent)
    }

    /// The parent of a node; `None` for the root.
    pub(super) fn parent(&self, at: CellIndex) -> Option<CellIndex> {
        let parent = CellIndex((self.nodes.touched(at.as_usize())[1] >> 32) as u32);
        (parent != at).then_some(parent)
    }

    fn stamp(&self) -> u64 {
        u64::from(self.nodes.epoch() << EPOCH_SHIFT)
    }
}

impl SearchMemory for JumpNodes {
    fn memory_bytes(&self) -> usize {
        self.nodes.memory_bytes() + self.open.memory_bytes()
    }
}
