//! Batches: many runs of scenes with stacks and seeds, and summaries by stack.
//!
//! A [`BatchRequest`] describes the runs, executes them and writes all files. A [`MergeRequest`]
//! merges the results of runs that were executed elsewhere. Both return a [`BatchReport`].
//!
//! A run is a pure function of its scene, its stack and its seed; if several robots drive in a
//! scene, it is a function of all of them. Each finished run is appended to a journal at once,
//! with a digest of all inputs, by which later batches find it. A batch may therefore be killed
//! at any moment, extended, or executed in parts: only the missing runs are executed. At the end
//! the results are written in the order of the runs, and the journal is removed. Measured times
//! are in a separate file. Everything else is byte-identical, however often a batch was killed,
//! and on any number of threads.

mod against_first;
mod by_scene;
mod clutter;
mod drive;
mod earlier;
mod error;
mod files;
mod independent;
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
mod scene_source;
mod shared_world;
mod summary;
mod team_row;
mod warning;
mod wins;
mod wins_text;

pub use against_first::{
    AgainstFirst, against_first, against_first_latex, against_first_markdown, against_first_table,
};
pub use by_scene::{SceneSummary, scene_summaries, scenes_table};
pub use error::BatchError;
pub use keep::Keep;
pub use part::{Shard, ShardError};
pub use parts_error::PartsError;
pub use pictures::{PictureFile, Pictures};
pub use record::{Record, RunTimes};
pub use report::{BatchReport, StackCycles, cycles_line};
pub use request::{BatchRequest, MergeRequest};
pub use row::{ContactWhile, Row, RunId};
pub use scene_source::{GivenScene, SceneSource};
pub use summary::{StackSummary, summaries, summary_latex, summary_markdown, summary_table};
pub use warning::BatchWarning;
pub use wins::{ComparedRun, RunMeasure, Wins};
pub use wins_text::wins_table;
