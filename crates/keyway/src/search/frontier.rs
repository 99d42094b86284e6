//! One side of a best-first search.

use super::open_list::{Entry, OpenList};
use super::{GridStep, Observer, Rule, Side, SideStatistics, Successors};
use crate::map::{Cell, CellIndex, SearchMap};

/// A node that was just taken from the open list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Expanded {
    /// The cell.
    pub(crate) at: CellIndex,
    /// Its value g: for most rules the cost of its path, as a [`super::Cost::key`].
    pub(crate) g: u64,
}

/// The open list and the nodes of one side of a search.
///
/// The open list is ordered by key, then larger g, then lower cell index. Deletion is lazy: an
/// improved node is reinserted and the older entry is skipped. Nodes are 16 bytes in one array per
/// map. They carry the epoch of their query, so a new query clears nothing, and pages without
/// nodes are never touched.
///
/// A search takes the best node ([`Self::take_best`]) and inserts its successors: a one-sided
/// search inserts all of them ([`Self::expand`]), a bidirectional one selects them
/// ([`Self::offer`]).
#[derive(Clone, Debug, Default)]
pub(crate) struct Frontier {
    /// g, and parent << 32 | epoch << 1 | closed. Plain arrays, because only those are allocated
    /// as untouched zero pages.
    nodes: Vec<[u64; 2]>,
    epoch: u32,
    open: OpenList,
    /// Nodes whose keys are being renewed.
    renewed: Vec<CellIndex>,
    statistics: SideStatistics,
}

impl Frontier {
    const MAX_EPOCH: u32 = (1 << 31) - 1;

    /// Clears the last query and inserts `root` into the open list, with g = 0.
    pub(crate) fn start(&mut self, map: &SearchMap, root: CellIndex, key: u64) {
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
        self.statistics = SideStatistics { expanded: 0, generated: 1 };
        self.set(root, 0, root, false);
        self.open.push(root, 0, key);
    }

    /// Counters since [`Self::start`].
    pub(crate) const fn statistics(&self) -> SideStatistics {
        self.statistics
    }

    /// Memory on the heap \[bytes\].
    pub(crate) fn memory_bytes(&self) -> usize {
        let renewed = size_of::<CellIndex>() * self.renewed.capacity();
        size_of::<[u64; 2]>() * self.nodes.capacity() + self.open.memory_bytes() + renewed
    }

    /// The number of entries in the open list, outdated ones included.
    pub(crate) fn open_len(&self) -> usize {
        self.open.len()
    }

    /// Inserts the successors of a node that was just taken from the open list.
    pub(crate) fn expand(
        &mut self,
        map: &SearchMap,
        node: Expanded,
        successors: &impl Successors,
        rule: &impl Rule,
        seen: &mut impl Observer,
    ) {
        successors.for_each(node.at, |step| {
            if let Some(g) = self.offer(node, step, rule)
                && seen.is_watching()
            {
                let (at, parent) = (map.cell(step.to), map.cell(node.at));
                seen.generated(Side::Forward, at, parent, cells(g));
            }
        });
    }

    /// The smallest key in the open list; `None` if the list is empty. Nodes for which
    /// `is_dropped` holds are ignored and dropped.
    pub(crate) fn best_key(&mut self, is_dropped: impl Fn(CellIndex) -> bool) -> Option<u64> {
        loop {
            let entry = self.open.peek()?;
            if self.is_current(entry) && !is_dropped(entry.at()) {
                return Some(entry.key());
            }
            self.open.pop();
        }
    }

    /// Takes the best node from the open list and closes it; `None` if the list is empty.
    ///
    /// Closed nodes are not reopened unless the rule requires it: with a consistent key their path
    /// cost is final.
    pub(crate) fn take_best(&mut self) -> Option<Expanded> {
        loop {
            let entry = self.open.pop()?;
            if self.is_current(entry) {
                let at = entry.at();
                let [g, state] = self.nodes[at.as_usize()];
                self.nodes[at.as_usize()][1] = state | 1;
                self.statistics.expanded += 1;
                return Some(Expanded { at, g });
            }
        }
    }

