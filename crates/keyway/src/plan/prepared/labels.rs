//! Hub labels \[Abraham2012\], built by pruned searches \[Akiba2013\].
//!
//! A label of a node lists some nodes, its hubs, with their distances. Any two labels have a hub
//! in common that lies on a shortest path between their nodes. The distance of two nodes is then
//! the smallest sum over their common hubs: no search, only two short lists.
//!
//! Each node in turn, the most important one first, is entered as a hub at all nodes that a search
//! from it reaches. The search is pruned where the existing labels give the same or a smaller
//! distance.

use super::PrepareError;
use super::graph::Edge;
use crate::map::Cell;
use crate::search::Cost;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A hub and the exact cost to it in 64 bits: hub << 40 | straight steps << 20 | diagonal steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry(pub(super) u64);

/// The exclusive limits of hub numbers and of both step counts.
pub(super) const MAX_HUBS: u64 = 1 << 24;
const MAX_STEPS: u64 = 1 << STEP_BITS;
const STEP_BITS: u32 = 20;

impl Entry {
    /// `None` if a number does not fit.
    pub(super) fn new(hub: u32, cost: Cost) -> Option<Self> {
        let fits = u64::from(hub) < MAX_HUBS && cost.straight.max(cost.diagonal) < MAX_STEPS;
        let packed = u64::from(hub) << (2 * STEP_BITS) | cost.straight << STEP_BITS | cost.diagonal;
        fits.then_some(Self(packed))
    }

    pub(super) const fn hub(self) -> u32 {
        (self.0 >> (2 * STEP_BITS)) as u32
    }

    pub(super) const fn cost(self) -> Cost {
        Cost::new(self.0 >> STEP_BITS & (MAX_STEPS - 1), self.0 & (MAX_STEPS - 1))
    }

    pub(super) const fn key(self) -> u64 {
        self.cost().key()
    }
}

/// The labels of all nodes. Nodes are numbered by importance, 0 the most important; hubs are in
/// this order, so that the last one of a label is the node itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Labels {
    /// The first entry of each node's label, followed by the end of the last label.
    pub(super) first: Vec<u32>,
    pub(super) entries: Vec<Entry>,
    /// For each entry the first leg of the path to its hub.
    pub(super) hops: Vec<Hop>,
}

/// The first leg of the path to a hub, in 32 bits: next << 3 | octant. `next` is the index, among
/// all entries, of the entry for the same hub in the label of the next node; `octant` is the
/// octant in which that node lies. The difference of the two entries gives the length of the leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hop(pub(super) u32);

impl Hop {
    pub(super) const MAX_ENTRIES: usize = 1 << 29;

    fn new(next: u32, octant: u8) -> Self {
        Self(next << 3 | u32::from(octant))
    }

    pub(super) const fn next(self) -> usize {
        (self.0 >> 3) as usize
    }

    pub(super) const fn octant(self) -> u8 {
        self.0 as u8 & 7
    }
}

/// The octant in which `to` lies from `from`: bit 0 is set towards west, bit 1 towards south, bit
/// 2 if the row distance exceeds the column distance.
pub(super) fn octant(from: Cell, to: Cell) -> u8 {
    let steep = from.y.abs_diff(to.y) > from.x.abs_diff(to.x);
    u8::from(to.x < from.x) | u8::from(to.y < from.y) << 1 | u8::from(steep) << 2
}

impl Labels {
    /// Builds the labels of a graph whose nodes are numbered by importance and lie at `cells`.
    ///
    /// # Errors
    /// Returns an error if a path is too long for an [`Entry`], or there are too many entries; and
    /// those of `progress`.
    pub(super) fn new(
        graph: &[Vec<Edge>],
        cells: &[Cell],
        mut progress: impl FnMut(usize) -> Result<(), PrepareError>,
    ) -> Result<Self, PrepareError> {
        let mut search = LabelSearch::new(graph.len());
        let mut labels = vec![Label::default(); graph.len()];
        for hub in 0..graph.len() as u32 {
            search.enter(hub, graph, cells, &mut labels)?;
            if search.entered > Hop::MAX_ENTRIES {
                return Err(PrepareError::TooManyEntries { limit: Hop::MAX_ENTRIES as u64 });
            }
            progress(hub as usize + 1)?;
        }
        Ok(Self::joined(labels, cells))
    }

