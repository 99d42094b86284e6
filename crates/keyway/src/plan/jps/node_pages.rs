//! Memory for the nodes of a search.

/// 16 bytes for every cell that a search touches, in pages of 64 cells of a row.
///
/// A page is handed out at the first touch, so the nodes of one query lie close together, whatever
/// the size of the map: a query after thousands of others finds its nodes in the cache, and the
/// first queries do not pay for pages of memory that hold one node each. Nothing is cleared between
/// queries. Memory: 1/8 byte per cell of the padded map, and 1 kB per page of the query that
/// touched most; room for all pages is reserved, but not touched.
#[derive(Clone, Debug, Default)]
pub(super) struct NodePages {
    /// For every 64 cells: epoch << 32 | number of the page.
    directory: Vec<u64>,
    nodes: Vec<[u64; 2]>,
    epoch: u32,
    /// Pages handed out in this query.
    used: usize,
}

const CELLS_PER_PAGE: usize = 64;

impl NodePages {
    /// Epochs fit into this many bits.
    pub(super) const EPOCH_BITS: u32 = 24;

    /// Forgets all nodes.
    pub(super) fn start(&mut self, index_count: usize) {
        let pages = index_count.div_ceil(CELLS_PER_PAGE);
        if self.directory.len() != pages || self.epoch + 1 == 1 << Self::EPOCH_BITS {
            *self = Self { directory: vec![0; pages], ..Self::default() };
            // Where a system does not promise that much, the nodes grow as they are needed.
            _ = self.nodes.try_reserve_exact(pages * CELLS_PER_PAGE);
        }
        self.epoch += 1;
        self.used = 0;
    }

    /// The number of the query. It is never 0; a node that holds it was set in this query.
    pub(super) const fn epoch(&self) -> u32 {
        self.epoch
    }

    /// A node that may have been touched before or not; then it holds anything with another epoch.
    #[inline]
    pub(super) fn touch(&mut self, index: usize) -> &mut [u64; 2] {
        if (self.directory[index / CELLS_PER_PAGE] >> 32) as u32 != self.epoch {
            self.hand_out(index / CELLS_PER_PAGE);
        }
        let place = self.place(index);
        &mut self.nodes[place]
    }

    /// A node that was touched in this query.
    #[inline]
    pub(super) fn touched(&self, index: usize) -> [u64; 2] {
        self.nodes[self.place(index)]
    }

    /// Memory on the heap that was ever touched \[bytes\].
    pub(super) const fn memory_bytes(&self) -> usize {
        size_of::<u64>() * self.directory.len() + size_of::<[u64; 2]>() * self.nodes.len()
    }

    #[inline]
    fn place(&self, index: usize) -> usize {
        let page = self.directory[index / CELLS_PER_PAGE] as u32 as usize;
        page * CELLS_PER_PAGE + index % CELLS_PER_PAGE
    }

    #[cold]
    #[inline(never)]
    fn hand_out(&mut self, page: usize) {
        self.directory[page] = u64::from(self.epoch) << 32 | self.used as u64;
        self.used += 1;
        if self.nodes.len() < self.used * CELLS_PER_PAGE {
            self.nodes.resize(self.used * CELLS_PER_PAGE, [0; 2]);
        }
    }
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
        assert_eq!(pages.memory_bytes() - empty, 3 * 1024);
        pages.start(1 << 20);
        pages.touch(99);
        assert_eq!(pages.memory_bytes() - empty, 3 * 1024);
    }
}
