//! `keyway compare`: maps, planners and smoothers -> a table of how good their paths are.

mod choice;
mod columns;
mod contest;
mod latex;
mod outputs;
mod pairs;
mod picture;
mod queries;
mod report;
mod row;
mod unsolved;

use super::{Done, print};
use crate::args::{CompareArgs, Format};
use crate::error::CliError;
use crate::inputs::{load_map, refuse_to_replace_a_source, search_map};
use crate::out_dir::OutDir;
use crate::progress::Progress;
use crate::table::rows;
use choice::Choice;
use columns::{FIRST_NUMBER, columns};
use contest::{Contest, compete};
use keyway::map::formats::LoadedMap;
use keyway::map::{Cell, SearchMap};
use outputs::{earlier_file_names, file_names, write_outputs};
use queries::{Ends, queries};
use report::CompareReport;
use row::{CompareRow, compared, most_different, row};
use std::path::{Path, PathBuf};
use unsolved::note;

/// One map with everything that is asked on it.
struct Asked {
    /// The file's name.
    name: String,
    loaded: LoadedMap,
    map: SearchMap,
    queries: Vec<Ends>,
}

/// One map with everything that was found on it.
struct Compared {
    /// The file's name.
    name: String,
    loaded: LoadedMap,
    map: SearchMap,
    queries: Vec<Ends>,
    contest: Contest,
    /// For each query whether its answers count.
    counts: Vec<bool>,
}

pub(crate) fn run(args: &CompareArgs) -> Result<Done, CliError> {
    let choice = Choice::new(args)?;
    let files = file_names(&args.maps);
    let mut out = args.out.as_deref().map(|folder| OutDir::prepare(folder, &files)).transpose()?;
    if let Some(out) = &mut out {
        let earlier = earlier_file_names(out);
        out.supersede(earlier);
    }
    let ask = |path: &PathBuf| {
        let loaded = load_map(path, args.place.placement())?;
        for name in &files {
            let Some(out) = &out else { break };
            refuse_to_replace_a_source(&loaded.sources, &out.path(name), "--out")?;
        }
        Asked::new(path, loaded, args, &choice)
    };
    let asked: Vec<Asked> = args.maps.iter().map(ask).collect::<Result<_, _>>()?;
    let queries: usize = asked.iter().map(|map| map.queries.len()).sum();
    let progress = Progress::over_files(args.maps.len());
    progress.expect(args.repeat as usize * choice.planners.len() * queries);
    let compare = |map: Asked| map.compare(&choice, (args.repeat, &progress));
    let maps: Vec<Compared> = asked.into_iter().map(compare).collect::<Result<_, _>>()?;
    drop(progress);
    let report = CompareReport::new(args, &choice, &maps);
    if let Some(out) = &mut out {
        write_outputs(&report, &maps, &files, out)?;
    }
    out.map(OutDir::finish).transpose()?;
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            let (header, lines) = columns(&report.rows);
            print(&rows(&header, lines, FIRST_NUMBER))?;
            let file = args.pairs.as_deref().or(args.scen.as_deref());
            note(&maps, file).map_or(Ok(()), |note| print(&note))?;
        }
    }
    Ok(Done::when(maps.iter().all(|map| map.counts.contains(&true))))
}

impl Asked {
    fn new(
        path: &Path,
        loaded: LoadedMap,
        args: &CompareArgs,
        choice: &Choice,
    ) -> Result<Self, CliError> {
        let mut map = search_map(&loaded.grid, &choice.map).map_err(|error| {
            let message = format!("{}: {}", path.display(), error.message);
            CliError { message, ..error }
        })?;
        let queries = queries(args, path, &map)?;
        // The same layers for all: the discs of all ends at once.
        let ends: Vec<Cell> = queries.iter().flat_map(|q| [q.start_cell, q.goal_cell]).collect();
        map.free_ends(&ends);
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, loaded, map, queries })
    }

    fn compare(self, choice: &Choice, turns: (u64, &Progress)) -> Result<Compared, CliError> {
        let Self { name, loaded, map, queries } = self;
        let contest = compete(&map, &choice.planners, &choice.smoothers, &queries, turns)?;
        turns.1.finished_file();
        let counts = compared(&contest.entries);
        Ok(Compared { name, loaded, map, queries, contest, counts })
    }
}

impl Compared {
    fn rows(&self) -> impl Iterator<Item = CompareRow> + '_ {
        self.contest.entries.iter().map(|entry| row(&self.name, entry, &self.counts))
    }

    /// The query of the picture.
    fn picture_query(&self) -> Option<usize> {
        most_different(&self.contest.entries, &self.counts)
    }
}
