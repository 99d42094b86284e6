//! Limits of a batch.

use std::ops::RangeInclusive;

/// Valid numbers of seeds for a scene.
pub(super) const SEEDS: RangeInclusive<u64> = 1..=1_000_000;
