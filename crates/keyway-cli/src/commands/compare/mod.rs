//! `keyway compare`: maps, planners and smoothers -> a table of how good their paths are.

mod against_first;
mod choice;
mod columns;
mod contest;
mod ends;
mod left_out;
mod lowered;
mod names;
mod pairs;
mod picture;
mod queries;
mod report;
mod result_files;
mod row;
mod unsolved;

use super::{Done, print};
use crate::args::{COMPARE_TERMS, CompareArgs, Format};
use crate::embedded::Comparison;
use crate::error::CliError;
use crate::inputs::{layers, load_map, refuse_to_replace_a_source};
use crate::out_dir::OutDir;
use crate::progress::{Progress, Watcher};
use crate::stdout::print_files;
use choice::Choice;
use columns::ChosenColumns;
use contest::{Contest, compete};
use ends::Ends;
use keyway::map::formats::{LoadedMap, MapFormat, digest};
use keyway::map::{Cell, OccupancyGrid, SearchMap};
use names::MapNames;
use queries::queries;
use report::CompareReport;
use result_files::{earlier_file_names, file_names, write_files, written};
use row::{CompareRow, compared, most_different, row};
use unsolved::note;

/// One map and the queries on it.
struct Queried {
    /// A name that no other map has.
    name: String,
    loaded: LoadedMap,
    map: SearchMap,
    queries: Vec<Ends>,
}

/// One map with everything that was found on it.
struct Compared {
    /// A name that no other map has.
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
    let columns = ChosenColumns::new(args)?;
    let names = MapNames::new(&args.maps)?;
    let files = file_names(&names.all());
    let mut out = args.out.as_deref().map(|folder| OutDir::prepare(folder, &files)).transpose()?;
    if let Some(out) = &mut out {
        let earlier = earlier_file_names(out)?;
        out.supersede(earlier);
    }
    let query_map = |map: usize| {
        let loaded = load_map(names.path(map), &args.place.reader())?;
        for name in &files {
            let Some(out) = &out else { break };
            refuse_to_replace_a_source(&loaded.sources, &out.path(name), "--out")?;
        }
        Queried::new((&names, map), loaded, args, &choice)
    };
    let queried: Vec<Queried> = (0..args.maps.len()).map(query_map).collect::<Result<_, _>>()?;
    let progress = Progress::over_files(args.maps.len());
    let compare = |map: Queried| map.compare(&choice, args, (&progress, &()));
    let maps: Vec<Compared> = queried.into_iter().map(compare).collect::<Result<_, _>>()?;
    drop(progress);
    let mut report = CompareReport::new(args, &choice, &maps);
    if let Some(mut out) = out {
        report.files = written(&maps, &files, &out);
        write_files(&report, (&maps, &columns), &files, &mut out)?;
        out.finish()?;
    }
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            let of_map = |map| {
                let table = columns.terminal_table(map, &report.rows);
                [Some(table), against_first::note(map, &report.against_first)]
            };
            let tables: Vec<String> = maps.iter().flat_map(of_map).flatten().collect();
            print(&format!("{}\n\n{COMPARE_TERMS}", tables.join("\n\n")))?;
            let file = args.pairs.as_deref().or(args.scen.as_deref());
            let notes = [left_out::note(&maps), note(&maps, file), lowered::note(&maps)];
            let notes = notes.into_iter().flatten();
            notes.into_iter().try_for_each(|note| print(&note))?;
            print_files(&report.files)?;
        }
    }
    Ok(Done::when(maps.iter().all(|map| map.counts.contains(&true))))
}

/// A comparison on one map in memory, while somebody watches.
pub(crate) fn comparison(
    grid: OccupancyGrid,
    args: &CompareArgs,
    watcher: &dyn Watcher,
) -> Result<Comparison, CliError> {
    let choice = Choice::new(args)?;
    let columns = ChosenColumns::new(args)?;
    let names = MapNames::new(&args.maps)?;
    let (digest, format) = (digest(&grid), MapFormat::Ros);
    let loaded = LoadedMap { grid, format, digest, sources: Vec::new(), warnings: Vec::new() };
    let map = Queried::new((&names, 0), loaded, args, &choice)?;
    let progress = Progress::over_files(1);
    let map = map.compare(&choice, args, (&progress, watcher))?;
    let report = CompareReport::new(args, &choice, &[map]);
    let (header, cells, _) = columns.table(&report.rows);
    let latex = result_files::latex(&report, &columns);
    Ok(Comparison { report: crate::json::value(&report), latex, header, cells })
}

impl Queried {
    fn new(
        (names, index): (&MapNames, usize),
        loaded: LoadedMap,
        args: &CompareArgs,
        choice: &Choice,
    ) -> Result<Self, CliError> {
        let mut map = layers(&loaded.grid, choice.map.clone(), &args.size).map_err(|error| {
            let message = format!("{}: {}", names.path(index).display(), error.message);
            CliError { message, ..error }
        })?;
        let queries = queries(args, (names, index), &map)?;
        // The same layers for all: the discs of all ends at once.
        let ends: Vec<Cell> = queries.iter().flat_map(|q| [q.start_cell, q.goal_cell]).collect();
        map.free_ends(&ends);
        Ok(Self { name: names.name(index).to_owned(), loaded, map, queries })
    }

    fn compare(
        self,
        choice: &Choice,
        args: &CompareArgs,
        (progress, watcher): (&Progress, &dyn Watcher),
    ) -> Result<Compared, CliError> {
        let Self { name, loaded, map, queries } = self;
        let turns = (args.repeat, progress, watcher);
        let contest = compete(&map, choice, &queries, turns)?;
        let contest = if args.no_times { contest.without_times() } else { contest };
        progress.finished_file();
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