    fn joined(labels: Vec<Label>, cells: &[Cell]) -> Self {
        let mut first = Vec::with_capacity(labels.len() + 1);
        let mut count = 0;
        first.push(0);
        for label in &labels {
            count += label.entries.len();
            first.push(count as u32);
        }
        let (mut entries, mut hops) = (Vec::with_capacity(count), Vec::with_capacity(count));
        // Each label is dropped as soon as it is copied.
        for (label, &cell) in labels.into_iter().zip(cells) {
            entries.extend(label.entries);
            hops.extend(label.next.iter().map(|next| {
                Hop::new(
                    first[next.node as usize] + next.place,
                    octant(cell, cells[next.node as usize]),
                )
            }));
        }
        Self { first, entries, hops }
    }

    /// The label of a node.
    pub(super) fn of(&self, node: u32) -> &[Entry] {
        let node = node as usize;
        &self.entries[self.first[node] as usize..self.first[node + 1] as usize]
    }

    /// The index of a node's entry for a hub, among all entries.
    pub(super) fn place(&self, node: u32, hub: u32) -> Option<usize> {
        let i = self.of(node).binary_search_by_key(&hub, |entry| entry.hub()).ok()?;
        Some(self.first[node as usize] as usize + i)
    }

    /// The length of the shortest path between two nodes, as a [`Cost::key`], and the first hub on
    /// it; `None` if there is none.
    pub(super) fn distance(&self, a: u32, b: u32) -> Option<(u64, u32)> {
        let (mut a, mut b) = (self.of(a).iter().peekable(), self.of(b).iter().peekable());
        let mut best = None;
        while let (Some(&&one), Some(&&other)) = (a.peek(), b.peek()) {
            if one.hub() == other.hub() {
                let key = one.key() + other.key();
                let through = (key, one.hub());
                best = Some(best.map_or(through, |best: (u64, u32)| best.min(through)));
            }
            if one.hub() <= other.hub() {
                a.next();
            }
            if other.hub() <= one.hub() {
                b.next();
            }
        }
        best
    }

    pub(super) fn memory_bytes(&self) -> usize {
        let numbers = self.first.capacity() + self.hops.capacity();
        numbers * size_of::<u32>() + self.entries.capacity() * size_of::<Entry>()
    }
}

/// A label under construction.
#[derive(Clone, Debug, Default)]
struct Label {
    entries: Vec<Entry>,
    next: Vec<Next>,
}

/// The next node on the path to a hub, and the hub's index in that node's label.
#[derive(Clone, Copy, Debug, Default)]
struct Next {
    node: u32,
    place: u32,
}

/// Memory of the searches.
struct LabelSearch {
    /// The distances of the current hub to its own hubs, `u64::MAX` for all others.
    from_hub: Vec<u64>,
    reached: Vec<Reached>,
    open: BinaryHeap<Reverse<(u64, u32)>>,
    /// Entries of all labels so far.
    entered: usize,
}

/// The path by which a node was reached from a hub.
#[derive(Clone, Copy)]
struct Reached {
    key: u64,
    cost: Cost,
    hub: u32,
    next: Next,
}

impl LabelSearch {
    fn new(nodes: usize) -> Self {
        let nothing =
            Reached { key: 0, cost: Cost::default(), hub: u32::MAX, next: Next::default() };
        Self {
            from_hub: vec![u64::MAX; nodes],
            reached: vec![nothing; nodes],
            open: BinaryHeap::new(),
            entered: 0,
        }
    }

    /// Enters `hub` into the labels of all nodes whose distance to it no earlier hub gives.
    fn enter(
        &mut self,
        hub: u32,
        graph: &[Vec<Edge>],
        cells: &[Cell],
        labels: &mut [Label],
    ) -> Result<(), PrepareError> {
        for entry in &labels[hub as usize].entries {
            self.from_hub[entry.hub() as usize] = entry.key();
        }
        let next = Next { node: hub, place: labels[hub as usize].entries.len() as u32 };
        self.reached[hub as usize] = Reached { key: 0, cost: Cost::default(), hub, next };
        self.open.push(Reverse((0, hub)));
        while let Some(Reverse((key, at))) = self.open.pop() {
            let Reached { key: known, cost, next, .. } = self.reached[at as usize];
            let label = &mut labels[at as usize];
            if key > known || self.is_known(&label.entries, key) {
                continue;
            }
            let entry = Entry::new(hub, cost).ok_or(PrepareError::TooLong { cost })?;
            label.entries.push(entry);
            label.next.push(next);
            self.entered += 1;
            let next = Next { node: at, place: label.entries.len() as u32 - 1 };
            self.relax(hub, next, graph, cells);
        }
        for entry in &labels[hub as usize].entries {
            self.from_hub[entry.hub() as usize] = u64::MAX;
        }
        Ok(())
    }

