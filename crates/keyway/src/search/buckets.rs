//! Unsorted entries in numbered buckets with shared memory.

/// Entries of a chunk: together with its two numbers, a chunk is 256 bytes.
const CHUNK_ENTRIES: usize = 15;
const NONE: u32 = u32::MAX;

/// Buckets as linked lists of chunks from one pool. A chunk freed by one bucket serves any other,
/// so the memory of one search is enough for every search with no more entries, however these are
/// distributed.
#[derive(Clone, Debug, Default)]
pub(super) struct Buckets {
    chunks: Vec<Chunk>,
    /// The first chunk of each bucket, the only one that may have free entries.
    heads: Vec<u32>,
    /// The first unused chunk.
    free: Option<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Chunk {
    entries: [u128; CHUNK_ENTRIES],
    len: u32,
    next: u32,
}

impl Buckets {
    /// Ensures that there are at least `count` buckets.
    pub(super) fn provide(&mut self, count: usize) {
        if self.heads.len() < count {
            self.heads.resize(count, NONE);
            // One chunk for each: reserved, but not touched before use.
            self.chunks.reserve(count);
        }
    }

    pub(super) fn push(&mut self, bucket: usize, entry: u128) {
        let head = self.heads[bucket];
        let chunk = self.chunks.get_mut(head as usize);
        if let Some(chunk) = chunk.filter(|chunk| (chunk.len as usize) < CHUNK_ENTRIES) {
            chunk.entries[chunk.len as usize] = entry;
            chunk.len += 1;
        } else {
            self.heads[bucket] = self.new_chunk(entry, head);
        }
    }

    /// A chunk with its first entry; the other entries are undefined.
    fn new_chunk(&mut self, entry: u128, next: u32) -> u32 {
        let Some(free) = self.free else {
            self.chunks.push(Chunk { entries: [entry; CHUNK_ENTRIES], len: 1, next });
            return self.chunks.len() as u32 - 1;
        };
        let chunk = &mut self.chunks[free as usize];
        self.free = (chunk.next != NONE).then_some(chunk.next);
        chunk.entries[0] = entry;
        (chunk.len, chunk.next) = (1, next);
        free
    }

    /// The entries of a bucket.
    pub(super) fn entries(&self, bucket: usize) -> impl Iterator<Item = u128> + '_ {
        let first = self.chunks.get(self.heads[bucket] as usize);
        let chunks = std::iter::successors(first, |chunk| self.chunks.get(chunk.next as usize));
        chunks.flat_map(|chunk| chunk.entries[..chunk.len as usize].iter().copied())
    }

    /// Clears a bucket; its memory may then be used by any other.
    pub(super) fn clear(&mut self, bucket: usize) {
        let first = std::mem::replace(&mut self.heads[bucket], NONE);
        let mut last = first;
        while let Some(chunk) = self.chunks.get_mut(last as usize) {
            if chunk.next == NONE {
                chunk.next = self.free.unwrap_or(NONE);
                self.free = Some(first);
                return;
            }
            last = chunk.next;
        }
    }

    /// Memory on the heap \[bytes\].
    pub(super) const fn memory_bytes(&self) -> usize {
        size_of::<Chunk>() * self.chunks.capacity() + size_of::<u32>() * self.heads.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn buckets_are_what_vectors_are(steps in prop::collection::vec((0usize..9, 0u32..90), 1..60)) {
            let mut buckets = Buckets::default();
            buckets.provide(9);
            let mut vectors = vec![Vec::new(); 9];
            let mut most_chunks = 0;
            for (i, (bucket, count)) in steps.into_iter().enumerate() {
                if count < 30 {
                    buckets.clear(bucket);
                    vectors[bucket].clear();
                } else {
                    for k in 0..u128::from(count) {
                        buckets.push(bucket, (i as u128) << 32 | k);
                        vectors[bucket].push((i as u128) << 32 | k);
                    }
                }
                for (bucket, vector) in vectors.iter().enumerate() {
                    let mut entries: Vec<u128> = buckets.entries(bucket).collect();
                    entries.sort_unstable();
                    prop_assert_eq!(&entries, vector);
                }
                let chunks = vectors.iter().map(|vector| vector.len().div_ceil(CHUNK_ENTRIES)).sum();
                most_chunks = usize::max(most_chunks, chunks);
                prop_assert_eq!(buckets.chunks.len(), most_chunks, "chunks are used again");
            }
        }
    }
}
