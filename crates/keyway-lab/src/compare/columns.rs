//! The table of a comparison, for the terminal and for LaTeX.

use super::Compared;
use super::figures::{
    CLEARANCE_M, EXCESS, EXPANDED, Figure, GENERATED, LENGTH_M, NON_SMOOTH_TURNS, Summary,
    TURNING_ANGLE_DEG, TURNS,
};
use super::row::{ALL_MAPS, CompareRow};
use crate::table::{comment, latex_table, number, percent, range, rows};
use keyway::files::did_you_mean;
use keyway::search::CornerRule;
use std::collections::BTreeSet;
use thiserror::Error;

/// One column of the table.
#[derive(Debug)]
struct Column {
    /// Name of the column in a request.
    id: &'static str,
    /// Header in LaTeX.
    name: &'static str,
    /// Header in the terminal, in two lines if it is longer than its numbers; `None` if the
    /// column is shown only on request.
    heading: Option<&'static str>,
    cell: Cell,
    is_needed: fn(&[CompareRow]) -> bool,
}

/// Content of a column.
#[derive(Debug)]
enum Cell {
    Text(fn(&CompareRow) -> String),
    /// A mean, with the range of the values of most queries. The two numbers are their decimals.
    Mean(&'static Figure, Written, [usize; 2]),
}

type Written = fn(Option<f64>, usize) -> String;

/// Names that come first in every row; the terminal shows the map above its table.
const MAP: Column = always("map", "map", None, |row| row.map.clone());
const PLANNER: Column = always("planner", "planner", None, |row| row.planner.to_owned());
const SMOOTHER: Column = always("smoother", "smoother", None, |row| row.smoother.to_owned());

/// Columns of means have the range of most queries; the worst excess, the least clearance and the
/// median times have none.
const COLUMNS: [Column; 16] = [
    always(CORNERS, "corners", None, |row| corners(row).to_owned()),
    always("solved", "solved", Some("solved"), |row| format!("{}/{}", row.solved, row.queries)),
    always("missed", "missed", None, |row| row.missed.to_string()),
    always("compared", "compared", None, |row| row.compared.to_string()),
    column("length", "length m", Some("length m"), Cell::Mean(&LENGTH_M, number, [3, 1])),
    column("excess", "excess %", Some("excess %"), Cell::Mean(&EXCESS, percent, [3, 1])),
    always("worst", "worst %", None, |row| percent(row.figures.get(&EXCESS).worst, 3)),
    column("turns", "turns", Some("turns"), Cell::Mean(&TURNS, number, [1, 0])),
    column("angle", "angle deg", None, Cell::Mean(&TURNING_ANGLE_DEG, number, [1, 0])),
    column(
        "non-smooth",
        "non-smooth",
        Some("non-\nsmooth"),
        Cell::Mean(&NON_SMOOTH_TURNS, number, [1, 0]),
    ),
    always("clearance", "least clearance m", Some("clear-\nance m"), |row| {
        number(row.figures.get(&CLEARANCE_M).worst, 3)
    }),
    Column {
        id: "shortfalls",
        name: "shortfalls",
        heading: Some("short-\nfalls"),
        cell: Cell::Text(shortfalls),
        // Shown only if a path falls short of the requested clearance.
        is_needed: |rows| rows.iter().any(|row| row.shortfalls > 0),
    },
    column("expanded", "expanded", None, Cell::Mean(&EXPANDED, number, [1, 0])),
    column("generated", "generated", None, Cell::Mean(&GENERATED, number, [1, 0])),
    always(TIMES[0], "plan us", Some("plan\nus"), |row| number(row.median_plan_us, 1)),
    always(TIMES[1], "smooth us", Some("smooth\nus"), |row| number(row.median_smooth_us, 1)),
];

/// A text column, like the names.
const CORNERS: &str = "corners";
/// Columns of times.
const TIMES: [&str; 2] = ["plan", "smooth"];

const fn always(
    id: &'static str,
    name: &'static str,
    heading: Option<&'static str>,
    cell: fn(&CompareRow) -> String,
) -> Column {
    column(id, name, heading, Cell::Text(cell))
}

const fn column(
    id: &'static str,
    name: &'static str,
    heading: Option<&'static str>,
    cell: Cell,
) -> Column {
    Column { id, name, heading, cell, is_needed: |_| true }
}

impl Column {
    /// Returns the cell with its range behind or below it.
    fn with_range(&self, row: &CompareRow, [before, after]: [&str; 2]) -> String {
        let (figure, written, [of_mean, of_range]) = match self.cell {
            Cell::Text(text) => return text(row),
            Cell::Mean(figure, written, decimals) => (figure, written, decimals),
        };
        let Summary { mean, p5, p95, .. } = row.figures.get(figure);
        let range = range(p5, p95, |value| written(value, of_range));
        let range = if range.is_empty() { range } else { format!("{before}{range}{after}") };
        written(mean, of_mean) + &range
    }
}

/// Reason why a column cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ColumnError {
    /// No column has this name.
    #[error(
        "there is no column `{name}`; expected one of {}{}",
        COLUMNS.map(|column| column.id).join(", "),
        did_you_mean(name, COLUMNS.map(|column| column.id))
    )]
    Unknown {
        /// The unknown name.
        name: String,
    },
    /// The column shows times, which were not measured.
    #[error("{name} is a time, but times are omitted")]
    Time {
        /// Name of the column.
        name: String,
    },
}

