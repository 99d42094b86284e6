//! Limits of a batch.

use std::ops::RangeInclusive;

/// Numbers of seeds that a scene may be driven with.
pub(super) const SEEDS: RangeInclusive<u64> = 1..=1_000_000;
