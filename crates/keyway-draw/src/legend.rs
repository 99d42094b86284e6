//! The legend beside a picture, which explains its shapes and colours.

use crate::axes::{Scale, border};
use crate::axis::Axis;
use crate::color::{QUIET, Rgb, viridis};
use crate::line_style::LineStyle;
use crate::marks::{KEY_RING_PX, hatched_disc, letter_mark, time_mark};
use crate::text::{SMALL_TEXT_PX, text_width_px};
use crate::writer::{Anchor, PathData, SvgWriter};

/// An item of the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    /// Text of the item.
    pub label: String,
    /// Mark of the item.
    pub mark: LegendMark,
}

/// A small sample of a drawn element.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LegendMark {
    /// Painted cells.
    Area(Rgb),
    /// Painted cells in a scale of colours.
    Shades([Rgb; 8]),
    /// A line.
    Line(LineStyle),
    /// Thin lines in a scale of colours.
    ShadedLine([Rgb; 8]),
    /// A line coloured by a quantity; the colour bar names it.
    ColoredLine,
    /// A small ring filled with white.
    Ring(LineStyle),
    /// A ring of the given radius \[px\] filled with white.
    SmallRing(LineStyle, f64),
    /// A dot of the given radius \[px\].
    Dot(Rgb, f64),
    /// The outline of a circle.
    Circle(LineStyle),
    /// The outline of a box.
    Box(LineStyle),
    /// A hatched disc.
    HatchedDisc(Rgb),
    /// A time on a light background.
    Time(Rgb),
    /// A letter in a disc, dark on white or white on dark.
    Letter {
        /// The letter.
        letter: char,
        /// True if the disc is dark.
        dark: bool,
    },
}

impl LegendEntry {
    /// Creates an item of the legend.
    pub fn new(label: impl Into<String>, mark: LegendMark) -> Self {
        Self { label: label.into(), mark }
    }

    fn width_px(&self) -> f64 {
        SAMPLE_PX + 6.0 + text_width_px(&self.label, SMALL_TEXT_PX)
    }
}

const SAMPLE_PX: f64 = 22.0;
const ROW_PX: f64 = 18.0;
const COLUMN_GAP_PX: f64 = 18.0;

/// A legend in columns.
pub(crate) struct Legend<'a> {
    entries: &'a [LegendEntry],
    column_widths: Vec<f64>,
    rows: usize,
}

impl<'a> Legend<'a> {
    /// Creates a legend with as few rows as fit `width_px`; with one column if nothing fits.
    pub(crate) fn new(entries: &'a [LegendEntry], width_px: f64) -> Self {
        for rows in 1..entries.len() {
            let legend = Self::with_rows(entries, rows);
            if legend.width_px() <= width_px {
                return legend;
            }
        }
        Self::with_rows(entries, entries.len())
    }

    fn with_rows(entries: &'a [LegendEntry], rows: usize) -> Self {
        // Column by column: related entries, which are consecutive, stay together.
        let widest =
            |column: &[LegendEntry]| column.iter().map(LegendEntry::width_px).fold(0.0, f64::max);
        let column_widths = entries.chunks(rows.max(1)).map(widest).collect();
        Self { entries, column_widths, rows }
    }

    pub(crate) fn width_px(&self) -> f64 {
        let gaps = self.column_widths.len().saturating_sub(1) as f64 * COLUMN_GAP_PX;
        self.column_widths.iter().sum::<f64>() + gaps
    }

    pub(crate) fn height_px(&self) -> f64 {
        self.rows as f64 * ROW_PX
    }

    /// Draws the legend with its upper left corner at (x, y).
    pub(crate) fn draw(&self, out: &mut SvgWriter, mut x: f64, y: f64) {
        for (column, width) in self.entries.chunks(self.rows.max(1)).zip(&self.column_widths) {
            for (row, entry) in column.iter().enumerate() {
                let middle = y + (row as f64 + 0.5) * ROW_PX;
                draw_mark(out, entry.mark, x, middle);
                let (text_x, base) = (x + SAMPLE_PX + 6.0, middle + 0.36 * SMALL_TEXT_PX);
                out.label(text_x, base, SMALL_TEXT_PX, Anchor::Start, &entry.label);
            }
            x += width + COLUMN_GAP_PX;
        }
    }
}

