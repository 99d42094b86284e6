//! `keyway batch merge`: batches that were made elsewhere -> their results together.

use super::kept::Kept;
use super::part::Part;
use super::result_files::{names, read_results};
use super::{BatchReport, finish};
use crate::args::{Keep, MergeArgs};
use crate::error::{CliError, Kind};
use crate::out_dir::prepare;
use keyway_lab::batch::Record;
use keyway_lab::batch::RunId;
use keyway_lab::results::check_folder;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// What a folder holds.
struct Results {
    folder: PathBuf,
    records: Vec<Record>,
    part: Option<Part>,
}

pub(super) fn merged(args: &MergeArgs) -> Result<BatchReport, CliError> {
    refuse_out_among(&args.folders, &args.out)?;
    check_folder(&args.out)?;
    let mut results = Vec::new();
    for folder in &args.folders {
        let (records, part) = read_results(folder)?;
        results.push(Results { folder: folder.clone(), records, part });
    }
    refuse_a_run_twice(&results)?;
    let records = in_order(&results)?;
    let out = prepare(&args.out, &names())?;
    // Until the records are there, too.
    let _lock = out.lock();
    // As many as the folders have are kept.
    let runs = || results.iter().flat_map(|one| one.records.iter().map(|it| it.run.id()));
    let kept = Kept::prepare(&args.out, Keep::All, runs())?;
    for Results { folder, records, .. } in &results {
        records.iter().try_for_each(|record| kept.take_over(record.run.id(), folder))?;
    }
    finish(&records, (None, &kept), out)
}

/// Results that are read must not be replaced on the way.
fn refuse_out_among(folders: &[PathBuf], out: &Path) -> Result<(), CliError> {
    let Ok(out_folder) = out.canonicalize() else { return Ok(()) };
    let is_out = |folder: &PathBuf| folder.canonicalize().is_ok_and(|folder| folder == out_folder);
    if !folders.iter().any(is_out) {
        return Ok(());
    }
    let message = format!("{} is one of the folders that are read; choose another", out.display());
    Err(CliError::new(Kind::Output, message).field("--out"))
}

/// A scene of one name with the same stack and seed is one run, wherever it was made.
fn refuse_a_run_twice(results: &[Results]) -> Result<(), CliError> {
    let mut found: HashMap<(&str, &str, u64), (&str, &Path)> = HashMap::new();
    for Results { folder, records, .. } in results {
        for record in records {
            let RunId { scene, stack, seed, digest } = record.run.id();
            let Some((other, first)) = found.insert((scene, stack, seed), (digest, folder)) else {
                continue;
            };
            let what =
                if other == digest { "is in both" } else { "was made of different inputs in" };
            let (first, second) = (first.display(), folder.display());
            let message = format!(
                "the run of {scene} with {stack} and seed {seed} {what} {first} and {second}"
            );
            return Err(CliError::new(Kind::Input, message).field("DIR"));
        }
    }
    Ok(())
}

/// The runs in the order of one batch: the parts of a batch in turn, batches one after the other.
fn in_order(results: &[Results]) -> Result<Vec<Record>, CliError> {
    let mut batches: Vec<Vec<&Results>> = Vec::new();
    for one in results {
        let is_same = |batch: &&mut Vec<&Results>| {
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

/// The runs of a whole batch, or of all parts of one.
fn in_turn(mut batch: Vec<&Results>) -> Result<Vec<Record>, CliError> {
    refuse_a_missing_part(&batch)?;
    batch.sort_by_key(|one| one.part.as_ref().map(|part| part.number));
    let mut parts: Vec<_> = batch.iter().map(|one| one.records.iter()).collect();
    let (mut records, mut next) = (Vec::new(), 0);
    // The first part that has no more is followed by none that has.
    while let Some(record) = parts[next].next() {
        records.push(record.clone());
        next = (next + 1) % parts.len();
    }
    let made = || Part::batch_of(records.iter().map(|record| record.run.id()));
    if batch[0].part.as_ref().is_some_and(|part| part.batch != made()) {
        let message = format!(
            "{}: the parts are not those that the batch was divided into; make them again",
            batch[0].folder.display()
        );
        return Err(CliError::new(Kind::Input, message).field("DIR"));
    }
    Ok(records)
}

/// Missing parts that are named.
const SHOWN: usize = 10;

fn refuse_a_missing_part(batch: &[&Results]) -> Result<(), CliError> {
    let Some((first, Part { of, .. })) = batch.first().and_then(|it| Some((it, it.part.as_ref()?)))
    else {
        return Ok(());
    };
    let has = |number: &usize| {
        batch.iter().any(|it| it.part.as_ref().is_some_and(|part| part.number == *number))
    };
    let missing: Vec<String> =
        (1..=*of).filter(|number| !has(number)).map(|number| format!("{number}/{of}")).collect();
    let missing = match &missing[..] {
        [] => return Ok(()),
        [first @ .., _, _] if first.len() >= SHOWN => {
            format!("{} and {} more", missing[..SHOWN].join(", "), missing.len() - SHOWN)
        }
        all => all.join(", "),
    };
    let folder = first.folder.display();
    let message = format!(
        "of the batch of which {folder} is a part, {missing} is not among the folders; parts that were made with other scenes, \
         stacks or seeds are of another batch"
    );
    Err(CliError::new(Kind::Input, message).field("DIR"))
}