/// Columns of the tables of a comparison.
#[derive(Debug)]
pub struct ChosenColumns {
    /// Requested columns; `None` for the default ones.
    asked: Option<Vec<&'static Column>>,
    has_times: bool,
}

impl ChosenColumns {
    /// Selects the columns of these names, which follow the names of planner and smoother;
    /// without names, the default columns. `has_times` is true if times were measured.
    ///
    /// # Errors
    /// Returns [`ColumnError`] for a column that cannot be shown.
    pub fn new(names: &[String], has_times: bool) -> Result<Self, ColumnError> {
        let column = |id: &String| {
            if !has_times && TIMES.contains(&id.as_str()) {
                return Err(ColumnError::Time { name: id.clone() });
            }
            let found = COLUMNS.iter().find(|column| column.id == id);
            found.ok_or_else(|| ColumnError::Unknown { name: id.clone() })
        };
        let asked: Vec<_> = names.iter().map(column).collect::<Result<_, _>>()?;
        Ok(Self { asked: Some(asked).filter(|all| !all.is_empty()), has_times })
    }

    /// Columns after the names, for all rows. Without requested ones, those that fit the width of
    /// a terminal and of a page.
    fn of(&self, rows: &[CompareRow]) -> Vec<&'static Column> {
        let is_shown = |column: &&Column| {
            column.heading.is_some()
                && (column.is_needed)(rows)
                && (self.has_times || !TIMES.contains(&column.id))
        };
        self.asked.clone().unwrap_or_else(|| COLUMNS.iter().filter(is_shown).collect())
    }

    /// Header and rows for LaTeX, and the number of text columns, which come first.
    pub fn table(&self, rows: &[CompareRow]) -> (Vec<&'static str>, Vec<Vec<String>>, usize) {
        let names = [&MAP, &PLANNER, &SMOOTHER];
        // A page has no room for a column that says the same in every row.
        let has_maps = rows.iter().any(|row| row.map != rows[0].map);
        let mut columns = names[usize::from(!has_maps)..].to_vec();
        let first = columns.len();
        columns.extend(self.of(rows));
        let cells =
            |row| columns.iter().map(|column| column.with_range(row, [" (", ")"])).collect();
        let lines = rows.iter().map(cells).collect();
        let words =
            first + columns[first..].iter().take_while(|column| column.id == CORNERS).count();
        (columns.iter().map(|column| column.name).collect(), lines, words)
    }

    /// Returns the table of all rows as LaTeX.
    pub fn latex(&self, rows: &[CompareRow]) -> String {
        let (header, lines, words) = self.table(rows);
        let about = "Means over the compared queries; in brackets the 5th and the 95th percentile of the queries.";
        comment(about) + &latex_table(&header, &lines, words)
    }

    /// Returns the table of a map.
    pub fn terminal_table(&self, map: &Compared, all: &[CompareRow]) -> String {
        let own: Vec<CompareRow> = all.iter().filter(|row| row.map == map.name).cloned().collect();
        format!("{}\n\n{}", title(map, &own), self.of_rows(&own, all))
    }

    /// Returns the table of all maps together; `None` for a single map.
    pub fn pooled_table(&self, all: &[CompareRow]) -> Option<String> {
        let own: Vec<CompareRow> = all.iter().filter(|row| row.is_pooled()).cloned().collect();
        let CompareRow { queries, .. } = own.first()?;
        Some(format!("{ALL_MAPS}: {queries} queries\n\n{}", self.of_rows(&own, all)))
    }

    /// Returns the table of some rows, with the columns for all of them.
    fn of_rows(&self, own: &[CompareRow], all: &[CompareRow]) -> String {
        let mut columns = vec![&PLANNER, &SMOOTHER];
        columns.extend(self.of(all));
        let header: Vec<&str> =
            columns.iter().map(|column| column.heading.unwrap_or(column.name)).collect();
        let cells = |row: &CompareRow| {
            columns.iter().map(|column| column.with_range(row, ["\n", ""])).collect()
        };
        rows(&header, own.iter().map(cells).collect(), 2)
    }
}

/// Returns a title with the properties that all rows of a map share.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A metric without a summary would be an empty column.
    #[test]
    fn the_figure_of_every_column_is_summarised() {
        let means = COLUMNS.iter().filter_map(|column| match column.cell {
            Cell::Mean(figure, ..) => Some(figure),
            Cell::Text(_) => None,
        });
        let all: Vec<&Figure> = means.chain([&CLEARANCE_M, &EXCESS]).collect();
        assert_eq!(all.len(), 9);
        assert!(all.iter().all(|figure| figure.place().is_some()), "{all:?}");
    }
}
