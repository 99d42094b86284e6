//! The table for people: in the terminal and in LaTeX.

use super::Compared;
use super::row::CompareRow;
use crate::table::{number, percent, range, rows};
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
    /// Between what the values of most queries lie, where the cell is a mean.
    range: Option<fn(&CompareRow) -> String>,
    is_needed: fn(&[CompareRow]) -> bool,
}

/// The first columns are names: this many of them in LaTeX, and this many in the terminal.
pub(super) const FIRST_NUMBER: usize = 4;
const FIRST_NUMBER_IN_TERMINAL: usize = 2;

/// Means with the range of most queries, except for the worst excess, the least clearance and the medians of
/// the times.
const COLUMNS: [Column; 17] = [
    always("map", None, |row| row.map.clone()),
    always("planner", Some("planner"), |row| row.planner.to_owned()),
    always("smoother", Some("smoother"), |row| row.smoother.to_owned()),
    always("corners", None, |row| corners(row).to_owned()),
    always("solved", Some("solved"), |row| format!("{}/{}", row.solved, row.queries)),
    always("missed", None, |row| row.missed.to_string()),
    always("compared", None, |row| row.compared.to_string()),
    mean("length m", Some("length m"), length, |row| {
        range(row.p5_length_m, row.p95_length_m, |length_m| number(length_m, 1))
    }),
    mean("excess %", Some("excess %"), excess, |row| {
        range(row.p5_excess, row.p95_excess, |share| percent(share, 1))
    }),
    always("worst %", None, |row| percent(row.max_excess, 3)),
    mean("turns", Some("turns"), turns, |row| {
        range(row.p5_turns, row.p95_turns, |turns| number(turns, 0))
    }),
    mean("angle deg", None, angle, |row| {
        range(row.p5_turning_angle_deg, row.p95_turning_angle_deg, |angle| number(angle, 0))
    }),
    mean("non-smooth", Some("non-\nsmooth"), non_smooth, |row| {
        range(row.p5_non_smooth_turns, row.p95_non_smooth_turns, |turns| number(turns, 0))
    }),
    always("least clearance m", Some("clear-\nance m"), |row| number(row.min_clearance_m, 3)),
    Column {
        name: "shortfalls",
        heading: Some("short-\nfalls"),
        cell: shortfalls,
        range: None,
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
    Column { name, heading, cell, range: None, is_needed: |_| true }
}

const fn mean(
    name: &'static str,
    heading: Option<&'static str>,
    cell: fn(&CompareRow) -> String,
    range: fn(&CompareRow) -> String,
) -> Column {
    Column { name, heading, cell, range: Some(range), is_needed: |_| true }
}

impl Column {
    /// The cell, and its range behind it, or below it.
    fn with_range(&self, row: &CompareRow, [before, after]: [&str; 2]) -> String {
        let range = self.range.map(|range| range(row)).filter(|range| !range.is_empty());
        let range = range.map(|range| format!("{before}{range}{after}")).unwrap_or_default();
        (self.cell)(row) + &range
    }
}

/// Header and rows with all columns.
pub(super) fn columns(rows: &[CompareRow]) -> (Vec<&'static str>, Vec<Vec<String>>) {
    let columns: Vec<&Column> = COLUMNS.iter().filter(|column| (column.is_needed)(rows)).collect();
    let cells = |row| columns.iter().map(|column| column.with_range(row, [" (", ")"])).collect();
    (columns.iter().map(|column| column.name).collect(), rows.iter().map(cells).collect())
}

/// A table for each map, as wide as a terminal: not all columns.
pub(super) fn terminal_tables(maps: &[Compared], all: &[CompareRow]) -> String {
    let is_shown = |column: &&Column| column.heading.is_some() && (column.is_needed)(all);
    let columns: Vec<&Column> = COLUMNS.iter().filter(is_shown).collect();
    let header: Vec<&str> = columns.iter().filter_map(|column| column.heading).collect();
    let cells = |row: &CompareRow| {
        columns.iter().map(|column| column.with_range(row, ["\n", ""])).collect()
    };
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

fn length(row: &CompareRow) -> String {
    number(row.mean_length_m, 3)
}

fn excess(row: &CompareRow) -> String {
    percent(row.mean_excess, 3)
}

fn turns(row: &CompareRow) -> String {
    number(row.mean_turns, 1)
}

fn angle(row: &CompareRow) -> String {
    number(row.mean_turning_angle_deg, 1)
}

fn non_smooth(row: &CompareRow) -> String {
    number(row.mean_non_smooth_turns, 1)
}
