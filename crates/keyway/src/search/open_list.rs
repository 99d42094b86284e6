//! The open list of a search: a priority queue of nodes in a total order.

use super::buckets::Buckets;
use crate::map::CellIndex;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Nodes to be expanded, ordered by key, then larger g, then lower cell index.
///
/// An entry is one 128-bit number, so that a comparison is one operation: the key, then g from
/// large to small in units of 2^20 (of a [`super::Cost::key`]: 1/89 of a cell), then the index.
/// Equal keys whose g differ by less than such a unit are ordered by index.
///
/// Keys hardly ever decrease during a search, and about half of the entries are never taken out.
/// So only entries with keys up to a *horizon* are kept in a heap, which stays small. The others
/// wait unsorted in buckets of equal width (a ring) until the horizon reaches them; those too far
/// ahead wait in one list. Whatever the keys are, entries leave in exact order: all keys in the
/// heap lie below the horizon and all others beyond.
///
/// Entries are never changed. An improved node is reinserted, and [`Entry::has_g`] detects its
/// outdated entries when they are taken out.
#[derive(Clone, Debug)]
pub(crate) struct OpenList {
    /// Entries of buckets up to `horizon`.
    near: BinaryHeap<Reverse<u128>>,
    /// The entries of bucket b at b % [`Self::BUCKETS`], for the buckets after `horizon`.
    buckets: Buckets,
    /// A bit for every bucket that is not empty.
    filled: [u64; Self::BUCKETS / 64],
    /// Entries beyond all buckets.
    far: Vec<Reverse<u128>>,
    /// Number of the first bucket in `far`.
    first_far: u64,
    /// Number of the last bucket in the heap.
    horizon: u64,
    len: usize,
}

/// An entry of an [`OpenList`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Entry(u128);

impl Entry {
    /// The low bits of g that are ignored in the order.
    const G_UNIT_BITS: u32 = 20;

    fn new(at: CellIndex, g: u64, key: u64) -> Self {
        Self(u128::from(key) << 64 | u128::from(Self::rank(g)) << 32 | u128::from(at.0))
    }

    /// Smaller for larger g; the same for all g beyond 48 million cells.
    fn rank(g: u64) -> u32 {
        !u32::try_from(g >> Self::G_UNIT_BITS).unwrap_or(u32::MAX)
    }

    /// The cell of the node.
    pub(crate) const fn at(self) -> CellIndex {
        CellIndex(self.0 as u32)
    }

    /// The primary order.
    pub(crate) const fn key(self) -> u64 {
        (self.0 >> 64) as u64
    }

    /// False if the entry was inserted with another g.
    pub(crate) fn has_g(self, g: u64) -> bool {
        (self.0 >> 32) as u32 == Self::rank(g)
    }
}

impl Default for OpenList {
    fn default() -> Self {
        Self {
            near: BinaryHeap::new(),
            buckets: Buckets::default(),
            filled: [0; Self::BUCKETS / 64],
            far: Vec::new(),
            first_far: u64::MAX,
            horizon: 0,
            len: 0,
        }
    }
}

impl OpenList {
    /// Number of buckets in the ring.
    const BUCKETS: usize = 1024;
    /// Width of a bucket, as a power of two: 1/44 of a cell, so that most buckets hold one value of
    /// f; all buckets together span 23 cells, more than a step adds to f (2.8 without penalties).
    const WIDTH_BITS: u32 = 21;

    const fn bucket(key: u64) -> u64 {
        key >> Self::WIDTH_BITS
    }

    /// Clears the list and keeps its memory.
    pub(crate) fn clear(&mut self) {
        self.near.clear();
        while let Some(slot) = self.next_filled(0) {
            self.buckets.clear(slot);
            self.filled[slot / 64] &= !(1 << (slot % 64));
        }
        self.far.clear();
        self.first_far = u64::MAX;
        self.len = 0;
    }

    /// Inserts a node. O(1) beyond the horizon, else O(log n) for n entries in the heap. An entry
    /// too far ahead for the buckets is checked again after each turn of the ring.
    pub(crate) fn push(&mut self, at: CellIndex, g: u64, key: u64) {
        if self.len == 0 {
            self.horizon = Self::bucket(key);
            self.buckets.provide(Self::BUCKETS);
        }
        self.len += 1;
        // All entries may end up in the heap: its capacity is the largest number of entries so
        // far.
        if self.len > self.near.capacity() {
            self.near.reserve(self.len - self.near.len());
        }
        self.place(Entry::new(at, g, key));
    }

    fn place(&mut self, entry: Entry) {
        let bucket = Self::bucket(entry.key());
        if bucket <= self.horizon {
            self.near.push(Reverse(entry.0));
        } else if bucket - self.horizon < Self::BUCKETS as u64 {
            let slot = bucket as usize % Self::BUCKETS;
            self.buckets.push(slot, entry.0);
            self.filled[slot / 64] |= 1 << (slot % 64);
        } else {
            self.far.push(Reverse(entry.0));
            self.first_far = self.first_far.min(bucket);
        }
    }

