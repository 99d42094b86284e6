//! The pattern of blocked cells among the 3 x 3 around a cell, as a number of 9 bits: the row
//! below in bits 0 to 2, its own row in 3 to 5, the row above in 6 to 8, each from left to right.

/// The pattern around the cell whose bit is `index`, in padded rows of `stride` bits.
#[inline]
pub(crate) fn around(words: &[u64], stride: usize, index: usize) -> usize {
    let left = index - 1;
    let row = |bit: usize| {
        let words = &words[bit / 64..bit / 64 + 2];
        let both = u128::from(words[1]) << 64 | u128::from(words[0]);
        (both >> (bit % 64)) as usize & 7
    };
    row(left - stride) | row(left) << 3 | row(left + stride) << 6
}

/// True if the neighbour in a direction (modulo 8, counter-clockwise from east) is blocked.
pub(crate) const fn is_blocked(pattern: usize, direction: u32) -> bool {
    const BIT: [usize; 8] = [5, 8, 7, 6, 3, 0, 1, 2];
    pattern >> BIT[direction as usize % 8] & 1 == 1
}
