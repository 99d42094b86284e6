//! A small table of text below a picture.

use crate::color::{GRID, QUIET, Rgb};
use crate::text::{SMALL_TEXT_PX, text_width_px};
use crate::writer::{Anchor, SvgWriter};

const ROW_PX: f64 = 17.0;
const COLUMN_GAP_PX: f64 = 20.0;

/// Text in rows and columns: the first column is aligned to the left, the others to the right. A
/// row with a single cell is a line of text of any length.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TextTable {
    rows: Vec<Vec<String>>,
}

impl TextTable {
    /// Creates a table without rows.
    pub const fn new() -> Self {
        Self { rows: Vec::new() }
    }

    /// Adds a row; the first one is the head.
    #[must_use]
    pub fn row(mut self, cells: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.rows.push(cells.into_iter().map(Into::into).collect());
        self
    }

    pub(crate) fn height_px(&self) -> f64 {
        self.rows.len() as f64 * ROW_PX
    }

    pub(crate) fn width_px(&self) -> f64 {
        let lines = self.rows.iter().filter(|row| row.len() == 1);
        let lines = lines.map(|row| text_width_px(&row[0], SMALL_TEXT_PX));
        lines.fold(self.column_ends().last().copied().unwrap_or(0.0), f64::max)
    }

    /// Returns the right edge of each column.
    fn column_ends(&self) -> Vec<f64> {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let mut end = 0.0;
        let ends = (0..columns).map(|column| {
            let cells = self.rows.iter().filter(|row| row.len() > 1);
            let cells = cells.filter_map(|row| row.get(column));
            let width = cells.map(|cell| text_width_px(cell, SMALL_TEXT_PX)).fold(0.0, f64::max);
            end += width + if column > 0 { COLUMN_GAP_PX } else { 0.0 };
            end
        });
        ends.collect()
    }

    /// Draws the table with its upper left corner at (x, y).
    pub(crate) fn draw(&self, out: &mut SvgWriter, x: f64, y: f64) {
        let ends = self.column_ends();
        for (i, row) in self.rows.iter().enumerate() {
            let base = y + i as f64 * ROW_PX + 0.5 * ROW_PX + 0.36 * SMALL_TEXT_PX;
            for (column, cell) in row.iter().enumerate() {
                let (at, anchor) =
                    if column == 0 { (x, Anchor::Start) } else { (x + ends[column], Anchor::End) };
                out.label(at, base, SMALL_TEXT_PX, anchor, cell);
            }
            let below = y + (i + 1) as f64 * ROW_PX;
            if row.len() > 1 && i + 1 < self.rows.len() {
                let color: Rgb = if i == 0 { QUIET } else { GRID };
                let end = x + ends.last().copied().unwrap_or(0.0);
                out.tag("line").between((x, below), (end, below)).stroke(color, 0.7).leaf();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_side_by_side() {
        let table = TextTable::new()
            .row(["term", "raw"])
            .row(["a long name", "1"])
            .row(["a line of text alone"]);
        let ends = table.column_ends();
        assert_eq!(ends.len(), 2);
        assert!(ends[0] >= text_width_px("a long name", SMALL_TEXT_PX));
        assert!(ends[1] - ends[0] >= COLUMN_GAP_PX);
        assert!(table.width_px() >= text_width_px("a line of text alone", SMALL_TEXT_PX));
        assert_eq!(TextTable::new().width_px(), 0.0);
    }
}
