//! Random numbers that are the same on every platform.

/// `SplitMix64`: 64 random bits at a time from 64 bits of state. All seeds are equally good.
///
/// # Source
/// \[Steele2014\], with the constants of S. Vigna's `splitmix64.c`.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The generator for a seed.
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// One of many streams of a seed, one for each list of names, such as the odometry of the
    /// second robot. A stream does not depend on the number of other streams, or on the numbers
    /// drawn from them.
    pub fn stream(seed: u64, names: &[u64]) -> Self {
        names.iter().fold(Self::new(seed), |mut random, name| Self::new(random.bits() ^ name))
    }

    /// 64 random bits.
    pub const fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.state;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    }

    /// A number below `limit` (0 if that is 0), uniform except for one part in 2^32.
    pub const fn below(&mut self, limit: u32) -> u32 {
        ((self.bits() as u128 * limit as u128) >> 64) as u32
    }

    /// A number of at least 0 and less than 1: a multiple of 2^-53, uniform.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / Self::UNIT
    }

    /// A number from `low` to `high`, uniform.
    pub fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * self.unit()
    }

    /// True with this probability, to within 2^-53.
    pub fn is_chosen(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// A number above 0 and up to 1: a multiple of 2^-53, uniform.
    pub fn part(&mut self) -> f64 {
        ((self.bits() >> 11) + 1) as f64 / Self::UNIT
    }

    /// 2^53, up to which every integer is a floating point number.
    const UNIT: f64 = 9_007_199_254_740_992.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_values() {
        // Rosetta Code, "Pseudo-random numbers/Splitmix64": the first numbers of seed 1234567.
        let mut random = Random::new(1_234_567);
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!(expected.map(|_| random.bits()), expected);
    }

    #[test]
    fn below_a_limit_every_number_comes_as_often() {
        let mut random = Random::new(5);
        let mut counts = [0; 7];
        for _ in 0..70_000 {
            counts[random.below(7) as usize] += 1;
        }
        // 10,000 times each, with a standard deviation of 93.
        assert!(counts.iter().all(|count| (9600..10_400).contains(count)), "{counts:?}");
        assert_eq!((random.below(0), random.below(1)), (0, 0));
    }

    #[test]
    fn chances() {
        let mut random = Random::new(6);
        let mut count = |probability| (0..10_000).filter(|_| random.is_chosen(probability)).count();
        assert_eq!((count(0.0), count(1.0)), (0, 10_000));
        // 500 times, with a standard deviation of 22.
        assert!((400..600).contains(&count(0.05)));
    }

    #[test]
    fn parts_are_spread_evenly_above_zero() {
        let mut random = Random::new(7);
        let mut tenths = [0; 10];
        for _ in 0..100_000 {
            let part = random.part();
            assert!(part > 0.0 && part <= 1.0);
            tenths[((part * 10.0).ceil() - 1.0) as usize] += 1;
        }
        // 10,000 each, with a standard deviation of 95.
        assert!(tenths.iter().all(|count| (9600..10_400).contains(count)), "{tenths:?}");
    }

    #[test]
    fn streams_differ_by_seed_and_by_every_name() {
        let first = |seed, names: &[u64]| Random::stream(seed, names).bits();
        let names: [&[u64]; 8] = [&[], &[0], &[1], &[0, 0], &[0, 1], &[1, 0], &[1, 1], &[0, 0, 0]];
        let numbers = [0, 1, 2].map(|seed| names.map(|names| first(seed, names)));
        let mut all = numbers.concat();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 24);
        assert_eq!(first(2, &[1, 1]), numbers[2][6]);
    }
}
