//! The folder of the results of a batch.

use super::files::{TABLES, write_runs, write_summaries, write_wins};
use super::kept::Kept;
use super::part::Part;
use super::wins::Contest;
use super::{
    BatchError, BatchReport, BatchWarning, PictureFile, Pictures, Record, StackCycles,
    against_first, scene_summaries, summaries,
};
use crate::progress::Progress;
use crate::results::{OutDir, OutputLock};
use std::path::Path;
use std::sync::Arc;

/// A folder in which all files of a batch may be written, and the drawer of its pictures.
pub(super) struct Output<'a> {
    pub(super) folder: OutDir,
    pictures: &'a dyn Pictures,
}

impl<'a> Output<'a> {
    /// Makes sure that all files may be written.
    pub(super) fn prepare(
        folder: &Path,
        pictures: &'a dyn Pictures,
        progress: &dyn Progress,
    ) -> Result<Self, BatchError> {
        let names: Vec<&str> = TABLES.into_iter().chain(pictures.names()).collect();
        let out = OutDir::prepare(folder, &names)?;
        if out.is_unguarded() {
            progress.warned(&BatchWarning::Unguarded { folder: folder.to_owned() });
        }
        Ok(Self { folder: out, pictures })
    }

    /// Returns the write lock of the folder.
    pub(super) fn lock(&self) -> Arc<OutputLock> {
        self.folder.lock()
    }

    /// Writes all results, and returns their report.
    pub(super) fn finish(
        mut self,
        records: &[Record],
        part: Option<&Part>,
        kept: &Kept,
    ) -> Result<BatchReport, BatchError> {
        let stacks = summaries(records);
        let names: Vec<String> = stacks.iter().map(|summary| summary.stack.clone()).collect();
        let against_first = against_first(records, &names);
        write_runs(records, part, &mut self.folder)?;
        let scenes = scene_summaries(records);
        write_summaries(&stacks, &against_first, &scenes, &mut self.folder)?;
        let contest = Contest::of(records, &names);
        write_wins(records, &contest, &mut self.folder)?;
        let wins = contest.wins;
        let cycles = names.iter().map(|stack| StackCycles::of(stack, records)).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let pictures = self.pictures.draw(records, &names).map_err(BatchError::Picture)?;
        for PictureFile { name, bytes } in pictures {
            self.folder.write(name, &bytes)?;
        }
        let written = self.folder.finish()?;
        let runs = || records.iter().map(|record| record.run.id());
        kept.remove_others(runs());
        Ok(BatchReport {
            schema: BatchReport::SCHEMA,
            runs: records.len(),
            stacks,
            against_first,
            scenes,
            wins,
            cycles,
            files: written.iter().map(|path| path.display().to_string()).collect(),
            records: kept.count(runs()),
            records_folder: kept.folder().to_owned(),
        })
    }
}
