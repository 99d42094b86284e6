//! Style of lines.

use crate::color::{QUIET, Rgb, SERIES};

/// Dashes that distinguish lines in addition to the colours.
const DASHES: [&str; 4] = ["", "6 2.5", "2 2", "8 2.5 2 2.5"];

/// Style of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStyle {
    /// Colour.
    pub color: Rgb,
    /// Width \[px\].
    pub width_px: f64,
    /// Lengths of dashes and gaps \[px\] in SVG syntax; empty for a solid line.
    pub dashes: &'static str,
}

impl LineStyle {
    /// A limit: a thin dashed line in grey.
    pub const LIMIT: Self = Self { color: QUIET, width_px: 0.9, dashes: "4 3" };

    /// Creates a solid line.
    pub const fn solid(color: Rgb, width_px: f64) -> Self {
        Self { color, width_px, dashes: "" }
    }
}

/// Returns the style of the line of this index among several: a colour, and dashes that
/// distinguish it from its neighbours without colour.
pub fn series_style(index: usize) -> LineStyle {
    let color = SERIES[index % SERIES.len()];
    LineStyle { color, width_px: 1.4, dashes: DASHES[index % DASHES.len()] }
}