    /// Takes out the first entry.
    pub(crate) fn pop(&mut self) -> Option<Entry> {
        if self.near.is_empty() {
            self.advance();
        }
        let Reverse(entry) = self.near.pop()?;
        self.len -= 1;
        Some(Entry(entry))
    }

    /// The first entry, which stays in the list.
    pub(crate) fn peek(&mut self) -> Option<Entry> {
        if self.near.is_empty() {
            self.advance();
        }
        self.near.peek().map(|&Reverse(entry)| Entry(entry))
    }

    /// Moves the horizon to the first non-empty bucket behind it; the heap must be empty.
    fn advance(&mut self) {
        let next = self.next_bucket();
        let first = next.unwrap_or(u64::MAX).min(self.first_far);
        if first == u64::MAX {
            return;
        }
        self.horizon = first;
        if next == Some(first) {
            let slot = first as usize % Self::BUCKETS;
            self.filled[slot / 64] &= !(1 << (slot % 64));
            self.near.extend(self.buckets.entries(slot).map(Reverse));
            self.buckets.clear(slot);
        }
        if self.first_far == first {
            self.sort_in_far();
        }
    }

    /// Moves the far entries that are now within the ring to the heap and the buckets.
    fn sort_in_far(&mut self) {
        self.first_far = u64::MAX;
        let mut i = 0;
        while i < self.far.len() {
            let Reverse(entry) = self.far[i];
            let bucket = Self::bucket(Entry(entry).key());
            if bucket - self.horizon < Self::BUCKETS as u64 {
                self.far.swap_remove(i);
                self.place(Entry(entry));
            } else {
                self.first_far = self.first_far.min(bucket);
                i += 1;
            }
        }
    }

    /// The number of the first non-empty bucket after the horizon.
    fn next_bucket(&self) -> Option<u64> {
        let next = self.horizon + 1;
        let from = next as usize % Self::BUCKETS;
        let slot = self.next_filled(from).or_else(|| self.next_filled(0))?;
        Some(next + ((slot + Self::BUCKETS - from) % Self::BUCKETS) as u64)
    }

    /// The first non-empty bucket from a slot to the end of the ring.
    fn next_filled(&self, from: usize) -> Option<usize> {
        let first = self.filled[from / 64] & u64::MAX << (from % 64);
        let words = self.filled[from / 64 + 1..].iter().copied();
        let (word, bits) =
            (from / 64..).zip(std::iter::once(first).chain(words)).find(|&(_, bits)| bits != 0)?;
        Some(word * 64 + bits.trailing_zeros() as usize)
    }

    /// The number of entries, outdated ones included.
    pub(crate) const fn len(&self) -> usize {
        self.len
    }

    /// Memory on the heap \[bytes\].
    pub(crate) fn memory_bytes(&self) -> usize {
        size_of::<Reverse<u128>>() * (self.near.capacity() + self.far.capacity())
            + self.buckets.memory_bytes()
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

    /// All kinds of keys: near the last one taken out, in the buckets, far ahead, and behind.
    fn any_key_offset() -> impl Strategy<Value = i64> {
        prop_oneof![
            4 => 0i64..1 << 22,
            4 => 0i64..1 << 31,
            2 => 0i64..1 << 34,
            1 => -(1i64 << 33)..0,
            1 => Just(0),
            1 => Just(1 << 31),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

        #[test]
        fn entries_come_in_order(steps in prop::collection::vec(
            (any_key_offset(), 0u64..4, 0u32..50, any::<bool>()), 1..300)) {
            let mut open = OpenList::default();
            // The list is cleared and reused.
            for _ in 0..2 {
                let mut expected = BinaryHeap::new();
                let mut last = 1i64 << 40;
                for &(offset, g, at, takes) in &steps {
                    let key = (last + offset) as u64;
                    open.push(CellIndex(at), g << 20, key);
                    expected.push(Reverse((key, Reverse(g), at)));
                    if takes {
                        let Reverse((key, _, at)) = expected.pop().unwrap();
                        prop_assert_eq!(open.peek().map(Entry::key), Some(key));
                        let taken = open.pop().map(|entry| (entry.key(), entry.at().0));
                        prop_assert_eq!(taken, Some((key, at)));
                        last = last.max(key as i64);
                    }
                    prop_assert_eq!(open.len(), expected.len());
                }
                // Half of the remaining entries are taken in order; the rest is dropped.
                for _ in 0..expected.len() / 2 {
                    let Reverse((key, _, at)) = expected.pop().unwrap();
                    let taken = open.pop().map(|entry| (entry.key(), entry.at().0));
                    prop_assert_eq!(taken, Some((key, at)));
                }
                open.clear();
                prop_assert!(open.len() == 0 && open.peek().is_none());
            }
        }
    }
}
