//! An open list made of buckets.

use std::hint::black_box;

/// A priority queue of cell indices: entries with nearly equal keys share a bucket, and leave it
/// last in, first out.
///
/// Pushing and popping cost a few operations, whatever the size: in cluttered maps a jump point
/// search spends a third of its time in a binary or quaternary heap. In exchange, the entries of
/// one bucket are unordered. So a search must be able to expand a node again if a shorter path to
/// it is found, and must empty the bucket of its best solution before it stops; its results are
/// then still exact.
///
/// Keys must not be smaller than the bucket of the last popped entry, and must not exceed it by
/// more than the span given to [`Self::start`]. The buckets form a ring, which grows to the
/// largest range of keys that wait at a time. Their entries are linked lists in one array, whose
/// slots are reused.
#[derive(Clone, Debug, Default)]
pub(super) struct BucketQueue {
    /// First entry of each bucket's list; 0 marks the end.
    heads: Vec<u32>,
    /// Index of the cell, and the next entry of the list. Entry 0 is not used.
    entries: Vec<[u32; 2]>,
    /// First entry of the free list.
    unused: u32,
    /// Number of the bucket that is being emptied, and the highest one in use.
    current: u64,
    highest: u64,
    len: usize,
    /// Buckets are 2^shift wide.
    shift: u32,
}

impl BucketQueue {
    /// Width of a bucket, as a power of two, unless the ring would be too long.
    const SHIFT: u32 = 24;
    const MAX_BUCKETS: u64 = 1 << 22;
    /// Few queries need more; a longer ring would mostly be memory that must be cleared.
    const LEAST_BUCKETS: usize = 1 << 11;
    /// Keys of one bucket: about 0.18 cells in [`Cost::key`](crate::search::Cost::key) units.
    /// Measured: a quarter of that is as good; whole cells expand a seventh more nodes in clutter.
    #[cfg(test)]
    pub(super) const WIDTH: u64 = 1 << Self::SHIFT;

    /// Empties the queue. The first key will be `first`, and no key will exceed the last popped
    /// one by more than `span`. Reserves `capacity` entries, whose pages are not touched before
    /// use.
    pub(super) fn start(&mut self, first: u64, span: u64, capacity: usize) {
        self.clear();
        self.shift = Self::SHIFT;
        while span >> self.shift > Self::MAX_BUCKETS - 2 {
            self.shift += 1;
        }
        if self.heads.is_empty() {
            self.heads = vec![0; Self::LEAST_BUCKETS];
        }
        self.entries.clear();
        self.entries.reserve(capacity + 1);
        self.entries.push([0; 2]);
        self.unused = 0;
        self.len = 0;
        self.current = first >> self.shift;
        self.highest = self.current;
    }

    /// Touches the memory of queries with `touched` entries at a time, of `capacity`.
    pub(super) fn warm_up(&mut self, capacity: usize, touched: usize) {
        self.start(0, 0, capacity);
        black_box(&mut self.heads[..]).fill(0);
        self.entries.resize(touched + 1, [0; 2]);
        black_box(&mut self.entries).truncate(1);
    }

    /// Adds a cell.
    pub(super) fn push(&mut self, key: u64, index: u32) {
        let bucket = key >> self.shift;
        debug_assert!(bucket >= self.current && bucket - self.current < Self::MAX_BUCKETS);
        if bucket - self.current >= self.heads.len() as u64 {
            self.lengthen(bucket);
        }
        self.highest = self.highest.max(bucket);
        let slot = self.slot(bucket);
        let entry = [index, self.heads[slot]];
        self.heads[slot] = if self.unused == 0 {
            self.entries.push(entry);
            (self.entries.len() - 1) as u32
        } else {
            let place = self.unused;
            self.unused = self.entries[place as usize][1];
            self.entries[place as usize] = entry;
            place
        };
        self.len += 1;
    }

    /// Takes a cell of the lowest bucket.
    pub(super) fn pop(&mut self) -> Option<u32> {
        if self.len == 0 {
            return None;
        }
        let mut slot = self.slot(self.current);
        while self.heads[slot] == 0 {
            self.current += 1;
            slot = self.slot(self.current);
        }
        let place = self.heads[slot];
        let [index, next] = self.entries[place as usize];
        self.heads[slot] = next;
        self.entries[place as usize][1] = self.unused;
        self.unused = place;
        self.len -= 1;
        Some(index)
    }

    /// True if the last popped entry, and with it all others, lies above the bucket of this key.
    pub(super) const fn is_past(&self, key: u64) -> bool {
        self.current > key >> self.shift
    }

    /// Memory on the heap \[bytes\].
    pub(super) const fn memory_bytes(&self) -> usize {
        size_of::<u32>() * self.heads.capacity() + size_of::<[u32; 2]>() * self.entries.capacity()
    }

    /// Makes the ring long enough for a bucket.
    #[cold]
    #[inline(never)]
    fn lengthen(&mut self, bucket: u64) {
        let length = (bucket - self.current + 1).next_power_of_two() as usize;
        let mut heads = vec![0; length];
        for bucket in self.current..=self.highest {
            heads[bucket as usize & (length - 1)] = self.heads[self.slot(bucket)];
        }
        self.heads = heads;
    }

    /// Empties the buckets in use.
    fn clear(&mut self) {
        if self.len == 0 {
            return;
        }
        let (first, last) = (self.slot(self.current), self.slot(self.highest));
        if first <= last {
            self.heads[first..=last].fill(0);
        } else {
            self.heads[..=last].fill(0);
            self.heads[first..].fill(0);
        }
    }

    const fn slot(&self, bucket: u64) -> usize {
        bucket as usize & (self.heads.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Compared with a linear search: every popped entry is in the lowest bucket, and every
        /// entry is popped once.
        #[test]
        fn lowest_buckets_come_first(first in 0u64..1 << 40, rises in prop::collection::vec((0u64..1 << 38, any::<bool>()), 1..200)) {
            let mut queue = BucketQueue::default();
            for _ in 0..2 {
                queue.start(first, 1 << 38, 4);
                let (mut left, mut floor) = (Vec::new(), first);
                for (i, &(rise, pops)) in rises.iter().enumerate() {
                    queue.push(floor + rise, i as u32);
                    left.push((floor + rise, i as u32));
                    if pops {
                        floor = take(&mut queue, &mut left)?;
                    }
                }
                // The second round begins with a queue that may not be empty.
                if first % 2 == 0 {
                    while !left.is_empty() {
                        take(&mut queue, &mut left)?;
                    }
                    prop_assert_eq!(queue.pop(), None);
                }
            }
        }
    }

    fn take(queue: &mut BucketQueue, left: &mut Vec<(u64, u32)>) -> Result<u64, TestCaseError> {
        let index = queue.pop().unwrap();
        let at = left.iter().position(|&(_, i)| i == index).unwrap();
        let (key, _) = left.remove(at);
        let lowest = left.iter().map(|&(key, _)| key).min().unwrap_or(key).min(key);
        prop_assert_eq!(key / BucketQueue::WIDTH, lowest / BucketQueue::WIDTH);
        prop_assert!(
            !queue.is_past(key)
                && (key < BucketQueue::WIDTH || queue.is_past(key - BucketQueue::WIDTH))
        );
        Ok(key)
    }
}
