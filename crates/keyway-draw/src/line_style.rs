//! How lines look.

use crate::color::Rgb;

/// How a line looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStyle {
    /// Its colour.
    pub color: Rgb,
    /// Its width \[px\].
    pub width_px: f64,
    /// Lengths of dashes and gaps \[px\] as SVG writes them; empty for a solid line.
    pub dashes: &'static str,
}