/// Draws a mark whose left edge is at `x`, centred at the height `y`.
fn draw_mark(out: &mut SvgWriter, mark: LegendMark, x: f64, y: f64) {
    let middle = x + 0.5 * SAMPLE_PX;
    match mark {
        LegendMark::Area(color) => {
            let tag = out.tag("rect").at(x + 2.0, y - 5.5).size(SAMPLE_PX - 4.0, 11.0);
            tag.fill(color).stroke(QUIET, 0.6).leaf();
        }
        LegendMark::Shades(colors) => {
            strips(out, (x + 2.0, y - 5.5), (SAMPLE_PX - 4.0, 11.0), &colors);
            let frame = out.tag("rect").at(x + 2.0, y - 5.5).size(SAMPLE_PX - 4.0, 11.0);
            frame.attr("fill", "none").stroke(QUIET, 0.6).leaf();
        }
        LegendMark::ShadedLine(colors) => strips(out, (x, y - 0.7), (SAMPLE_PX, 1.4), &colors),
        LegendMark::Line(style) => {
            out.tag("line").between((x, y), (x + SAMPLE_PX, y)).line_style(style).leaf();
        }
        LegendMark::ColoredLine => {
            let path = PathData::line([(x + 1.5, y), (x + SAMPLE_PX - 1.5, y)]);
            crate::layers::casing(out, &path);
            for i in 0..8 {
                let start = x + 1.5 + f64::from(i) * (SAMPLE_PX - 3.0) / 8.0;
                let tag = out.tag("line").between((start, y), (x + SAMPLE_PX - 1.5, y));
                let color = viridis((f64::from(i) + 0.5) / 8.0);
                tag.stroke(color, crate::layers::DRIVEN_WIDTH_PX).leaf();
            }
        }
        LegendMark::Ring(style) => draw_mark(out, LegendMark::SmallRing(style, KEY_RING_PX), x, y),
        LegendMark::SmallRing(style, radius) => {
            let tag = out.tag("circle").round(middle, y, radius).attr("fill", "#fff");
            tag.stroke(style.color, style.width_px).leaf();
        }
        LegendMark::Dot(color, radius) => {
            out.tag("circle").round(middle, y, radius).fill(color).leaf();
        }
        LegendMark::Circle(style) => {
            out.tag("circle").round(middle, y, 6.0).attr("fill", "none").line_style(style).leaf();
        }
        LegendMark::Box(style) => {
            let corners = [(6.0, 5.0), (-6.0, 5.0), (-6.0, -5.0), (6.0, -5.0), (6.0, 5.0)];
            let outline = PathData::line(corners.map(|(dx, dy)| (middle + dx, y + dy)));
            let tag = out.tag("path").attr("d", outline.as_str()).attr("fill", "none");
            tag.line_style(style).leaf();
        }
        LegendMark::HatchedDisc(color) => hatched_disc(out, (middle, y), 6.5, color),
        LegendMark::Time(color) => time_mark(out, (middle, y), "5", color),
        LegendMark::Letter { letter, dark } => {
            letter_mark(out, (middle, y), letter.encode_utf8(&mut [0; 4]), dark);
        }
    }
}

/// Draws colours side by side in a rectangle with its upper left corner at (x, y).
fn strips(out: &mut SvgWriter, (x, y): (f64, f64), (width, height): (f64, f64), colors: &[Rgb]) {
    for (i, &color) in colors.iter().enumerate() {
        // Each extends to the right end, so that no gap shows between two.
        let left = width * i as f64 / colors.len() as f64;
        out.tag("rect").at(x + left, y).size(width - left, height).fill(color).leaf();
    }
}

/// The colours of a quantity (viridis), with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorBar {
    /// The quantity and its unit, such as `speed [m/s]`.
    pub label: String,
    /// Value at the dark end.
    pub low: f64,
    /// Value at the light end.
    pub high: f64,
}

const BAR_PX: f64 = 11.0;
/// Number of strips of a colour bar: too many to be seen individually.
const STRIPS: u32 = 64;

impl ColorBar {
    fn axis(&self, height_px: f64) -> Axis {
        let intervals = ((height_px / 24.0) as usize).clamp(2, 6);
        Axis::linear(self.low, self.high, intervals).label(&self.label)
    }

    pub(crate) fn width_px(&self, height_px: f64) -> f64 {
        BAR_PX + self.axis(height_px).side_px()
    }

    /// Draws the colour bar with its upper left corner at (x, y).
    pub(crate) fn draw(&self, out: &mut SvgWriter, x: f64, y: f64, height_px: f64) {
        for i in 0..STRIPS {
            // From the top; each strip extends to the bottom, so that no gap shows between two.
            let top = height_px * f64::from(i) / f64::from(STRIPS);
            let color = viridis(1.0 - (f64::from(i) + 0.5) / f64::from(STRIPS));
            out.tag("rect").at(x, y + top).size(BAR_PX, height_px - top).fill(color).leaf();
        }
        border(out, x, y, BAR_PX, height_px);
        Scale::upright(&self.axis(height_px), y, y + height_px).draw_right(out, x + BAR_PX);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_fit_the_width() {
        let entries: Vec<LegendEntry> =
            ["free", "occupied", "unknown", "a much longer label", "b", "c"]
                .map(|label| LegendEntry::new(label, LegendMark::Area(QUIET)))
                .to_vec();
        for width in [50.0, 160.0, 300.0, 2000.0] {
            let legend = Legend::new(&entries, width);
            assert!(legend.width_px() <= width || legend.column_widths.len() == 1);
            assert!(legend.rows * legend.column_widths.len() >= entries.len());
        }
        assert_eq!(Legend::new(&entries, 2000.0).rows, 1);
        assert_eq!(Legend::new(&[], 100.0).height_px(), 0.0);
    }
}
