//! Experiments with robots of [`keyway`] in worlds of [`keyway_sim`].
//!
//! | module | content |
//! |---|---|
//! | [`compare`] | planners and smoothers on the same queries |
//! | [`bench`](mod@bench) | planners on MovingAI scenario files, and on growing maps |
//! | [`batch`] | many runs, in parts and on several threads, and summaries by stack |
//! | [`replay`] | replay of recorded runs |
//! | `recording` | flight recorder: observations and decisions of a navigator, and their replay |
//! | [`claims`] | claims of papers, and experiments that measure them |
//! | [`reproduce`] | all claims with their verdicts: measurements, tables and a page |
//! | [`scenes`] | scenes of benchmarks, of tables of starts and goals, and of the papers' maps |
//! | [`catalogue`] | all named parts, with their parameters and their uses in the papers |
//! | [`results`] | folders of results, and journals |
//! | [`table`], [`run_tables`] | rows as text, LaTeX and CSV; routes and runs as tables |
//! | [`significance`], [`measure`] | significance of differences; times of work |
//! | [`progress`] | progress of work; threads are [`keyway_sim::parallel`]'s |

pub mod batch;
pub mod bench;
pub mod catalogue;
pub mod claims;
pub mod compare;
mod corner_rule;
pub mod measure;
pub mod progress;
#[cfg(feature = "recordings")]
pub mod recording;
pub mod replay;
pub mod reproduce;
pub mod results;
pub mod run_tables;
pub mod scenes;
pub mod significance;
pub mod table;

pub use corner_rule::corner_rule;
