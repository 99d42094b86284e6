//! The text files that a reproduction writes.

use super::figure_rows::figure_rows;
use super::latex::latex;
use super::map_rows::map_rows;
use super::markdown::markdown;
use super::page::{PageParts, page};
use super::report::{Measurements, ReproduceReport};
use crate::table::csv;

/// Results on each map, one line of JSON each.
pub(super) const LINES: &str = "maps.jsonl";
/// The same as a table.
const MAPS: &str = "maps.csv";
/// Name of the file with the report.
pub const REPORT_FILE: &str = "report.json";
const CSV: &str = "claims.csv";
const TEX: &str = "claims.tex";
const TABLES: &str = "tables.md";
const PAGE: &str = "report.html";

/// Names of all files except pictures.
pub const FILES: [&str; 7] = [LINES, MAPS, REPORT_FILE, CSV, TEX, TABLES, PAGE];

/// A text file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextFile {
    /// Name of the file.
    pub name: &'static str,
    /// Content of the file.
    pub text: String,
}

/// Returns all text files except [`REPORT_FILE`], which names the others.
pub fn text_files(
    report: &ReproduceReport,
    measurements: &Measurements,
    parts: &PageParts,
) -> Vec<TextFile> {
    let lines = measurements.all().flat_map(|one| &one.lines);
    // A line is plain data with string keys: this cannot fail.
    let lines: String =
        lines.map(|line| serde_json::to_string(line).unwrap_or_default() + "\n").collect();
    let files = [
        (LINES, lines),
        (MAPS, csv(&map_rows(measurements))),
        (CSV, csv(&figure_rows(&report.claims))),
        (TEX, latex(&report.claims)),
        (TABLES, markdown(report)),
        (PAGE, page(report, parts)),
    ];
    files.into_iter().map(|(name, text)| TextFile { name, text }).collect()
}
