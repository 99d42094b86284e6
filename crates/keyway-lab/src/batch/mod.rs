//! Batches of runs: the result of each run, and summaries by stack.

mod against_first;
mod clutter;
mod record;
mod row;
mod summary;
mod team_row;

pub use against_first::{
    AgainstFirst, against_first, against_first_latex, against_first_markdown, against_first_table,
};
pub use record::{Measured, Record};
pub use row::{ContactWhile, Row, RunId};
pub use summary::{StackSummary, summaries, summary_latex, summary_markdown, summary_table};
