//! Scans along the padded rows of a bit grid.

/// True if a bit is set.
#[inline]
pub(crate) fn is_set(words: &[u64], bit: usize) -> bool {
    words[bit / 64] >> (bit % 64) & 1 == 1
}

/// The next set bit after `at`; the padding always has one.
#[inline]
pub(crate) fn next_one(words: &[u64], at: usize) -> usize {
    let mut word = at / 64;
    // Two shifts, as a single shift by 64 would overflow.
    let mut bits = words[word] & (u64::MAX << (at % 64) << 1);
    while bits == 0 {
        word += 1;
        bits = words[word];
    }
    word * 64 + bits.trailing_zeros() as usize
}

/// The previous set bit before `at`; the padding always has one.
#[inline]
pub(crate) fn previous_one(words: &[u64], at: usize) -> usize {
    let mut word = at / 64;
    let mut bits = words[word] & !(u64::MAX << (at % 64));
    while bits == 0 {
        word -= 1;
        bits = words[word];
    }
    word * 64 + 63 - bits.leading_zeros() as usize
}

/// The lattice points of a line at which a shortest line may turn, 64 at a time.
#[derive(Clone, Copy)]
pub(crate) struct ConvexCorners {
    /// Exactly one of the four cells around the point is blocked.
    pub(crate) single: u64,
    /// Two of the four cells around the point are blocked, and share only this corner.
    pub(crate) between: u64,
}

/// The corners between two rows of blocked cells, for word `word` of the rows `below` and `above`.
/// Lattice point x lies between the columns x - 1 and x, whose bits are x and x + 1; it is bit x
/// of the result.
#[inline]
pub(crate) fn convex_corners(below: &[u64], above: &[u64], word: usize) -> ConvexCorners {
    let next = |row: &[u64]| row[word] >> 1 | row.get(word + 1).map_or(1 << 63, |next| next << 63);
    let (b0, b1, a0, a1) = (below[word], next(below), above[word], next(above));
    let single = (b0 ^ b1 ^ a0 ^ a1) & !(b0 & b1 | a0 & a1);
    let between = (b0 ^ b1) & (b0 ^ a0) & (b1 ^ a1);
    ConvexCorners { single, between }
}
