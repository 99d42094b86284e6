//! Tables for the terminal.

use tabled::builder::Builder;
use tabled::settings::formatting::AlignmentStrategy;
use tabled::settings::object::{Columns, Rows};
use tabled::settings::style::HorizontalLine;
use tabled::settings::{Alignment, Style};

/// Maximum width of a table whose texts can be wrapped \[characters\].
const MAX_WIDTH: usize = 116;
/// Minimum width of a wrapped text \[characters\].
const MIN_TEXT_WIDTH: usize = 14;
/// Padding of a cell \[characters\].
const PADDING: usize = 2;

/// Returns names and values, one pair per line; long values take several lines.
pub fn facts<'a>(rows: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let mut rows: Vec<Vec<String>> =
        rows.into_iter().map(|(name, value)| vec![name.to_owned(), value]).collect();
    wrap_texts(&mut rows, 2);
    let mut table = Builder::from_iter(rows).build();
    trimmed(&table.with(Style::empty()).to_string())
}

/// Wraps a text to the width of a table.
pub fn paragraph(text: &str) -> String {
    wrapped(text, MAX_WIDTH)
}

/// Returns rows under a header, whose names may have several lines; the columns from the
/// `first_number`-th on are aligned as numbers.
pub fn rows(header: &[&str], rows: Vec<Vec<String>>, first_number: usize) -> String {
    let mut all = vec![header.iter().map(|name| (*name).to_owned()).collect()];
    all.extend(rows);
    wrap_texts(&mut all, first_number);
    let mut table = Builder::from_iter(all).build();
    table.with(Style::empty().horizontals([(1, HorizontalLine::new('─'))]));
    table.modify(Columns::new(first_number..), (Alignment::right(), AlignmentStrategy::PerLine));
    table.modify(Rows::first(), Alignment::bottom());
    trimmed(&table.to_string())
}

/// Wraps the widest of the first `texts` columns, then the next one, until the table is narrow
/// enough.
fn wrap_texts(rows: &mut [Vec<String>], texts: usize) {
    let columns = rows.iter().map(Vec::len).max().unwrap_or_default();
    let cell_width =
        |cell: &String| cell.lines().map(|line| line.chars().count()).max().unwrap_or_default();
    let width = |rows: &[Vec<String>], column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(cell_width).max().unwrap_or_default()
    };
    for _ in 0..texts {
        let total: usize = (0..columns).map(|column| width(rows, column) + PADDING).sum();
        let widest = (0..texts.min(columns)).max_by_key(|&column| width(rows, column));
        let Some(widest) = widest.filter(|_| total > MAX_WIDTH) else { return };
        let room = (width(rows, widest) + MAX_WIDTH).saturating_sub(total).max(MIN_TEXT_WIDTH);
        for cell in rows.iter_mut().filter_map(|row| row.get_mut(widest)) {
            *cell = wrapped(cell, room);
        }
    }
}

/// Wraps a text to lines of at most this many characters, at spaces; a longer word is broken
/// after hyphens.
fn wrapped(text: &str, width: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let is_long = word.chars().count() > width;
        let pieces = if is_long { word.split_inclusive('-').collect() } else { vec![word] };
        for (i, piece) in pieces.into_iter().enumerate() {
            let line = lines.last().map_or("", String::as_str);
            let gap = if i == 0 && !line.is_empty() { " " } else { "" };
            let length = line.chars().count() + gap.len() + piece.chars().count();
            match lines.last_mut().filter(|line| line.is_empty() || length <= width) {
                Some(line) => line.extend([gap, piece]),
                None => lines.push(piece.to_owned()),
            }
        }
    }
    lines.join("\n")
}

/// Removes trailing spaces from a table, which a terminal would wrap.
fn trimmed(table: &str) -> String {
    table.lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
}

/// Formats a number with this many decimals, or a dash for a missing one.
pub fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
}

/// Formats the ends of the range of most values; empty if they are missing.
pub fn range(low: Option<f64>, high: Option<f64>, shown: impl Fn(Option<f64>) -> String) -> String {
    if low.is_none() || high.is_none() {
        return String::new();
    }
    format!("{} to {}", shown(low), shown(high))
}

/// Formats a value with the range in brackets, or without it if it is missing.
pub fn with_range(
    value: Option<f64>,
    [low, high]: [Option<f64>; 2],
    shown: fn(Option<f64>) -> String,
) -> String {
    let ends = range(low, high, shown);
    if ends.is_empty() { shown(value) } else { format!("{} ({ends})", shown(value)) }
}

/// Formats a share as a percentage with this many decimals, without a sign if it rounds to 0.
pub fn percent(share: Option<f64>, decimals: usize) -> String {
    let scale = 10f64.powi(decimals as i32);
    number(share.map(|share| (share * 100.0 * scale).round() / scale + 0.0), decimals)
}

/// Formats a number with a unit.
pub fn quantity(value: Option<f64>, decimals: usize, unit: &str) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$} {unit}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn widest(table: &str) -> usize {
        table.lines().map(|line| line.chars().count()).max().unwrap()
    }

    #[test]
    fn texts_are_broken_at_spaces_and_long_words_after_hyphens() {
        assert_eq!(wrapped("a bc def", 4), "a bc\ndef");
        assert_eq!(wrapped("bidirectional-jps-fixed", 18), "bidirectional-jps-\nfixed");
        assert_eq!(wrapped("line-of-sight x", 13), "line-of-sight\nx");
        assert_eq!(wrapped("unbreakable", 4), "unbreakable");
        assert_eq!(wrapped("", 4), "");
    }

    #[test]
    fn long_texts_do_not_make_a_table_wide() {
        let text = "some words ".repeat(30);
        assert!(widest(&facts([("name", text.clone()), ("other", "1".to_owned())])) <= MAX_WIDTH);
        let row = vec!["planner".to_owned(), text, "1.5".to_owned()];
        let table = rows(&["kind", "summary", "two\nlines"], vec![row], 2);
        assert!(widest(&table) <= MAX_WIDTH, "{table}");
        let lines: Vec<&str> = table.lines().collect();
        assert!(
            lines[0].ends_with("two")
                && lines[1].starts_with(" kind")
                && lines[1].ends_with("lines")
        );
        assert!(lines.iter().all(|line| !line.ends_with(' ')), "{table}");
    }
}
