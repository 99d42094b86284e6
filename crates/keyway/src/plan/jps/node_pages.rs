//! Memory for the nodes of a search.

use std::hint::black_box;

/// 16 bytes for every cell that a search touches, in pages of 32 cells of a row.
///
/// A page is allocated on first touch, so the nodes of one query lie close together, whatever the
/// size of the map: a query after thousands of others finds its nodes in the cache, and the first
/// queries do not pay for pages of memory that hold one node each. Nodes are not cleared between
/// queries. Memory: 1/8 byte per cell of the padded map, and 512 bytes per page of the query that
/// touched most; memory for all pages is reserved, but not touched.
#[derive(Clone, Debug, Default)]
pub(super) struct NodePages {
    /// For every 32 cells: stamp | page number.
    directory: Vec<u32>,
    nodes: Vec<[u64; 2]>,
    epoch: u32,
    /// A count of the queries in the bits above those of a page number; never 0 in a query.
    stamp: u32,
    /// A power of two, above the number of any page.
    page_numbers: u32,
    /// Pages allocated in this query.
    used: u32,
}

const CELLS_PER_PAGE: usize = 32;

impl NodePages {
    /// Number of bits of an epoch.
    pub(super) const EPOCH_BITS: u32 = 24;

    /// Clears all nodes.
    pub(super) fn start(&mut self, index_count: usize) {
        let pages = index_count.div_ceil(CELLS_PER_PAGE);
        if self.directory.len() != pages || self.epoch + 1 == 1 << Self::EPOCH_BITS {
            let page_numbers = (pages as u32).next_power_of_two();
            *self = Self { directory: vec![0; pages], page_numbers, ..Self::default() };
            // If the system does not grant that much, the nodes grow on demand.
            _ = self.nodes.try_reserve_exact(pages * CELLS_PER_PAGE);
        }
        self.epoch += 1;
        self.stamp = self.stamp.wrapping_add(self.page_numbers);
        if self.stamp == 0 {
            self.directory.fill(0);
            self.stamp = self.page_numbers;
        }
        self.used = 0;
    }

    /// Touches the memory of queries that reach `touched` cells: their nodes, and the directory.
    pub(super) fn warm_up(&mut self, index_count: usize, touched: usize) {
        self.start(index_count);
        // Without the hint, writing zeros over fresh zeros is left out, and touches nothing.
        black_box(&mut self.directory[..]).fill(0);
        let nodes = touched.next_multiple_of(CELLS_PER_PAGE);
        if self.nodes.len() < nodes {
            self.nodes.resize(nodes, [0; 2]);
        }
    }

    /// The number of the query, never 0; a node with this epoch was set in this query.
    pub(super) const fn epoch(&self) -> u32 {
        self.epoch
    }

    /// A node, touched in this query or not; an untouched one holds arbitrary content with another
    /// epoch.
    #[inline]
    pub(super) fn touch(&mut self, index: usize) -> &mut [u64; 2] {
        let mut page = self.directory[index / CELLS_PER_PAGE] ^ self.stamp;
        if page >= self.page_numbers {
            page = self.hand_out(index / CELLS_PER_PAGE);
        }
        &mut self.nodes[place(page, index)]
    }

    /// A node that was touched in this query.
    #[inline]
    pub(super) fn touched(&self, index: usize) -> [u64; 2] {
        self.nodes[place(self.directory[index / CELLS_PER_PAGE] ^ self.stamp, index)]
    }

    /// Memory on the heap that was ever touched \[bytes\].
    pub(super) const fn memory_bytes(&self) -> usize {
        size_of::<u32>() * self.directory.len() + size_of::<[u64; 2]>() * self.nodes.len()
    }

    #[cold]
    #[inline(never)]
    fn hand_out(&mut self, at: usize) -> u32 {
        let page = self.used;
        self.directory[at] = self.stamp | page;
        self.used += 1;
        let end = self.used as usize * CELLS_PER_PAGE;
        if self.nodes.len() < end {
            self.nodes.resize(end, [0; 2]);
        }
        page
    }
}

/// The index of a cell's node.
#[inline]
const fn place(page: u32, index: usize) -> usize {
    page as usize * CELLS_PER_PAGE + index % CELLS_PER_PAGE
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashMap;

    proptest! {
        #[test]
        fn what_was_set_in_a_query_is_found_in_it(
            queries in prop::collection::vec(prop::collection::vec((0usize..1000, 0u64..99), 0..80), 1..5),
        ) {
            let mut pages = NodePages::default();
            for query in queries {
                pages.start(1000);
                let epoch = u64::from(pages.epoch());
                let mut expected = HashMap::new();
                for (index, value) in query {
                    let known = *pages.touch(index);
                    let set = (known[1] == epoch).then_some(known[0]);
                    prop_assert_eq!(set, expected.get(&index).copied());
                    *pages.touch(index) = [value, epoch];
                    expected.insert(index, value);
                    prop_assert_eq!(pages.touched(index), [value, epoch]);
                }
            }
        }
    }

    #[test]
    fn epochs_run_out() {
        let mut pages = NodePages::default();
        pages.start(64);
        *pages.touch(3) = [7, u64::from(pages.epoch())];
        pages.epoch = (1 << NodePages::EPOCH_BITS) - 2;
        pages.start(64);
        assert_eq!(pages.epoch(), (1 << NodePages::EPOCH_BITS) - 1);
        pages.start(64);
        assert_eq!((pages.epoch(), *pages.touch(3)), (1, [0, 0]));
    }

    #[test]
    fn memory_is_that_of_the_largest_query() {
        let mut pages = NodePages::default();
        pages.start(1 << 20);
        let empty = pages.memory_bytes();
        assert_eq!(empty, (1 << 20) / 8);
        for index in [5, 6, 70, 1 << 19] {
            pages.touch(index);
        }
        assert_eq!(pages.memory_bytes() - empty, 3 * 512);
        pages.start(1 << 20);
        pages.touch(99);
        assert_eq!(pages.memory_bytes() - empty, 3 * 512);
    }

    /// On large maps the stamps of the directory repeat long before the epochs: of the pages that a
    /// query touches, some had other numbers when its stamp was last in use, and none since.
    #[test]
    fn nothing_of_earlier_queries_is_found() {
        // As on the largest map: all stamps above 27 bits but 0.
        const STAMPS: usize = 31;
        let mut pages = NodePages::default();
        pages.start(10 * STAMPS * CELLS_PER_PAGE);
        (pages.stamp, pages.page_numbers) = (0, 1 << 27);
        for query in 0..10 * STAMPS {
            pages.start(10 * STAMPS * CELLS_PER_PAGE);
            let epoch = u64::from(pages.epoch());
            let (round, group) = (query / STAMPS, query % STAMPS);
            let page = |at: usize| 10 * group + (3 * at + round) % 10;
            let indices = (0..5).map(|at| CELLS_PER_PAGE * page(at));
            for index in indices.clone() {
                assert_ne!(pages.touch(index)[1], epoch, "{query}: {index}");
                *pages.touch(index) = [index as u64, epoch];
            }
            assert!(indices.clone().all(|index| pages.touched(index) == [index as u64, epoch]));
        }
    }
}
