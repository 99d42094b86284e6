//! One side of a best-first search.

use super::open_list::{Entry, OpenList};
use super::{GridStep, Observer, Rule, Side, SideStatistics, Successors};
use crate::map::{Cell, CellIndex, SearchMap};

/// The node that was just taken from the open list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Expanded {
    /// The cell.
    pub(crate) at: CellIndex,
    /// Its value, for most rules the cost of its path, as a [`super::Cost::key`].
    pub(crate) g: u64,
}

/// The open list and the nodes of one side of a search.
///
/// The open list is ordered by key, then larger g, then lower cell index, and dropped lazily: an
/// improved node is put in again and the older entry skipped. Nodes are 16 bytes in one array per
/// map; they carry the epoch of their query, so a new query clears nothing, and pages that no query
/// touches are never touched.
///
/// A search takes the best node ([`Self::take_best`]) and puts its successors in: a one-sided one
/// all of them ([`Self::expand`]), a bidirectional one those that it wants ([`Self::offer`]).
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

    /// Forgets the last query and puts `root` into the open list, with g = 0.
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

    /// What was done since [`Self::start`].
    pub(crate) const fn statistics(&self) -> SideStatistics {
        self.statistics
    }

    /// Memory on the heap \[bytes\].
    pub(crate) fn memory_bytes(&self) -> usize {
        let renewed = size_of::<CellIndex>() * self.renewed.capacity();
        size_of::<[u64; 2]>() * self.nodes.capacity() + self.open.memory_bytes() + renewed
    }

    /// Entries of the open list, those out of date included.
    pub(crate) fn open_len(&self) -> usize {
        self.open.len()
    }

    /// Puts the successors of a node that was just taken into the open list.
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

    /// The smallest key of the nodes in the open list, `None` when it is empty. Nodes for which
    /// `is_dropped` holds no longer count, and are dropped.
    pub(crate) fn best_key(&mut self, is_dropped: impl Fn(CellIndex) -> bool) -> Option<u64> {
        loop {
            let entry = self.open.peek()?;
            if self.is_current(entry) && !is_dropped(entry.at()) {
                return Some(entry.key());
            }
            self.open.pop();
        }
    }

    /// Takes the best node from the open list and closes it; `None` when the list is empty.
    ///
    /// Closed nodes are not opened again unless the rule says so: with a consistent key their path
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

    /// Records the way over `step` from an expanded node, if the rule prefers it to the one that is
    /// known. Returns the node's new value, or `None` when the known way stays.
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
            // A closed node that is better now is open again.
            self.open.push(step.to, g, rule.key(step.to, g));
        }
        Some(g)
    }

    /// Computes the keys of all open nodes again. O(n log n) for n entries of the open list.
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

    /// Where the known way to a node that was reached in this query comes from; the root is its own
    /// parent.
    pub(crate) fn parent(&self, at: CellIndex) -> CellIndex {
        CellIndex((self.nodes[at.as_usize()][1] >> 32) as u32)
    }

    /// The node that the known way to a node of this query comes from; the root comes from itself.
    pub(crate) fn came_from(&self, at: CellIndex) -> Expanded {
        let parent = self.parent(at);
        Expanded { at: parent, g: self.nodes[parent.as_usize()][0] }
    }

    /// Gives a closed node another parent, which must be closed, and the value that goes with it.
    pub(crate) fn reparent(&mut self, at: CellIndex, parent: CellIndex, g: u64) {
        self.set(at, g, parent, true);
    }

    /// True if a node was taken from the open list in this query.
    pub(crate) fn is_closed(&self, at: CellIndex) -> bool {
        self.nodes[at.as_usize()][1] as u32 == self.epoch << 1 | 1
    }

    /// The cells from the root to `at`, both included, in `path` (which is cleared first).
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

    /// False for an entry whose node was closed or improved since.
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

/// A fixed-point cost in cells, for observers.
pub(crate) fn cells(g: u64) -> f64 {
    g as f64 / super::Cost::KEY_STRAIGHT as f64
}
