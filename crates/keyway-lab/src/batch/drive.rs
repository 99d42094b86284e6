//! The runs of a batch, executed in parallel.

use super::earlier::known;
use super::kept::Kept;
use super::output::Output;
use super::planned::{Planned, PlannedBatch};
use super::{BatchError, BatchReport, BatchRequest, Pictures, Record, RunId};
use crate::progress::Progress;
use crate::results::Journal;
use keyway_sim::parallel::{processors, receive_each};
use std::collections::{HashMap, HashSet};

impl BatchRequest {
    /// Executes the runs that the folder of the results does not hold yet, and writes all files.
    ///
    /// Each finished run is appended to the folder's journal at once. A batch that was stopped or
    /// killed therefore resumes when it is driven again.
    ///
    /// # Errors
    /// Returns [`BatchError`] if the request, a file that it names or a run cannot be used, a
    /// result cannot be written, or the observer stops the batch. A goal that is not reached is a
    /// result.
    pub fn drive(
        &self,
        pictures: &dyn Pictures,
        progress: &dyn Progress,
    ) -> Result<BatchReport, BatchError> {
        self.check()?;
        let PlannedBatch { runs, part } = PlannedBatch::new(self, progress)?;
        let out = Output::prepare(&self.out, pictures, progress)?;
        let mut journal = Journal::<Record>::open(&out.folder)?;
        let mut records = vec![None; runs.len()];
        let earlier = [known(&out.folder)?, journal.take()];
        self.refuse_to_drop(earlier.iter().flatten(), &runs)?;
        for held in earlier {
            fill(&runs, &mut records, held);
        }
        let kept = Kept::prepare(&self.out, self.keep, runs.iter().map(Planned::id))?;
        for (run, record) in runs.iter().zip(&mut records) {
            record.take_if(|record| kept.lacks(run.id(), record));
        }
        let missing = Missing { runs: &runs, kept: &kept, jobs: self.jobs };
        missing.drive(&mut records, &mut journal, progress)?;
        let records: Vec<Record> = records.into_iter().flatten().collect();
        let report = out.finish(&records, part.as_ref(), &kept)?;
        journal.remove();
        Ok(report)
    }
}

impl BatchRequest {
    /// Refuses a folder with runs that are not part of this batch, which would be lost. A run that
    /// is made again because its scene or stack has changed is part of it.
    fn refuse_to_drop<'a>(
        &self,
        mut earlier: impl Iterator<Item = &'a Record>,
        runs: &[Planned],
    ) -> Result<(), BatchError> {
        let planned: HashSet<_> = runs.iter().map(|run| name_of(run.id())).collect();
        let other = earlier.find(|record| !planned.contains(&name_of(record.run.id())));
        other.map_or(Ok(()), |record| {
            let RunId { scene, stack, seed, .. } = record.run.id();
            let run = format!("{scene} with {stack} and seed {seed}");
            Err(BatchError::OtherRuns { folder: self.out.clone(), run })
        })
    }
}

/// Scene, stack and seed of a run.
fn name_of(id: RunId<'_>) -> (&str, &str, u64) {
    (id.scene, id.stack, id.seed)
}

/// Assigns records to their runs.
fn fill(runs: &[Planned], records: &mut [Option<Record>], held: impl IntoIterator<Item = Record>) {
    let held: Vec<Record> = held.into_iter().collect();
    let held: HashMap<RunId<'_>, &Record> =
        held.iter().map(|record| (record.run.id(), record)).collect();
    for (planned, record) in runs.iter().zip(records) {
        if record.is_none() {
            *record = held.get(&planned.id()).map(|&found| found.clone());
        }
    }
}

/// Runs, some of which are still to be executed.
struct Missing<'a> {
    runs: &'a [Planned],
    kept: &'a Kept,
    jobs: Option<usize>,
}

impl Missing<'_> {
    /// Executes the runs without a record in parallel. Each is appended to the journal as soon as
    /// it is finished.
    fn drive(
        &self,
        records: &mut [Option<Record>],
        journal: &mut Journal<Record>,
        progress: &dyn Progress,
    ) -> Result<(), BatchError> {
        let mut missing: Vec<usize> =
            (0..self.runs.len()).filter(|&i| records[i].is_none()).collect();
        missing.sort_by_key(|&i| self.runs[i].world.number);
        for &i in &missing {
            self.runs[i].world.expect_run();
        }
        let jobs = self.jobs.unwrap_or_else(processors).min(missing.len());
        progress.expect(missing.len());
        let work = |index| (index, self.drive_one(index));
        receive_each(missing, jobs, work, |(index, record)| {
            let record = record?;
            journal.append(&record)?;
            records[index] = Some(record);
            if progress.answered().is_break() { Err(BatchError::Stopped) } else { Ok(()) }
        })
    }

    /// Executes a run, and stores its full record if that is to be kept.
    fn drive_one(&self, index: usize) -> Result<Record, BatchError> {
        let planned = &self.runs[index];
        let driven = planned.drive()?;
        let record = driven.record();
        if self.kept.wants(&record) {
            self.kept.write(planned.id(), &driven.full_record())?;
        }
        Ok(record)
    }
}
