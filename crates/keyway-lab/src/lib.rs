//! Experiments with robots of [`keyway`] in worlds of [`keyway_sim`].
//!
//! | module | content |
//! |---|---|
//! | [`compare`] | planners and smoothers on the same queries |
//! | [`bench`](mod@bench) | planners on the queries of MovingAI scenario files, and on growing maps |
//! | [`batch`] | many runs, in parts and on several threads, and summaries by stack |
//! | [`replay`] | recorded runs, made again |
//! | `recording` | flight recorder: what a navigator observed and decided, decided again |
//! | [`claims`] | claims of papers, measured again |
//! | [`reproduce`] | all claims with their verdicts: measurements, tables and a page |
//! | [`scenes`] | scenes of benchmarks, of tables of starts and goals, and of the papers' maps |
//! | [`catalogue`] | everything that has a name, with its parameters and its uses in the papers |
//! | [`results`] | folders of results, and journals |
//! | [`table`], [`run_tables`] | rows as text, LaTeX and CSV; routes and runs as tables |
//! | [`significance`], [`measure`] | differences that are more than chance; times of work |
//! | [`progress`] | how far work is; threads are [`keyway_sim::parallel`]'s |

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
