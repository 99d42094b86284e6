//! The colours of a search: one scale for each side.

use crate::color::Rgb;
use keyway::search::Side;

/// Steps of a scale: too many to be distinguished individually, few enough for a small picture.
pub(super) const SHADES: u8 = 16;

/// The sides in the order in which they are drawn.
pub(super) const SIDES: [Side; 2] = [Side::Forward, Side::Backward];

/// Blues and oranges (Cynthia Brewer's scales), dark to light. Their light ends are still clearly
/// darker than white.
const SCALES: [[Rgb; 6]; 2] = [
    [
        Rgb(0x08, 0x30, 0x6b),
        Rgb(0x08, 0x51, 0x9c),
        Rgb(0x21, 0x71, 0xb5),
        Rgb(0x42, 0x92, 0xc6),
        Rgb(0x6b, 0xae, 0xd6),
        Rgb(0x9e, 0xca, 0xe1),
    ],
    [
        Rgb(0x7f, 0x27, 0x04),
        Rgb(0xa6, 0x36, 0x03),
        Rgb(0xd9, 0x48, 0x01),
        Rgb(0xf1, 0x69, 0x13),
        Rgb(0xfd, 0x8d, 0x3c),
        Rgb(0xfd, 0xae, 0x6b),
    ],
];

/// Cells that were generated and not expanded.
const OPEN: [Rgb; 2] = [Rgb(0xd6, 0xe8, 0xf5), Rgb(0xfe, 0xe3, 0xc8)];

/// End of the scale for lines: thin lines must be darker than areas to be visible.
const LINE_PART: f64 = 0.75;

/// Returns the index of a side in tables.
pub(super) const fn index(side: Side) -> usize {
    match side {
        Side::Forward => 0,
        Side::Backward => 1,
    }
}

/// Returns the shade of event `i` of `all`.
pub(super) fn of_order(i: usize, all: usize) -> u8 {
    let shade = i as u64 * u64::from(SHADES) / all.max(1) as u64;
    (shade as u8).min(SHADES - 1)
}

/// Returns the colour of cells of a shade.
pub(super) fn area(side: Side, shade: u8) -> Rgb {
    scale(side, f64::from(shade) / f64::from(SHADES - 1))
}

/// Returns the colour of lines of a shade.
pub(super) fn line(side: Side, shade: u8) -> Rgb {
    scale(side, LINE_PART * f64::from(shade) / f64::from(SHADES - 1))
}

/// Returns the colour of open cells.
pub(super) const fn open(side: Side) -> Rgb {
    OPEN[index(side)]
}

/// Returns samples for the legend, dark to light.
pub(super) fn samples(side: Side, color: fn(Side, u8) -> Rgb) -> [Rgb; 8] {
    [0, 2, 4, 6, 9, 11, 13, 15].map(|shade| color(side, shade))
}

fn scale(side: Side, fraction: f64) -> Rgb {
    let colors = SCALES[index(side)];
    let position = fraction * (colors.len() - 1) as f64;
    let lower = (position as usize).min(colors.len() - 2);
    colors[lower].mix(colors[lower + 1], position - lower as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_becomes_shade() {
        // 32 events in 16 shades: two of each.
        let shades: Vec<u8> = (0..32).map(|i| of_order(i, 32)).collect();
        assert_eq!(shades[..5], [0, 0, 1, 1, 2]);
        assert_eq!(shades[31], 15);
        assert_eq!(of_order(0, 1), 0);
    }

    #[test]
    fn later_is_lighter_and_open_is_lightest() {
        let luma =
            |c: Rgb| 0.2126 * f64::from(c.0) + 0.7152 * f64::from(c.1) + 0.0722 * f64::from(c.2);
        for side in SIDES {
            let mut scale: Vec<f64> = (0..SHADES).map(|s| luma(area(side, s))).collect();
            scale.push(luma(open(side)));
            assert!(scale.windows(2).all(|pair| pair[0] < pair[1]), "{scale:?}");
            assert!(luma(line(side, SHADES - 1)) < luma(area(side, SHADES - 1)));
        }
    }
}
