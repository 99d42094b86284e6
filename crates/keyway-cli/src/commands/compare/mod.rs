//! `keyway compare`: compares the paths of planners and smoothers on maps.

mod picture;
mod request;

use super::{Done, print};
use crate::args::{COMPARE_TERMS, CompareArgs, Format};
use crate::error::CliError;
use crate::inputs::{load_map, refuse_to_replace_a_source};
use crate::out_dir::prepare;
use crate::pictures::png;
use crate::progress::Progress;
use crate::stdout::print_files;
use keyway_lab::compare::{
    CompareFiles, CompareReport, Compared, Comparison, Queried, against_first_latex,
    against_first_note, left_out_note, lowered_note, query_rows, unsolved_note,
};
use keyway_lab::results::OutDir;
use keyway_lab::table::csv;
use picture::picture;

pub(crate) fn run(args: &CompareArgs) -> Result<Done, CliError> {
    let comparison = request::request(args)?.check()?;
    let files = CompareFiles::of_maps(&comparison.map_names());
    let mut out = args.out.as_deref().map(|folder| prepare(folder, &files.names())).transpose()?;
    if let Some(out) = &mut out {
        let earlier = CompareFiles::of_earlier(out)?;
        out.supersede(earlier);
    }
    let queried = |index: usize| {
        let loaded = load_map(&args.maps[index], &args.place.reader())?;
        for name in files.names() {
            let Some(out) = &out else { break };
            refuse_to_replace_a_source(&loaded.sources, &out.path(&name), "--out")?;
        }
        Ok::<_, CliError>(comparison.queried(index, loaded.grid)?)
    };
    let queried: Vec<Queried> = (0..args.maps.len()).map(queried).collect::<Result<_, _>>()?;
    let progress = Progress::over_files(args.maps.len());
    let compared = |map: Queried| {
        let compared = comparison.on(map, &progress)?;
        progress.finished_file();
        Ok::<_, CliError>(compared)
    };
    let maps: Vec<Compared> = queried.into_iter().map(compared).collect::<Result<_, _>>()?;
    drop(progress);
    let mut report = comparison.report(&maps, args.place.placement().map(Into::into));
    if let Some(mut out) = out {
        report.files = files.paths(&maps, &out);
        write(&report, (&comparison, &maps), &files, &mut out)?;
        out.finish()?;
    }
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => print_tables(&comparison, &maps, &report)?,
    }
    Ok(Done::when(maps.iter().all(|map| map.counts.contains(&true))))
}

/// Writes the tables, and a picture of each map with a compared query.
fn write(
    report: &CompareReport,
    (comparison, maps): (&Comparison, &[Compared]),
    files: &CompareFiles,
    out: &mut OutDir,
) -> Result<(), CliError> {
    out.write(CompareFiles::REPORT, crate::json::to_string(report).as_bytes())?;
    out.write(CompareFiles::TABLE, csv(&report.rows).as_bytes())?;
    out.write(CompareFiles::LATEX, comparison.columns().latex(&report.rows).as_bytes())?;
    let [csv_name, latex_name] = CompareFiles::AGAINST_FIRST;
    out.write(csv_name, csv(&report.against_first).as_bytes())?;
    out.write(latex_name, against_first_latex(&report.against_first).as_bytes())?;
    let all: Vec<_> = maps.iter().flat_map(query_rows).collect();
    out.write(CompareFiles::QUERIES, csv(&all).as_bytes())?;
    for (map, [svg_name, png_name]) in maps.iter().zip(files.pictures()) {
        if let Some(query) = map.picture_query() {
            let svg = picture(map, query);
            out.write(svg_name, svg.as_str().as_bytes())?;
            out.write(png_name, &png(&svg)?)?;
        }
    }
    Ok(())
}

fn print_tables(
    comparison: &Comparison,
    maps: &[Compared],
    report: &CompareReport,
) -> Result<(), CliError> {
    let of_map = |map| {
        let table = comparison.columns().terminal_table(map, &report.rows);
        [Some(table), against_first_note(map, &report.against_first)]
    };
    let pooled = comparison.columns().pooled_table(&report.rows);
    let tables: Vec<String> = maps.iter().flat_map(of_map).chain([pooled]).flatten().collect();
    print(&format!("{}\n\n{COMPARE_TERMS}", tables.join("\n\n")))?;
    let elsewhere = "`--format json` and queries.csv of `--out` list all of them";
    let unsolved = unsolved_note(maps, comparison.query_file(), elsewhere);
    let notes = [left_out_note(maps), unsolved, lowered_note(maps)];
    notes.into_iter().flatten().try_for_each(|note| print(&note))?;
    print_files(&report.files)
}
