//! `cargo test` gives the same result for everyone: properties draw their cases from a fixed seed.

use proptest::test_runner::{Config, RngSeed};

#[test]
fn properties_have_a_fixed_seed() {
    let seed = Config::default().rng_seed;
    assert_ne!(seed, RngSeed::Random, "PROPTEST_RNG_SEED is not set, see .cargo/config.toml");
}
