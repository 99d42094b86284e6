//! Tables for people.

use tabled::builder::Builder;
use tabled::settings::object::{Columns, Rows};
use tabled::settings::{Alignment, Style};

/// Names and values, one pair per line.
pub(crate) fn facts<'a>(rows: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let mut builder = Builder::default();
    for (name, value) in rows {
        builder.push_record([name.to_owned(), value]);
    }
    let mut table = builder.build();
    table.with(Style::blank()).to_string()
}

/// Rows under a header; columns from the `first_number`-th on are aligned as numbers.
pub(crate) fn rows(header: &[&str], rows: Vec<Vec<String>>, first_number: usize) -> String {
    let mut builder = Builder::default();
    builder.push_record(header.iter().copied());
    for row in rows {
        builder.push_record(row);
    }
    let mut table = builder.build();
    table.with(Style::sharp());
    table.modify(Columns::new(first_number..), Alignment::right());
    table.modify(Rows::first(), Alignment::left());
    table.to_string()
}

/// A number with so many decimals, or a dash for none.
pub(crate) fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
}

/// The same with a unit.
pub(crate) fn quantity(value: Option<f64>, decimals: usize, unit: &str) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$} {unit}"))
}
