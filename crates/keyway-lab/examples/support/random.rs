//! Random numbers of the examples that print tables: splitmix64 \[Steele2014\].

use keyway::map::Cell;

/// A generator with its seed.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// 64 random bits.
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number from 0 to `bound` - 1.
    pub(crate) fn below(&mut self, bound: i32) -> i32 {
        (self.next() % bound as u64) as i32
    }

    /// A cell of a square map.
    pub(crate) fn cell(&mut self, side: i32) -> Cell {
        Cell::new(self.below(side), self.below(side))
    }
}
