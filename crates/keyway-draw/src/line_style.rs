//! Style of lines.

use crate::color::{QUIET, Rgb, SERIES};

/// Line styles in addition to the colours, so that lines can be told apart without colour.
const DASHES: [&str; 4] = ["", "6 2.5", "2 2", "8 2.5 2 2.5"];

/// Style of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStyle {
    /// Its colour.
    pub color: Rgb,
    /// Its width \[px\].
    pub width_px: f64,
    /// Lengths of dashes and gaps \[px\] as SVG writes them; empty for a solid line.
    pub dashes: &'static str,
}

impl LineStyle {
    /// A limit: a thin dashed line in grey.
    pub const LIMIT: Self = Self { color: QUIET, width_px: 0.9, dashes: "4 3" };

    /// A solid line.
    pub const fn solid(color: Rgb, width_px: f64) -> Self {
        Self { color, width_px, dashes: "" }
    }
}

/// The line of this index among several: in a colour, and dashes that tell it from its neighbours
/// without colour.
pub fn series_style(index: usize) -> LineStyle {
    let color = SERIES[index % SERIES.len()];
    LineStyle { color, width_px: 1.4, dashes: DASHES[index % DASHES.len()] }
}
