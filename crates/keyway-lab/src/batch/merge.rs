//! Merging of batches that were executed elsewhere.

use super::earlier::EarlierBatch;
use super::kept::Kept;
use super::output::Output;
use super::part::Part;
use super::{BatchError, BatchReport, Keep, MergeRequest, PartsError, Pictures, Record, RunId};
use crate::progress::Progress;
use crate::results::check_folder;
use std::collections::HashMap;
use std::path::Path;

impl MergeRequest {
    /// Merges results and writes all files. The scenes are not needed, and nothing is driven.
    ///
    /// # Errors
    /// Returns [`BatchError`] if the results of a folder cannot be read, or do not belong
    /// together, or a file cannot be written.
    pub fn merge(
        &self,
        pictures: &dyn Pictures,
        progress: &dyn Progress,
    ) -> Result<BatchReport, BatchError> {
        self.check()?;
        check_folder(&self.out)?;
        let parts = self.parts.iter().map(|part| EarlierBatch::read(part));
        let parts = parts.collect::<Result<Vec<_>, _>>()?;
        refuse_a_run_twice(&parts)?;
        let records = in_order(&parts)?;
        let out = Output::prepare(&self.out, pictures, progress)?;
        // The folder stays locked until the records are complete, too.
        let _lock = out.lock();
        // All records in the folders are kept.
        let runs = || parts.iter().flat_map(|one| one.records.iter().map(|it| it.run.id()));
        let kept = Kept::prepare(&self.out, Keep::All, runs())?;
        for EarlierBatch { folder, records, .. } in &parts {
            records.iter().try_for_each(|record| kept.take_over(record.run.id(), folder))?;
        }
        out.finish(&records, None, &kept)
    }
}

/// Scene name, stack and seed identify a run, wherever it was executed.
fn refuse_a_run_twice(batches: &[EarlierBatch]) -> Result<(), PartsError> {
    let mut found: HashMap<(&str, &str, u64), (&str, &Path)> = HashMap::new();
    for EarlierBatch { folder, records, .. } in batches {
        for record in records {
            let RunId { scene, stack, seed, digest } = record.run.id();
            let Some((other, first)) = found.insert((scene, stack, seed), (digest, folder)) else {
                continue;
            };
            return Err(PartsError::RunTwice {
                scene: scene.to_owned(),
                stack: stack.to_owned(),
                seed,
                is_same: other == digest,
                folders: [first.to_owned(), folder.clone()],
            });
        }
    }
    Ok(())
}

/// Returns the runs in the order of one batch: the parts of a batch interleaved, different
/// batches one after the other.
fn in_order(all: &[EarlierBatch]) -> Result<Vec<Record>, PartsError> {
    let mut batches: Vec<Vec<&EarlierBatch>> = Vec::new();
    for one in all {
        let is_same = |batch: &&mut Vec<&EarlierBatch>| {
            let parts = batch[0].part.as_ref().zip(one.part.as_ref());
            parts.is_some_and(|(a, b)| (a.of, &a.batch) == (b.of, &b.batch))
        };
        match batches.iter_mut().find(is_same) {
            Some(batch) => batch.push(one),
            None => batches.push(vec![one]),
        }
    }
    let mut records = Vec::new();
    for batch in batches {
        records.extend(in_turn(batch)?);
    }
    Ok(records)
}

/// Returns the runs of a whole batch, or of all parts of one.
fn in_turn(mut batch: Vec<&EarlierBatch>) -> Result<Vec<Record>, PartsError> {
    refuse_a_missing_part(&batch)?;
    batch.sort_by_key(|one| one.part.as_ref().map(|part| part.number));
    let mut parts: Vec<_> = batch.iter().map(|one| one.records.iter()).collect();
    let (mut records, mut next) = (Vec::new(), 0);
    // After the first part that has no more runs, no other part has any.
    while let Some(record) = parts[next].next() {
        records.push(record.clone());
        next = (next + 1) % parts.len();
    }
    let made = || Part::batch_of(records.iter().map(|record| record.run.id()));
    if batch[0].part.as_ref().is_some_and(|part| part.batch != made()) {
        return Err(PartsError::OtherParts { folder: batch[0].folder.clone() });
    }
    Ok(records)
}

fn refuse_a_missing_part(batch: &[&EarlierBatch]) -> Result<(), PartsError> {
    let Some((first, of)) = batch.first().and_then(|it| Some((it, it.part.as_ref()?.of))) else {
        return Ok(());
    };
    let has = |number: &usize| {
        batch.iter().any(|it| it.part.as_ref().is_some_and(|part| part.number == *number))
    };
    let missing: Vec<usize> = (1..=of).filter(|number| !has(number)).collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(PartsError::Missing { folder: first.folder.clone(), missing, of })
}
