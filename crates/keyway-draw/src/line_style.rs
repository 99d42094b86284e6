//! Style of lines.

use crate::color::Rgb;

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
