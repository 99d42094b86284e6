//! Statistics of many runs: summaries, intervals, and tests between two methods.
//!
//! | question | answer | source |
//! |---|---|---|
//! | distribution of values | [`Sample::summary`] | \[Hyndman1996\] |
//! | interval of the true mean | [`Sample::mean_interval`] | \[Efron1987\] |
//! | interval of a true rate | [`Rate::interval`] | \[Wilson1927\] |
//! | success of two methods | [`McNemarTest`] | \[McNemar1947\] |
//! | values of two methods | [`SignedRankTest`] | \[Wilcoxon1945\] |
//! | correction for several tests | [`holm`] | \[Holm1979\] |
//!
//! Two methods are compared on the same tasks, so both tests are paired. Everything is
//! deterministic: the same values in any order give the same bytes. Only the normal distribution
//! is needed, and it follows from `libm::erfc`; the crate `statrs` has none of these intervals
//! and tests.
//!
//! ```
//! use keyway_sim::metrics::statistics::{Confidence, Rate, Sample, SignedRankTest};
//!
//! let arrived = Rate { successes: 20, failures: 0 }.interval(Confidence::USUAL).unwrap();
//! assert!(arrived.low < 0.84 && arrived.high == 1.0);
//!
//! // How many seconds the first of two stacks took longer, scene by scene.
//! let longer_s = Sample::new(vec![1.5, -0.25, 2.0, 0.75, 3.0, 1.25])?;
//! let test = SignedRankTest::of_differences(&longer_s, Confidence::USUAL);
//! assert_eq!((test.median_difference, test.p_value), (1.375, 0.0625));
//! # Ok::<(), keyway_sim::metrics::statistics::StatisticsError>(())
//! ```

mod bootstrap;
mod confidence;
mod error;
mod holm;
mod mcnemar;
mod normal;
mod rank_sums;
mod rate;
mod sample;
mod signed_rank;
mod walsh;

pub use confidence::{Confidence, Interval};
pub use error::StatisticsError;
pub use holm::holm;
pub use mcnemar::McNemarTest;
pub use rate::Rate;
pub use sample::{Sample, Summary};
pub use signed_rank::SignedRankTest;
