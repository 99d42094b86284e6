//! Scans along the padded rows of a bit grid.

/// Whether a bit is set.
#[inline]
pub(crate) fn is_set(words: &[u64], bit: usize) -> bool {
    words[bit / 64] >> (bit % 64) & 1 == 1
}

/// The first set bit after `at`; the padding always has one.
#[inline]
pub(crate) fn next_one(words: &[u64], at: usize) -> usize {
    let mut word = at / 64;
    // Two shifts, as one by 64 is not defined.
    let mut bits = words[word] & (u64::MAX << (at % 64) << 1);
    while bits == 0 {
        word += 1;
        bits = words[word];
    }
    word * 64 + bits.trailing_zeros() as usize
}

/// The last set bit before `at`; the padding always has one.
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
