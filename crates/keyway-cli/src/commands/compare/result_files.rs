//! The files that a comparison leaves: the report, tables, and a picture of each map.

use super::names::picture_stems;
use super::picture::picture;
use crate::error::CliError;
use crate::pictures::png;
use keyway_lab::compare::{ChosenColumns, CompareReport, Compared, SCHEMA, query_rows};
use keyway_lab::results::OutDir;
use keyway_lab::table::csv;
use keyway_lab::table::latex_table;
use serde_json::Value;
use std::path::Path;

/// Files of all comparisons; a picture of each map follows.
const TABLES: [&str; 4] = ["report.json", "table.csv", "table.tex", "queries.csv"];

/// Names of all files: the tables, then for each map its picture as SVG and as PNG.
pub(super) fn file_names(maps: &[String]) -> Vec<String> {
    let pictures = picture_stems(maps).into_iter();
    let pictures = pictures.flat_map(|stem| ["svg", "png"].map(|end| format!("{stem}.{end}")));
    TABLES.map(str::to_owned).into_iter().chain(pictures).collect()
}

/// The same of an earlier comparison in the folder: its pictures of other maps would seem to belong to
/// this one.
pub(super) fn earlier_file_names(out: &OutDir) -> Result<Vec<String>, CliError> {
    let report = out.earlier(TABLES[0])?.and_then(|text| serde_json::from_str(&text).ok());
    let Some(report) = report.filter(|report: &Value| report["schema"] == SCHEMA) else {
        return Ok(Vec::new());
    };
    let maps = report["maps"].as_array().into_iter().flatten();
    // Reports of older versions have no names.
    let file_name = |path: &str| Some(Path::new(path).file_name()?.to_str()?.to_owned());
    let name = |map: &Value| {
        map["name"].as_str().map(str::to_owned).or_else(|| file_name(map["map"].as_str()?))
    };
    Ok(file_names(&maps.filter_map(name).collect::<Vec<_>>()))
}

/// The paths of the files that [`write_files`] will write.
pub(super) fn written(maps: &[Compared], files: &[String], out: &OutDir) -> Vec<String> {
    let (tables, pictures) = files.split_at(TABLES.len());
    let drawn =
        maps.iter().zip(pictures.chunks(2)).filter(|(map, _)| map.picture_query().is_some());
    let all = tables.iter().chain(drawn.flat_map(|(_, names)| names));
    all.map(|name| out.path(name).display().to_string()).collect()
}

/// The table of all rows as LaTeX.
pub(super) fn latex(report: &CompareReport, columns: &ChosenColumns) -> String {
    let (header, lines, words) = columns.table(&report.rows);
    latex_table(&header, &lines, words)
}

/// `files` are those of [`file_names`]. A map on which nothing was compared has no picture.
pub(super) fn write_files(
    report: &CompareReport,
    (maps, columns): (&[Compared], &ChosenColumns),
    files: &[String],
    out: &mut OutDir,
) -> Result<(), CliError> {
    let [json, table, tex, queries] = TABLES;
    out.write(json, crate::json::to_string(report).as_bytes())?;
    out.write(table, csv(&report.rows).as_bytes())?;
    out.write(tex, latex(report, columns).as_bytes())?;
    let all: Vec<_> = maps.iter().flat_map(query_rows).collect();
    out.write(queries, csv(&all).as_bytes())?;
    for (map, names) in maps.iter().zip(files[TABLES.len()..].chunks(2)) {
        if let Some(query) = map.picture_query() {
            let svg = picture(map, query);
            out.write(&names[0], svg.as_str().as_bytes())?;
            out.write(&names[1], &png(&svg)?)?;
        }
    }
    Ok(())
}
