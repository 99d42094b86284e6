//! Batches: many runs of scenes with stacks and seeds, and summaries by stack.
//!
//! A [`BatchRequest`] describes the runs. It drives them and writes all files. A [`MergeRequest`]
//! puts together what was driven elsewhere. Both give a [`BatchReport`].
//!
//! A run is a pure function of its scene, its stack and its seed; where several robots drive in a
//! scene, it is a function of all of them. Each finished run is appended to a journal at once, with
//! a digest of all inputs, by which later batches find it. So a batch may be killed at any moment,
//! extended, or made in parts: only the missing runs are made. At the end the results are written
//! in the order of the runs, and the journal is removed. Measured times are in a file of their own.
//! Everything else is the same, byte for byte, however often a batch was killed, and on any number
//! of threads.

mod against_first;
mod clutter;
mod drive;
mod earlier;
mod error;
mod files;
mod keep;
mod kept;
mod limits;
mod merge;
mod output;
mod part;
mod parts_error;
mod pictures;
mod planned;
mod record;
mod report;
mod request;
mod row;
mod scene;
mod scene_list;
mod shared_world;
mod summary;
mod team_row;
mod warning;
mod wins;
mod wins_text;

pub use against_first::{
    AgainstFirst, against_first, against_first_latex, against_first_markdown, against_first_table,
};
pub use error::BatchError;
pub use keep::Keep;
pub use part::{Shard, ShardError};
pub use parts_error::PartsError;
pub use pictures::{PictureFile, Pictures};
pub use record::{Record, RunTimes};
pub use report::{BatchReport, StackCycles, cycles_line};
pub use request::{BatchRequest, MergeRequest};
pub use row::{ContactWhile, Row, RunId};
pub use summary::{StackSummary, summaries, summary_latex, summary_markdown, summary_table};
pub use warning::BatchWarning;
pub use wins::{ComparedRun, RunMeasure, Wins};
pub use wins_text::wins_table;