    /// True if a hub common to both labels gives the distance, or a smaller one.
    fn is_known(&self, entries: &[Entry], key: u64) -> bool {
        let through =
            |entry: &Entry| self.from_hub[entry.hub() as usize].saturating_add(entry.key());
        entries.iter().any(|entry| through(entry) <= key)
    }

    fn relax(&mut self, hub: u32, next: Next, graph: &[Vec<Edge>], cells: &[Cell]) {
        let at = next.node;
        let from = self.reached[at as usize];
        // More important nodes are hubs already: distances beyond them are known.
        for edge in graph[at as usize].iter().filter(|edge| edge.to > hub) {
            let (to, here) = (cells[edge.to as usize], cells[at as usize]);
            let key = from.key + edge.key;
            let reached = &mut self.reached[edge.to as usize];
            if reached.hub != hub || key < reached.key {
                let step = Cost::octile(to.x.abs_diff(here.x), to.y.abs_diff(here.y));
                *reached = Reached { key, cost: from.cost + step, hub, next };
                self.open.push(Reverse((key, edge.to)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_holds_its_numbers_or_is_refused() {
        let most = (1 << 20) - 1;
        for (hub, straight, diagonal) in [(0, 0, 0), (1, 2, 3), ((1 << 24) - 1, most, most)] {
            let entry = Entry::new(hub, Cost::new(straight, diagonal)).unwrap();
            assert_eq!((entry.hub(), entry.cost()), (hub, Cost::new(straight, diagonal)));
        }
        assert_eq!(Entry::new(1 << 24, Cost::default()), None);
        assert_eq!(Entry::new(0, Cost::new(1 << 20, 0)), None);
        assert_eq!(Entry::new(0, Cost::new(0, 1 << 20)), None);
    }

    /// Nodes at random cells, some of them joined: labels compared with the relaxation of all
    /// pairs.
    #[test]
    fn labels_give_all_distances() {
        let mut state = 88_172_645_463_325_252_u64;
        let mut below = |limit: u64| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state % limit
        };
        for _ in 0..40 {
            let count = 2 + below(25) as usize;
            let cell = |at: u64| Cell::new((at % 50) as i32, (at / 50) as i32);
            let cells: Vec<Cell> = (0..count).map(|_| cell(below(2500))).collect();
            let mut truth = vec![vec![u64::MAX / 4; count]; count];
            let mut graph = vec![Vec::new(); count];
            for (a, b) in (1..count).flat_map(|b| (0..b).map(move |a| (a, b))) {
                let apart = (cells[a].x.abs_diff(cells[b].x), cells[a].y.abs_diff(cells[b].y));
                if apart != (0, 0) && below(4) == 0 {
                    let key = Cost::octile(apart.0, apart.1).key();
                    graph[a].push(Edge { to: b as u32, key });
                    graph[b].push(Edge { to: a as u32, key });
                    (truth[a][b], truth[b][a]) = (key, key);
                }
            }
            for (a, row) in truth.iter_mut().enumerate() {
                row[a] = 0;
            }
            for k in 0..count {
                let from_k = truth[k].clone();
                for row in &mut truth {
                    let to_k = row[k];
                    for (known, onward) in row.iter_mut().zip(&from_k) {
                        *known = (*known).min(to_k + onward);
                    }
                }
            }
            let labels = Labels::new(&graph, &cells, |_| Ok(())).unwrap();
            for (a, row) in truth.iter().enumerate() {
                for (b, &expected) in row.iter().enumerate() {
                    let found = labels.distance(a as u32, b as u32).map(|(key, _)| key);
                    assert_eq!(found, (expected < u64::MAX / 4).then_some(expected));
                }
            }
        }
    }
}
