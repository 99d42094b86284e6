//! `keyway compare`: maps, planners and smoothers -> a table of how good their paths are.

mod choice;
mod names;
mod pairs;
mod picture;
mod queries;
mod result_files;

use super::{Done, print, unusable_planner};
use crate::args::{COMPARE_TERMS, CompareArgs, Format};
use crate::embedded::Comparison;
use crate::error::{CliError, Kind};
use crate::inputs::{layers, load_map, refuse_to_replace_a_source};
use crate::out_dir::prepare;
use crate::progress::{Progress, Watched, Watcher};
use crate::stdout::print_files;
use choice::refuse_repeated;
use keyway::map::OccupancyGrid;
use keyway::map::formats::{LoadedMap, MapFormat, digest};
use keyway::plan::PlanError;
use keyway_lab::compare::{
    ChosenColumns, ColumnError, CompareError, CompareReport, CompareRequest, Compared, Queried,
    QuerySource, against_first_note, left_out_note, lowered_note, unsolved_note,
};
use names::MapNames;
use queries::queries;
use result_files::{earlier_file_names, file_names, write_files, written};
use std::path::Path;

pub(crate) fn run(args: &CompareArgs) -> Result<Done, CliError> {
    let request = choice::request(args)?;
    let columns = columns(args)?;
    let names = MapNames::new(&args.maps)?;
    let files = file_names(&names.all());
    let mut out = args.out.as_deref().map(|folder| prepare(folder, &files)).transpose()?;
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
        queried((&names, map), loaded, args, &request)
    };
    let queried: Vec<Queried> = (0..args.maps.len()).map(query_map).collect::<Result<_, _>>()?;
    let progress = Progress::over_files(args.maps.len());
    let compare = |map: Queried| compared(map, &request, (&progress, &()));
    let maps: Vec<Compared> = queried.into_iter().map(compare).collect::<Result<_, _>>()?;
    drop(progress);
    let mut report = report(args, &request, &maps);
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
                [Some(table), against_first_note(map, &report.against_first)]
            };
            let tables: Vec<String> = maps.iter().flat_map(of_map).flatten().collect();
            print(&format!("{}\n\n{COMPARE_TERMS}", tables.join("\n\n")))?;
            let file = args.pairs.as_deref().or(args.scen.as_deref());
            let notes = [left_out_note(&maps), unsolved_note(&maps, file), lowered_note(&maps)];
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
    let request = choice::request(args)?;
    let columns = columns(args)?;
    let names = MapNames::new(&args.maps)?;
    let (digest, format) = (digest(&grid), MapFormat::Ros);
    let loaded = LoadedMap { grid, format, digest, sources: Vec::new(), warnings: Vec::new() };
    let map = queried((&names, 0), loaded, args, &request)?;
    let progress = Progress::over_files(1);
    let map = compared(map, &request, (&progress, watcher))?;
    let report = report(args, &request, &[map]);
    let (header, cells, _) = columns.table(&report.rows);
    let latex = result_files::latex(&report, &columns);
    Ok(Comparison { report: crate::json::value(&report), latex, header, cells })
}

/// The columns of the tables.
fn columns(args: &CompareArgs) -> Result<ChosenColumns, CliError> {
    const FIELD: &str = "--columns";
    refuse_repeated(&args.columns, FIELD)?;
    ChosenColumns::new(&args.columns, !args.no_times).map_err(|error| {
        let message = match &error {
            ColumnError::Time { name } => format!("{name} is a time, which --no-times leaves out"),
            error => error.to_string(),
        };
        CliError::new(Kind::Usage, format!("{FIELD}: {message}")).field(FIELD)
    })
}

/// A map with its queries.
fn queried(
    (names, index): (&MapNames, usize),
    loaded: LoadedMap,
    args: &CompareArgs,
    request: &CompareRequest,
) -> Result<Queried, CliError> {
    let map = layers(&loaded.grid, request.map.clone(), &args.size).map_err(|error| {
        let message = format!("{}: {}", names.path(index).display(), error.message);
        CliError { message, ..error }
    })?;
    let queries = queries(args, (names, index), &map)?;
    Ok(Queried::new(names.name(index).to_owned(), loaded, map, queries))
}

/// All answers on a map.
fn compared(
    map: Queried,
    request: &CompareRequest,
    (progress, watcher): (&Progress, &dyn Watcher),
) -> Result<Compared, CliError> {
    let compared = request.on(map, &Watched { progress, watcher }).map_err(refused)?;
    progress.finished_file();
    Ok(compared)
}

/// Error of a comparison in the words of the command line.
fn refused(error: CompareError) -> CliError {
    match error {
        CompareError::Planner { error: error @ PlanError::NeedsUniformCost { .. }, .. } => {
            let message = format!("{error}; `--planners all` leaves such planners out");
            CliError::new(Kind::Config, message).field("--planners")
        }
        CompareError::Planner { name, error } => {
            let error = unusable_planner(error);
            CliError { message: format!("{name}: {}", error.message), ..error }
        }
        CompareError::Smoother(error) => {
            let error = error.within("smoother");
            CliError::new(Kind::Config, &error).field(error.path.as_str())
        }
        CompareError::Query(error) => CliError::new(Kind::Config, error).field("--planners"),
        error => CliError::new(Kind::Usage, error),
    }
}

fn report(args: &CompareArgs, request: &CompareRequest, maps: &[Compared]) -> CompareReport {
    let shown = |path: &Path| path.display().to_string();
    let is_random = args.pairs.is_none() && args.scen.is_none();
    let queries = QuerySource {
        pairs: args.pairs.as_deref().map(shown),
        scen: args.scen.as_deref().map(shown),
        seed: is_random.then_some(args.seed),
    };
    let paths: Vec<String> = args.maps.iter().map(|path| shown(path)).collect();
    let placement = args.place.placement().map(Into::into);
    CompareReport::new(request, (&paths, maps), queries, placement)
}
