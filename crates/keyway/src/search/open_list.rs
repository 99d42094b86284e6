//! The open list of a search: a queue of nodes in a total order.

use crate::map::CellIndex;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Nodes to be expanded, ordered by key, then larger g, then lower cell index.
///
/// An entry is one 128-bit number, so that comparing two is one operation: the key, then g from large
/// to small in units of 2^20 (of a [`super::Cost::key`]: 1/89 of a cell), then the index. Equal keys
/// whose g differ by less than such a unit are ordered by index.
///
/// Entries are never changed. A node that is improved is put in again, and who takes an entry out
/// sees by [`Entry::has_g`] that it is out of date.
#[derive(Clone, Debug, Default)]
pub struct OpenList {
    heap: BinaryHeap<Reverse<u128>>,
}

/// What was put into an [`OpenList`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry(u128);

impl Entry {
    /// Bits of g that do not take part in the order.
    const G_UNIT_BITS: u32 = 20;

    fn new(at: CellIndex, g: u64, key: u64) -> Self {
        Self(u128::from(key) << 64 | u128::from(Self::rank(g)) << 32 | u128::from(at.0))
    }

    /// Smaller for larger g; the same for all g beyond 48 million cells.
    fn rank(g: u64) -> u32 {
        !u32::try_from(g >> Self::G_UNIT_BITS).unwrap_or(u32::MAX)
    }

    /// The cell.
    pub const fn at(self) -> CellIndex {
        CellIndex(self.0 as u32)
    }

    /// The value by which it is ordered first.
    pub const fn key(self) -> u64 {
        (self.0 >> 64) as u64
    }

    /// False when it was put in with another g.
    pub fn has_g(self, g: u64) -> bool {
        (self.0 >> 32) as u32 == Self::rank(g)
    }
}

impl OpenList {
    /// Empties the list, keeping its memory.
    pub fn clear(&mut self) {
        self.heap.clear();
    }

    /// Puts a node in. O(log n) at worst, O(1) on average over random keys.
    pub fn push(&mut self, at: CellIndex, g: u64, key: u64) {
        self.heap.push(Reverse(Entry::new(at, g, key).0));
    }

    /// Takes the first entry out. O(log n).
    pub fn pop(&mut self) -> Option<Entry> {
        self.heap.pop().map(|Reverse(entry)| Entry(entry))
    }

    /// The first entry.
    pub fn peek(&self) -> Option<Entry> {
        self.heap.peek().map(|&Reverse(entry)| Entry(entry))
    }

    /// Entries, those out of date included.
    pub fn len(&self) -> usize {
        self.heap.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.heap.is_empty()
    }

    /// Memory on the heap \[bytes\].
    pub fn memory_bytes(&self) -> usize {
        size_of::<Reverse<u128>>() * self.heap.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::Cost;
    use proptest::prelude::*;

    #[test]
    fn key_then_larger_g_then_lower_index() {
        let cells = |count: u64| count * Cost::KEY_STRAIGHT;
        let mut open = OpenList::default();
        for (at, g, key) in
            [(1, cells(9), cells(5)), (7, cells(2), cells(4)), (3, cells(2), cells(4))]
        {
            open.push(CellIndex(at), g, key);
        }
        open.push(CellIndex(9), cells(3), cells(4));
        open.push(CellIndex(4), cells(8), 0);
        let order: Vec<u32> = std::iter::from_fn(|| open.pop()).map(|entry| entry.at().0).collect();
        assert_eq!(order, [4, 9, 3, 7, 1]);
    }

    #[test]
    fn an_entry_knows_its_g() {
        let entry = Entry::new(CellIndex(u32::MAX), Cost::new(3, 0).key(), u64::MAX);
        assert_eq!((entry.at(), entry.key()), (CellIndex(u32::MAX), u64::MAX));
        assert!(entry.has_g(Cost::new(3, 0).key()) && !entry.has_g(Cost::new(0, 2).key()));
        let beyond = Entry::new(CellIndex(0), u64::MAX, 0);
        assert!(beyond.has_g(u64::MAX - 1));
    }

    proptest! {
        #[test]
        fn entries_come_in_order(keys in prop::collection::vec((0u32..50, 0u64..9, 0u64..9), 1..200)) {
            let mut open = OpenList::default();
            let mut sorted: Vec<(u64, Reverse<u64>, u32)> = Vec::new();
            for (at, g, key) in keys {
                open.push(CellIndex(at), g << 20, key);
                sorted.push((key, Reverse(g), at));
            }
            sorted.sort_unstable();
            let expected: Vec<(u64, u32)> = sorted.iter().map(|&(key, _, at)| (key, at)).collect();
            let taken: Vec<(u64, u32)> = std::iter::from_fn(|| open.pop())
                .map(|entry| (entry.key(), entry.at().0)).collect();
            prop_assert_eq!(taken, expected);
        }
    }
}