    /// Records the path over `step` from an expanded node, if the rule prefers it to the known
    /// path. Returns the node's new value, or `None` if the known path is kept.
    pub(crate) fn offer<R: Rule>(
        &mut self,
        from: Expanded,
        step: GridStep,
        rule: &R,
    ) -> Option<u64> {
        let g = rule.value(from.g, step);
        let [known, state] = self.nodes[step.to.as_usize()];
        let is_reached = self.is_of_this_query(state);
        let is_closed = state & 1 == 1;
        let is_better = g < known || (R::TAKES_EQUAL && g == known && !is_closed);
        if is_reached && (!is_better || (is_closed && !rule.reopens())) {
            return None;
        }
        self.set(step.to, g, from.at, false);
        self.statistics.generated += 1;
        if !is_reached || g != known {
            // A closed node that was improved is reopened.
            self.open.push(step.to, g, rule.key(step.to, g));
        }
        Some(g)
    }

    /// Recomputes the keys of all open nodes. O(n log n) for n entries of the open list.
    pub(crate) fn renew_keys(&mut self, rule: &impl Rule) {
        while let Some(entry) = self.open.pop() {
            if self.is_current(entry) {
                self.renewed.push(entry.at());
            }
        }
        while let Some(at) = self.renewed.pop() {
            let g = self.nodes[at.as_usize()][0];
            self.open.push(at, g, rule.key(at, g));
        }
    }

    /// The value of a node that was reached in this query.
    pub(crate) fn value(&self, at: CellIndex) -> Option<u64> {
        let [g, state] = self.nodes[at.as_usize()];
        self.is_of_this_query(state).then_some(g)
    }

    /// The parent of a node that was reached in this query; the root is its own parent.
    pub(crate) fn parent(&self, at: CellIndex) -> CellIndex {
        CellIndex((self.nodes[at.as_usize()][1] >> 32) as u32)
    }

    /// The parent of a node that was reached in this query, with its g; the root is its own
    /// parent.
    pub(crate) fn came_from(&self, at: CellIndex) -> Expanded {
        let parent = self.parent(at);
        Expanded { at: parent, g: self.nodes[parent.as_usize()][0] }
    }

    /// Gives a closed node another parent, which must be closed, and the corresponding value.
    pub(crate) fn reparent(&mut self, at: CellIndex, parent: CellIndex, g: u64) {
        self.set(at, g, parent, true);
    }

    /// True if a node was taken from the open list in this query.
    pub(crate) fn is_closed(&self, at: CellIndex) -> bool {
        self.nodes[at.as_usize()][1] as u32 == self.epoch << 1 | 1
    }

    /// Writes the cells from the root to `at`, both included, to `path` (which is cleared first).
    pub(crate) fn path_into(&self, map: &SearchMap, at: CellIndex, path: &mut Vec<Cell>) {
        path.clear();
        self.append_path_back(map, at, path);
        path.reverse();
    }

    /// Appends the cells from `at` back to the root, both included, to `path`.
    pub(crate) fn append_path_back(&self, map: &SearchMap, at: CellIndex, path: &mut Vec<Cell>) {
        let mut at = at;
        loop {
            path.push(map.cell(at));
            let parent = self.parent(at);
            if parent == at {
                return;
            }
            at = parent;
        }
    }

    /// False for an entry whose node was closed or improved since its insertion.
    fn is_current(&self, entry: Entry) -> bool {
        let [g, state] = self.nodes[entry.at().as_usize()];
        state as u32 == self.epoch << 1 && entry.has_g(g)
    }

    fn is_of_this_query(&self, state: u64) -> bool {
        state as u32 >> 1 == self.epoch
    }

    fn set(&mut self, at: CellIndex, g: u64, parent: CellIndex, closed: bool) {
        let stamp = self.epoch << 1 | u32::from(closed);
        self.nodes[at.as_usize()] = [g, u64::from(parent.0) << 32 | u64::from(stamp)];
    }
}

/// Converts a fixed-point cost to cells, for observers.
pub(crate) fn cells(g: u64) -> f64 {
    g as f64 / super::Cost::KEY_STRAIGHT as f64
}
