//! Colours: a palette that survives colour blindness and grey print, and a colour map for
//! quantities.

use std::fmt;

/// A colour, written as `#rrggbb`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb(
    /// Red.
    pub u8,
    /// Green.
    pub u8,
    /// Blue.
    pub u8,
);

impl Rgb {
    /// Interpolates to another colour; 1 is the other colour.
    pub(crate) fn mix(self, other: Self, fraction: f64) -> Self {
        let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * fraction).round();
        Self(mix(self.0, other.0) as u8, mix(self.1, other.1) as u8, mix(self.2, other.2) as u8)
    }
}

impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// Text and axes.
pub(crate) const INK: Rgb = Rgb(0x22, 0x22, 0x22);
/// Free cells, and the page.
pub(crate) const FREE: Rgb = Rgb(0xff, 0xff, 0xff);
/// Occupied cells: lighter than ink, so that text and markers stand out against walls.
pub(crate) const OCCUPIED: Rgb = Rgb(0x2b, 0x2b, 0x2b);
/// Unknown cells, and the area outside the map.
pub(crate) const UNKNOWN: Rgb = Rgb(0xd4, 0xd4, 0xd4);
/// Free cells that are too close to an obstacle.
pub(crate) const BLOCKED: Rgb = Rgb(0xdc, 0xe9, 0xf5);
/// Cells that are occupied on the map but free in the world.
pub(crate) const ABSENT: Rgb = Rgb(0xa6, 0xdb, 0xd6);
/// Cells marked by the sensor.
pub(crate) const SENSED: Rgb = Rgb(0xe6, 0x9f, 0x00);
/// Obstacles that are not on the map.
pub(crate) const OBSTACLE: Rgb = Rgb(0xc4, 0x3c, 0x00);
/// The path as the search returns it.
pub(crate) const PLANNED: Rgb = Rgb(0x5b, 0x6f, 0x8c);
/// The path that is followed.
pub(crate) const SMOOTHED: Rgb = Rgb(0x00, 0x72, 0xb2);
/// A line over the colours of speed: it differs from all of them.
pub(crate) const OVER_DRIVEN: Rgb = Rgb(0xe7, 0x29, 0x8a);
/// Lines of a chart's grid.
pub(crate) const GRID: Rgb = Rgb(0xe4, 0xe4, 0xe4);
/// Limits in a chart, and other annotations.
pub(crate) const QUIET: Rgb = Rgb(0x77, 0x77, 0x77);

/// Colours of compared series (Okabe and Ito's palette, strong ones first).
pub const SERIES: [Rgb; 7] = [
    Rgb(0x00, 0x72, 0xb2),
    Rgb(0xd5, 0x5e, 0x00),
    Rgb(0x00, 0x9e, 0x73),
    Rgb(0xcc, 0x79, 0xa7),
    Rgb(0x56, 0xb4, 0xe9),
    Rgb(0xe6, 0x9f, 0x00),
    Rgb(0x22, 0x22, 0x22),
];

/// Ten evenly spaced colours of viridis (van der Walt and Smith, CC0).
const VIRIDIS: [Rgb; 10] = [
    Rgb(0x44, 0x01, 0x54),
    Rgb(0x48, 0x28, 0x78),
    Rgb(0x3e, 0x4a, 0x89),
    Rgb(0x31, 0x68, 0x8e),
    Rgb(0x26, 0x82, 0x8e),
    Rgb(0x1f, 0x9e, 0x89),
    Rgb(0x35, 0xb7, 0x79),
    Rgb(0x6d, 0xcd, 0x59),
    Rgb(0xb4, 0xde, 0x2c),
    Rgb(0xfd, 0xe7, 0x25),
];

/// Returns a colour of the perceptually uniform map viridis: dark violet at 0, yellow at 1;
/// clamped outside.
pub fn viridis(fraction: f64) -> Rgb {
    let last = VIRIDIS.len() - 1;
    let fraction = if fraction.is_nan() { 0.0 } else { fraction.clamp(0.0, 1.0) };
    let position = fraction * last as f64;
    let lower = (position as usize).min(last - 1);
    VIRIDIS[lower].mix(VIRIDIS[lower + 1], position - lower as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luma(color: Rgb) -> f64 {
        0.2126 * f64::from(color.0) + 0.7152 * f64::from(color.1) + 0.0722 * f64::from(color.2)
    }

    #[test]
    fn viridis_ends_and_grows_lighter() {
        assert_eq!(viridis(0.0).to_string(), "#440154");
        assert_eq!(viridis(1.0).to_string(), "#fde725");
        assert_eq!(viridis(-3.0), viridis(0.0));
        assert_eq!(viridis(f64::INFINITY), viridis(1.0));
        assert_eq!(viridis(f64::NAN), viridis(0.0));
        let steps: Vec<f64> = (0..=50).map(|i| luma(viridis(f64::from(i) / 50.0))).collect();
        assert!(steps.windows(2).all(|pair| pair[1] > pair[0]));
    }
}
