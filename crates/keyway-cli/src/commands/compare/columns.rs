//! The table for people: in the terminal and in LaTeX.

use super::Compared;
use super::row::CompareRow;
use crate::table::{number, rows};
use keyway::search::CornerRule;
use std::collections::BTreeSet;

/// One column of the table.
struct Column {
    /// Its header in LaTeX, which has all columns.
    name: &'static str,
    /// Its header in the terminal, in two lines where it is longer than its numbers; `None` where it is
    /// left out there.
    heading: Option<&'static str>,
    cell: fn(&CompareRow) -> String,
    is_needed: fn(&[CompareRow]) -> bool,
}

/// The first columns are names: this many of them in LaTeX, and this many in the terminal.
pub(super) const FIRST_NUMBER: usize = 4;
const FIRST_NUMBER_IN_TERMINAL: usize = 2;

/// Means, except for the worst excess, the least clearance and the medians of the times.
const COLUMNS: [Column; 17] = [
    always("map", None, |row| row.map.clone()),
    always("planner", Some("planner"), |row| row.planner.to_owned()),
    always("smoother", Some("smoother"), |row| row.smoother.to_owned()),
    always("corners", None, |row| corners(row).to_owned()),
    always("solved", Some("solved"), |row| format!("{}/{}", row.solved, row.queries)),
    always("missed", None, |row| row.missed.to_string()),
    always("compared", None, |row| row.compared.to_string()),
    always("length m", Some("length\nm"), |row| number(row.mean_length_m, 3)),
    always("excess %", Some("excess\n%"), |row| percent(row.mean_excess)),
    always("worst %", Some("worst\n%"), |row| percent(row.max_excess)),
    always("turns", Some("turns"), |row| number(row.mean_turns, 1)),
    always("angle deg", None, |row| number(row.mean_turning_angle_deg, 1)),
    always("non-smooth", Some("non-\nsmooth"), |row| number(row.mean_non_smooth_turns, 1)),
    always("least clearance m", Some("clear-\nance m"), |row| number(row.min_clearance_m, 3)),
    Column {
        name: "shortfalls",
        heading: Some("short-\nfalls"),
        cell: shortfalls,
        // Only where a path falls short of what was asked for.
        is_needed: |rows| rows.iter().any(|row| row.shortfalls > 0),
    },
    always("plan us", Some("plan\nus"), |row| number(row.median_plan_us, 1)),
    always("smooth us", Some("smooth\nus"), |row| number(row.median_smooth_us, 1)),
];

const fn always(
    name: &'static str,
    heading: Option<&'static str>,
    cell: fn(&CompareRow) -> String,
) -> Column {
    Column { name, heading, cell, is_needed: |_| true }
}

/// Header and rows with all columns.
pub(super) fn columns(rows: &[CompareRow]) -> (Vec<&'static str>, Vec<Vec<String>>) {
    let columns: Vec<&Column> = COLUMNS.iter().filter(|column| (column.is_needed)(rows)).collect();
    let cells = |row| columns.iter().map(|column| (column.cell)(row)).collect();
    (columns.iter().map(|column| column.name).collect(), rows.iter().map(cells).collect())
}

/// A table for each map, as wide as a terminal: not all columns.
pub(super) fn terminal_tables(maps: &[Compared], all: &[CompareRow]) -> String {
    let is_shown = |column: &&Column| column.heading.is_some() && (column.is_needed)(all);
    let columns: Vec<&Column> = COLUMNS.iter().filter(is_shown).collect();
    let header: Vec<&str> = columns.iter().filter_map(|column| column.heading).collect();
    let cells = |row: &CompareRow| columns.iter().map(|column| (column.cell)(row)).collect();
    let table = |map: &Compared| {
        let own: Vec<CompareRow> = map.rows().collect();
        let lines = own.iter().map(cells).collect();
        format!("{}\n\n{}", title(map, &own), rows(&header, lines, FIRST_NUMBER_IN_TERMINAL))
    };
    maps.iter().map(table).collect::<Vec<_>>().join("\n\n")
}

/// What is the same for all rows of a map.
fn title(map: &Compared, own: &[CompareRow]) -> String {
    let (queries, compared) = (map.counts.len(), map.counts.iter().filter(|&&is| is).count());
    let rules: BTreeSet<&str> = own.iter().map(corners).collect();
    let rules = match Vec::from_iter(rules)[..] {
        ["forbid"] => "no corners cut".to_owned(),
        ["allow"] => "corners cut".to_owned(),
        _ => {
            let allow = own.iter().filter(|row| row.corners == CornerRule::Allow);
            let names: BTreeSet<&str> = allow.map(|row| row.planner).collect();
            format!("corners cut by {}", Vec::from_iter(names).join(", "))
        }
    };
    let noun = if queries == 1 { "query" } else { "queries" };
    format!("{}: {queries} {noun}, {compared} compared, {rules}", map.name)
}

const fn corners(row: &CompareRow) -> &'static str {
    row.corners.name()
}

fn shortfalls(row: &CompareRow) -> String {
    let of = |all: usize| format!("{}/{all}", row.shortfalls);
    Some(row.compared).filter(|&all| all > 0).map_or_else(|| "-".to_owned(), of)
}

/// A share, without a sign where it is 0 after rounding.
fn percent(share: Option<f64>) -> String {
    number(share.map(|share| (share * 1e5).round() / 1e3 + 0.0), 3)
}
